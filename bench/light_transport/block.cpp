#include "bench/light_transport/block.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/core/refusal.hpp"
#include "bench/core/truth_cache.hpp"
#include "bench/light_transport/judge.hpp"

namespace treeline::bench::light_transport {
namespace {

using geometry::Vec3d;

class FilmSubject final : public Subject {
 public:
  FilmSubject(const Method& method, const Input& input, const Knobs& knobs,
              const std::vector<Question>& questions, bool must_answer)
      : questions_(questions) {
    keep_refusal(must_answer, refusal, [&] { subject_ = method.build(input, knobs); });
  }

  void run(std::size_t set, const Knobs& knobs, int threads) override {
    if (!subject_) return;
    film = subject_->render(questions_[set], knobs, threads, traced);
  }

  Film film{1, 1};
  Traced traced;
  std::string refusal;

 private:
  const std::vector<Question>& questions_;
  std::unique_ptr<RoomSubject> subject_;
};

/// How many rays a path takes, and for Whitted tracing how many a primary ray becomes, by the bounce.
void note_rays(const Traced& traced, Knobs& extra) {
  const double paths = std::max(1.0, traced.paths);
  extra["light_transport_rays"] = traced.rays / paths;
  extra["light_transport_shadow_rays"] = traced.shadow_rays / paths;
  double all = 1;
  for (std::size_t k = 0; k < traced.bounces.size(); ++k) {
    const BounceRays& b = traced.bounces[k];
    const std::string bounce = std::to_string(k + 1);
    all += (b.reflected + b.refracted) / paths;
    extra["light_transport_bounce_" + bounce] = (b.reflected + b.refracted) / paths;
    extra["light_transport_shadow_" + bounce] = b.shadow / paths;
  }
  if (!traced.bounces.empty()) extra["light_transport_all_rays"] = all;
}

/// The truth as numbers, and back.
std::vector<double> packed(const Truth& truth) {
  std::vector<double> out{truth.floor, truth.samples};
  for (const Vec3d& r : truth.radiance) out.insert(out.end(), {r[0], r[1], r[2]});
  for (const auto& bounce : truth.bounces.bounces) out.insert(out.end(), bounce.begin(), bounce.end());
  return out;
}
Truth unpacked(const std::vector<double>& numbers, std::size_t pixels, bool walls) {
  Truth truth;
  truth.floor = numbers[0], truth.samples = numbers[1], truth.walls = walls;
  auto at = numbers.begin() + 2;
  for (std::size_t p = 0; p < pixels; ++p, at += 3) truth.radiance.push_back({at[0], at[1], at[2]});
  for (; at != numbers.end(); at += box_walls)
    std::copy_n(at, box_walls, truth.bounces.bounces.emplace_back().begin());
  truth.bounces.error = walls ? truth.floor : 0;
  return truth;
}

}  // namespace

LightBlock::LightBlock(const std::vector<Method>& methods, BlockInput input)
    : methods_(methods), input_(std::move(input)) {
  const shading::Camera& camera = input_.room.camera;
  if (camera.width < 1 || camera.height < 1)
    throw std::invalid_argument("the room's image has " + std::to_string(camera.width) + " x " +
                                std::to_string(camera.height) + " pixels");
  const auto add = [&](const char* name, Question question) {
    const auto pixels = static_cast<std::size_t>(question.width) * static_cast<std::size_t>(question.height);
    query_sets_.push_back({name + input_.suffix, pixels});
    questions_.push_back(std::move(question));
  };
  add("image", {camera.width, camera.height, {}});
  if (input_.walls)
    add("walls", {int(box_walls), input_.wall_repeats, rays_at_walls(input_.walls->lamp_side)});
  truths_.resize(questions_.size());
}

std::unique_ptr<Subject> LightBlock::build(std::size_t m, const Knobs& knobs, int threads) {
  return std::make_unique<FilmSubject>(methods_[m], Input{input_.room, threads, input_.seed}, knobs,
                                       questions_, input_.must_answer);
}

bool LightBlock::offers(std::size_t m) const {
  const auto has = [&](std::initializer_list<shading::SurfaceKind> kinds) {
    return std::ranges::any_of(input_.room.materials, [&](const shading::Material& material) {
      return std::ranges::find(kinds, material.kind) != kinds.end();
    });
  };
  const Method& method = methods_[m];
  if (!method.mirrors && has({shading::SurfaceKind::mirror, shading::SurfaceKind::glass})) return false;
  if (method.for_metal && !has({shading::SurfaceKind::microfacet})) return false;
  return input_.only.empty() || std::ranges::find(input_.only, method.info.name) != input_.only.end();
}

const Film& LightBlock::film(const Subject& subject) {
  return dynamic_cast<const FilmSubject&>(subject).film;
}

void LightBlock::find_truth() {
  if (input_.must_refuse) return;
  for (std::size_t set = 0; set < questions_.size(); ++set) truth(set);
}

const Truth& LightBlock::truth(std::size_t query_set) {
  auto& truth = truths_[query_set];
  if (!truth) truth = find(query_set);
  return *truth;
}

Truth LightBlock::find(std::size_t query_set) const {
  const bool walls = static_cast<bool>(questions_[query_set].source);
  if (!walls && input_.form) return formula_truth(input_.room, input_.form);
  const TruthKey key{walls ? "light_transport_walls" : "light_transport", input_.version, input_.dataset_hash,
                     walls ? 0 : truth_hash(input_.truth)};
  const std::size_t pixels = walls ? box_walls : query_sets_[query_set].size;
  if (const auto cached = load_truth_as<double>(input_.truth_cache, key);
      cached && cached->size() >= 2 + 3 * pixels && (cached->size() - 2 - 3 * pixels) % box_walls == 0)
    return unpacked(*cached, pixels, walls);
  Truth truth = walls ? wall_truth(*input_.walls) : traced_truth(input_.room, input_.truth, input_.threads);
  store_truth(input_.truth_cache, key, packed(truth));
  return truth;
}

Errors LightBlock::check(std::size_t m, const Subject& subject, std::size_t query_set, const Knobs& knobs) {
  const auto& made = dynamic_cast<const FilmSubject&>(subject);
  if (!made.refusal.empty()) return refused_wrongly(made.refusal);
  if (input_.must_refuse) {
    Errors e;
    e.within_claim = false, e.reason = "answered what must be refused";
    return e;
  }
  const Method& method = methods_[m];
  const Truth& is = truth(query_set);
  const bool ends = knobs.contains("bounces");  // what that leaves is known of walls
  const bool unbiased =
      method.info.claim == Claim::stochastic && (method.combines || !input_.seldom) && (!ends || is.walls);
  std::vector<Vec3d> left;
  if (unbiased && ends)
    for (const double x : is.bounces.sum(knobs.at("bounces").get<std::size_t>()))
      left.push_back(Vec3d::filled(x));
  Errors e = judged(made.film, is, unbiased, left);
  note_rays(made.traced, e.extra);
  if (is.walls) note_walls(made.film, is, knobs, e.extra);
  return e;
}

/// Of the floor: how much darker it is told than it is, and how much darker so many bounces leave it.
void LightBlock::note_walls(const Film& film, const Truth& truth, const Knobs& knobs, Knobs& extra) const {
  constexpr auto floor = static_cast<std::size_t>(BoxWall::floor);
  double sum = 0, squares = 0;
  for (std::size_t p = floor; p < film.size(); p += box_walls) {
    const double x = film.mean(p)[1];
    sum += x, squares += x * x;
  }
  const double n = static_cast<double>(film.size() / box_walls), mean = sum / n,
               is = truth.radiance[floor][1];
  extra["light_transport_floor_bias"] = mean / is - 1;
  extra["light_transport_floor_error"] = std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1)) / is;
  if (knobs.contains("bounces"))
    extra["light_transport_floor_exact"] =
        truth.bounces.sum(knobs.at("bounces").get<std::size_t>())[floor] / is - 1;
}

}  // namespace treeline::bench::light_transport
