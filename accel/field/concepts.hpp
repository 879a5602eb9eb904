// What a distance field is, whether a formula or samples of a mesh: a signed distance at every point,
// negative inside, and how far it can be trusted. Whoever casts rays needs no more (sphere_trace.hpp).
#pragma once

#include <concepts>

#include "geometry/vec.hpp"

namespace treeline::accel::field {

using geometry::Vec3d;
using geometry::Vec3f;

/// The distance at a point and what is certain about it.
struct FieldSample {
  double distance = 0;  ///< signed, negative inside; in units of the mesh
  /// The true signed distance differs by no more. Where `known` is false: |distance| - error, if positive, is
  /// a lower bound of the true one, and the sign is then right. Samples that are not known have no error,
  /// what is made of two fields has the larger one of theirs.
  double error = 0;
  bool known = true;

  /// The surface is at least this far away, for certain; never negative.
  double clearance() const {
    const double least = (distance < 0 ? -distance : distance) - error;
    return least > 0 ? least : 0;
  }
};

/// distance(p) and sample(p).distance are the same number. gradient(p) is that of distance(p), so not of unit
/// length where the field is approximate; zero or one of many where it has none. lipschitz(): |distance(p) -
/// distance(q)| ≤ lipschitz() |p - q|, as long as the field is known along the way.
template <class F>
concept DistanceField = requires(const F& field, const Vec3d& p) {
  { field.distance(p) } -> std::same_as<double>;
  { field.gradient(p) } -> std::same_as<Vec3d>;
  { field.sample(p) } -> std::same_as<FieldSample>;
  { field.lipschitz() } -> std::same_as<double>;
};

}  // namespace treeline::accel::field
