#include "bench/inside/judge.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "geometry/distance.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::inside {
namespace {

using geometry::Vec3d;
using geometry::Vec3f;

constexpr double tolerated = 0.01;  // share of wrong answers of a method that promises no single one

/// Whether the point is within eps of a triangle.
bool is_close(const geometry::Mesh3f& mesh, const Vec3f& p) {
  double largest = 0;
  const auto take = [&](const Vec3f& v) {
    for (int k = 0; k < 3; ++k)
      if (std::isfinite(v[k])) largest = std::max(largest, std::abs(double(v[k])));
  };
  take(p);
  for (const Vec3f& v : mesh.vertices) take(v);
  const double eps = 32 * double(geometry::tolerance::unit_roundoff<float>) * largest;
  for (std::size_t f = 0; f < mesh.size(); ++f) {
    const geometry::Triangle3d t(mesh.triangle(f));
    if (geometry::is_finite(t) && geometry::closest_point_on_triangle(Vec3d(p), t).distance2 <= eps * eps)
      return true;
  }
  return false;
}

}  // namespace

Errors judge(const geometry::Mesh3f& mesh, std::span<const Vec3f> points, std::span<const Side> truth,
             std::span<const std::uint8_t> answers, const Promise& promise) {
  Errors result;
  std::size_t held = 0, held_wrong = 0;
  std::size_t judged = 0, false_inside = 0, false_outside = 0, on = 0, missed = 0, close_looks = 0;
  const std::size_t most_looks = 200'000'000 / (mesh.size() + 1) + 1;  // each looks at the whole mesh
  const auto excused = [&](std::size_t i) {
    return promise.claim == Claim::bounded && close_looks++ < most_looks && is_close(mesh, points[i]);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool answer = answers[i] != 0;
    bool wrong = false;
    if (truth[i] == Side::surface) {
      if (!geometry::is_finite(points[i])) continue;
      ++on, missed += !answer;
      if (promise.claim != Claim::exact) continue;
      wrong = !answer;
    } else {
      wrong = answer != (truth[i] == Side::inside);
    }
    ++judged;
    const bool is_held = promise.whole && (promise.held.empty() || promise.held[i] != 0);
    held += is_held, held_wrong += is_held && wrong;
    false_inside += wrong && answer, false_outside += wrong && !answer;
    if (!wrong || !is_held || !result.within_claim || promise.claim == Claim::approximate) continue;
    if (excused(i)) continue;
    result.within_claim = false;
    const Vec3f& p = points[i];
    result.reason = fmt::format("point {} at ({}, {}, {}) is {}, answered {}", i, p[0], p[1], p[2],
                                truth[i] == Side::surface  ? "on the surface"
                                : truth[i] == Side::inside ? "inside"
                                                           : "outside",
                                answer ? "inside" : "outside");
  }
  result.extra = {{"inside_judged", judged},
                  {"inside_false_inside", false_inside},
                  {"inside_false_outside", false_outside},
                  {"inside_on_surface", on},
                  {"inside_surface_missed", missed}};
  if (judged == 0) return result;
  const auto n = static_cast<double>(judged);
  const double share = static_cast<double>(false_inside + false_outside) / n;
  result.error = result.mean = share;
  result.bias = (static_cast<double>(false_inside) - static_cast<double>(false_outside)) / n;
  if (promise.claim == Claim::approximate &&
      static_cast<double>(held_wrong) > tolerated * static_cast<double>(held)) {
    result.within_claim = false;
    result.reason = fmt::format("{} of {} answers are wrong", held_wrong, held);
  }
  return result;
}

}  // namespace treeline::bench::inside
