// Judging the answers to a set of points against the truth.
//
// error is the share of wrong answers; bias is that of points called inside which are not, less that of those
// called outside which are inside. An answer is right or wrong: there is no worst one. Points on the surface
// belong to the mesh, a closed set; they enter the error of exact methods only, for others either answer is
// right. Claims, on meshes that are whole: exact: no wrong answer. bounded: none on points that are farther
// from the surface than eps = 32 · unit_roundoff<float> · (largest |coordinate| of the mesh and the point),
// what float may leave of a ray or a distance. approximate: no single answer is promised, but no more than
// one in a hundred of a set is wrong. On damaged meshes nobody promises anything, and only the error counts.
#pragma once

#include <span>
#include <vector>

#include "bench/core/row.hpp"
#include "bench/inside/truth.hpp"

namespace treeline::bench::inside {

struct Promise {
  Claim claim = Claim::exact;
  bool whole = true;  // the mesh is closed, oriented and does not cross itself
  /// 1 or 0 of each point: whether an answer there is held to the claim. Empty: all are.
  std::span<const std::uint8_t> held = {};
};

/// Fields of its own: inside_judged, inside_false_inside, inside_false_outside, inside_on_surface and
/// inside_surface_missed (points on the surface called outside), as numbers of points.
Errors judge(const geometry::Mesh3f& mesh, std::span<const geometry::Vec3f> points,
             std::span<const Side> truth, std::span<const std::uint8_t> answers, const Promise& promise);

}  // namespace treeline::bench::inside
