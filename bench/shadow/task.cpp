#include "bench/shadow/task.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "bench/core/all_threads.hpp"
#include "bench/core/cells.hpp"
#include "bench/shadow/closed_form.hpp"
#include "bench/shadow/pictures.hpp"
#include "datasets_gen/scenes/light.hpp"
#include "datasets_gen/scenes/scene.hpp"
#include "geometry/tolerances.hpp"
#include "shading/shadow/light_view.hpp"

namespace treeline::bench::shadow {
namespace {

constexpr int frames = 5;  // of the set `motion`
/// Of a plane under nothing every bias tells something, and no width of a light does.
constexpr std::array of_planes{"unshadowed", "centre_ray", "shadow_map", "pcf", "vsm", "msm"};

struct Size {
  int width, height;
};
Size image_size(Profile profile) {
  switch (profile) {
    case Profile::smoke:
      return {48, 36};
    case Profile::quick:
      return {144, 108};
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

/// Known shadows as a formula; empty if they are not known.
LightForm form_of(const datasets::KnownShadows& known) {
  if (known.all_lit) return [](const shading::Light&, const Receiver&) { return 1.0; };
  if (known.blockers.empty()) return {};
  return [blockers = known.blockers](const shading::Light& light, const Receiver& r) {
    return visible_past(blockers, light, r.position);
  };
}

/// Once for the scene, not by each method for itself: a light whose area is too small for a double, or that
/// is so far away that doubles round the way to it by more than maps allow for of the scene's size.
void check_light(const shading::Scene& scene) {
  const shading::Light& light = scene.light;
  const bool has_area = light.u != geometry::Vec3d{} || light.v != geometry::Vec3d{};
  if (has_area && !(length(light.u) * length(light.v) >= std::numeric_limits<double>::min()))
    throw shading::InvalidScene("the light's area is too small for a number to tell: take a point light");
  if (light.kind == shading::LightKind::directional) return;
  const auto mesh = scene.mesh.box();
  const geometry::Box3d box{geometry::Vec3d(mesh.low), geometry::Vec3d(mesh.high)};
  const double away = std::hypot(light.position[0], light.position[1], light.position[2]);
  const double rounded = geometry::tolerance::unit_roundoff<double> * away, size = length(box.extent());
  bool lost = rounded > geometry::tolerance::shadow_depth_slack * size;
  if (!lost) try {
      const auto view = shading::shadow::fit_view(light, box);
      lost = !(view.near < view.far);
    } catch (const shading::InvalidScene&) {  // of maps alone; rays may take it
    }
  if (lost)
    throw shading::InvalidScene(fmt::format(
        "the light is {:.3g} m away, which doubles round by {:.2g} m: the depths of a scene of {:.3g} m "
        "are lost in that; take a directional light",
        away, rounded, size));
}

void take_scene(BlockInput& input, datasets::Dataset&& dataset, const RunContext& context, int version) {
  if (const auto given = context.own.find("--light"); given != context.own.end())
    dataset.scene.light = datasets::parse_light(given->second),
    dataset.scene.name.clear();  // what is known of the scene is so under its own light
  check_light(dataset.scene);
  input.dataset_hash = dataset.hash(), input.seed = dataset.seed;
  input.scene = std::move(dataset.scene);
  input.truth_cache = context.truth_cache, input.version = version;
}

}  // namespace

ShadowTask::ShadowTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<TaskFlag> ShadowTask::flags() const {
  return {{"--light", std::string("Another light for the scene: ") + datasets::light_syntax}};
}

void ShadowTask::check_flags(const RunContext& context) const {
  if (const auto given = context.own.find("--light"); given != context.own.end()) try {
      datasets::parse_light(given->second);
    } catch (const std::exception& e) {
      throw std::invalid_argument("--light " + given->second + ": " + e.what());
    }
}

std::vector<BlockSpec> ShadowTask::blocks(Profile profile) const {
  if (profile == Profile::smoke) return {{"half_plane_edge", 100}};
  std::vector<BlockSpec> out{{"tilted_plane", 200},
                             {"tilted_plane_85_0", 200},
                             {"half_plane_edge", 200},
                             {"sphere_over_floor", 5'000},
                             {"wall_on_floor", 200},
                             {"slab_and_sheet", 200},
                             {"two_stacked", 200},
                             {"three_layers", 200},
                             {"slit", 200},
                             {"picket_fence", 2'000},
                             {"leaves", profile == Profile::quick ? 20'000u : 100'000u},
                             {"city", 20'000},
                             {"open_casters", 500}};
  if (profile == Profile::full) {
    out.push_back({"leaves", 1'000'000});
    out.push_back({"city", 200'000});
  }
  return out;
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
    datasets::Dataset dataset;
    dataset.kind = datasets::Kind::scene, dataset.seed = context.seed, dataset.scene = std::move(c.scene);
    BlockInput input;
    take_scene(input, std::move(dataset), {.seed = context.seed, .truth_cache = context.truth_cache},
               version());
    input.closed_form = form_of(c.known), input.lines = c.known.lines, input.frames = c.frames;
    input.truth = truth_options(Profile::quick, context.seed);
    input.must_answer = c.expect == datasets::Expect::answers;
    auto block = std::make_unique<ShadowBlock>(registered(), std::move(input));
    block->find_truth();  // once, for all the children
    return block;
  }
  throw std::invalid_argument("no hard case for shadows is called '" + spec.dataset + "'");
}

std::unique_ptr<Block> ShadowTask::open(datasets::Dataset dataset, const RunContext& context) const {
  if (dataset.kind != datasets::Kind::scene || dataset.scene.mesh.faces.empty())
    throw std::invalid_argument("'" + dataset.name +
                                "' is no scene with triangles; the task shadow needs one");
  const Size size = image_size(context.profile);
  dataset.scene.camera.width = size.width, dataset.scene.camera.height = size.height;
  BlockInput input;
  const std::string name = dataset.scene.name;
  take_scene(input, std::move(dataset), context, version());
  if (datasets::is_scene(name)) {  // not a user's mesh, whatever the name of its file
    const datasets::KnownShadows known = datasets::known_shadows(name);
    if (datasets::is_scene_of(name, "tilted_plane")) input.only = {of_planes.begin(), of_planes.end()};
    if (!context.own.contains("--light")) input.closed_form = form_of(known), input.lines = known.lines;
    // Maps for every frame take their time.
    if (datasets::is_scene_of(name, "half_plane_edge") && context.profile != Profile::quick)
      input.frames = frames;
  }
  input.truth = truth_options(context.profile, context.seed);
  input.threads = all_threads();
  input.quick = context.profile != Profile::full;
  return std::make_unique<ShadowBlock>(registered(), std::move(input));
}

void ShadowTask::pictures(const BlockSpec& spec, const RunContext& context, const std::string& folder) const {
  const auto block = open(spec, context);
  draw_pictures(registered(), dynamic_cast<ShadowBlock&>(*block), named(spec.dataset, context), all_threads(),
                folder);
}

}  // namespace treeline::bench::shadow
