#include "bench/ray/subject.hpp"

#include <algorithm>
#include <chrono>

namespace treeline::bench::ray {
namespace {

constexpr double long_update_s = 0.1;  // longer ones are not repeated
constexpr int updates = 3;
constexpr std::size_t counted_rays = 4096;  // at most, evenly spread, where work is counted

/// Seconds of the fastest of a few calls.
template <class F>
double timed(F update) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < updates; ++i) {
    const auto start = std::chrono::steady_clock::now();
    update();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    if (best > long_update_s) break;
  }
  return best;
}

}  // namespace

RaySubject::RaySubject(const Method& method, const Knobs& knobs, int threads,
                       const std::vector<geometry::Mesh3f>& frames, const std::vector<RaySet>& sets)
    : method_(method),
      knobs_(knobs),
      frames_(frames),
      sets_(sets),
      index_(method.build(frames.front(), knobs, threads)) {}

void RaySubject::prepare(std::size_t set, int threads) {
  moved_.reset();
  update_seconds_.reset();
  const RaySet& s = sets_[set];
  if (s.update == Update::none) return;
  const geometry::Mesh3f& mesh = frames_[s.frame];
  if (s.update == Update::rebuild) {
    update_seconds_ = timed([&] { moved_.reset(), moved_ = method_.build(mesh, knobs_, threads); });
    return;
  }
  // To where it is already: asks whether the method can, and changes nothing.
  if (!index_->refit(frames_.front())) throw Unsupported("has no refit");
  moved_ = method_.build(frames_.front(), knobs_, threads);
  update_seconds_ = timed([&] { moved_->refit(mesh); });
}

void RaySubject::run(std::size_t set, const Knobs& knobs, int threads) {
  const auto& rays = sets_[set].rays;
  if (sets_[set].any) {
    blocked.resize(rays.size());
    index().any(rays, blocked, knobs, threads);
  } else {
    hits.resize(rays.size());
    index().closest(rays, hits, knobs, threads);
  }
}

std::optional<std::pair<double, double>> RaySubject::work(std::size_t set, const Knobs&) {
  const auto& rays = sets_[set].rays;
  if (rays.size() <= counted_rays) return index().work(rays, sets_[set].any);
  std::vector<geometry::Rayf> some;
  for (std::size_t i = 0; i < counted_rays; ++i) some.push_back(rays[i * rays.size() / counted_rays]);
  return index().work(some, sets_[set].any);
}

}  // namespace treeline::bench::ray
