#include "bench/shadow/task.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "bench/core/registry.hpp"
#include "bench/shadow/closed_form.hpp"
#include "bench/shadow/scene_of.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::shadow {
namespace {

struct Size {
  int width, height;
};
Size image_size(Profile profile) {
  switch (profile) {
    case Profile::smoke:
      return {48, 36};
    case Profile::quick:
      return {160, 120};
    case Profile::full:
      break;
  }
  return {640, 480};
}

TruthOptions truth_options(Profile profile, std::uint64_t seed) {
  TruthOptions o;
  o.seed = seed;
  if (profile == Profile::smoke) o.most = 64;
  if (profile == Profile::full) o.most = 4096;
  return o;
}

/// Of the mesh, the light and the camera.
std::uint64_t hash_of(const shading::Scene& scene) {
  datasets::Dataset mesh;
  mesh.kind = datasets::Kind::mesh, mesh.mesh = scene.mesh;
  std::uint64_t h = mesh.hash();
  const auto add = [&](double x) { h = geometry::hash_u64(h, std::bit_cast<std::uint64_t>(x)); };
  const shading::Light& light = scene.light;
  for (const auto& v : {light.position, light.direction, light.u, light.v, scene.camera.position,
                        scene.camera.target, scene.camera.up})
    for (int k = 0; k < 3; ++k) add(v[k]);
  add(double(light.kind)), add(light.angle), add(scene.camera.height_angle);
  add(scene.camera.width), add(scene.camera.height);
  return h;
}

int up_axis(const RunContext& context) {
  const auto given = context.own.find("--up");
  if (given == context.own.end()) return 1;
  if (given->second == "x") return 0;
  if (given->second == "y") return 1;
  if (given->second == "z") return 2;
  throw std::invalid_argument("--up is '" + given->second + "'; it must be x, y or z");
}

/// True if the scene's own light gave way to another.
bool relight(shading::Scene& scene, const RunContext& context) {
  const auto given = context.own.find("--light");
  if (given == context.own.end()) return false;
  const auto box = scene.mesh.box();
  scene.light = light_from(given->second, geometry::Vec3d(box.low) * 0.5 + geometry::Vec3d(box.high) * 0.5);
  return true;
}

}  // namespace

ShadowTask::ShadowTask() : methods_(Registry<Method>::instance().in_order_of(TREELINE_TASK_METHODS)) {
  for (const Method& m : methods_) infos_.push_back(m.info);
}

std::vector<std::pair<std::string, std::string>> ShadowTask::not_built() const {
  return parse_not_built(TREELINE_TASK_NOT_BUILT);
}

std::vector<TaskFlag> ShadowTask::flags() const {
  return {{"--light",
           "Another light: directional:X,Y,Z[:DEGREES], point:X,Y,Z, spot:X,Y,Z:DEGREES, "
           "disc:X,Y,Z:RADIUS or rectangle:X,Y,Z:SIDE"},
          {"--up", "Of --input: which way is up, x, y (the default) or z"}};
}

void ShadowTask::check_flags(const RunContext& context) const {
  up_axis(context);
  if (const auto given = context.own.find("--light"); given != context.own.end())
    light_from(given->second, geometry::Vec3d::filled(1e-3));
}

std::vector<BlockSpec> ShadowTask::blocks(Profile profile) const {
  if (profile == Profile::smoke) return {{"icosphere", 1'000}};
  return {{"icosphere", 10'000}};
}

std::vector<BlockSpec> ShadowTask::hard_blocks() const {
  std::vector<BlockSpec> out;
  for (const auto& c : datasets::hard_shadows()) out.push_back({c.name, c.scene.mesh.size(), true});
  return out;
}

std::unique_ptr<Block> ShadowTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (!spec.hard) return open(datasets::generate(spec.dataset, spec.n, context.seed), context);
  for (datasets::HardShadow& c : datasets::hard_shadows()) {
    if (c.name != spec.dataset) continue;
    BlockInput input;
    input.scene = std::move(c.scene);
    input.dataset_hash = hash_of(input.scene), input.seed = context.seed;
    if (c.all_lit || c.all_dark)
      input.closed_form = [lit = c.all_lit](const shading::Light&, const Receiver&) {
        return lit ? 1.0 : 0.0;
      };
    else if (!c.blockers.empty())
      input.closed_form = [blockers = c.blockers](const shading::Light& light, const Receiver& r) {
        return visible_past(blockers, light, r.position);
      };
    input.edge = c.edge, input.contact = c.contact;
    input.truth = truth_options(Profile::quick, context.seed);
    input.threads = 1;  // hard cases run in children of a fork: no thread pool here
    input.truth_cache = context.truth_cache, input.version = version();
    input.must_answer = c.expect == datasets::Expect::answers;
    auto block = std::make_unique<ShadowBlock>(methods_, std::move(input));
    block->find_truth();  // once, for all the children
    return block;
  }
  throw std::invalid_argument("no hard case for shadows is called '" + spec.dataset + "'");
}

std::unique_ptr<Block> ShadowTask::open(datasets::Dataset dataset, const RunContext& context) const {
  if (dataset.kind != datasets::Kind::mesh || dataset.mesh.faces.empty())
    throw std::invalid_argument("'" + dataset.name +
                                "' has no triangles; the task shadow needs a mesh or a scene");
  const Size size = image_size(context.profile);
  BlockInput input;
  input.scene = scene_of(dataset.name, dataset.mesh, up_axis(context), size.width, size.height);
  relight(input.scene, context);
  input.dataset_hash = hash_of(input.scene), input.seed = dataset.seed;
  input.truth = truth_options(context.profile, context.seed);
  input.threads = context.threads;
  input.truth_cache = context.truth_cache, input.version = version();
  input.quick = context.profile == Profile::quick;
  return std::make_unique<ShadowBlock>(methods_, std::move(input));
}

void ShadowTask::pictures(const BlockSpec&, const RunContext&, const std::string&) const {}

}  // namespace treeline::bench::shadow
