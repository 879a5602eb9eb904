// How a sampled field learns on which side of a mesh its samples lie: a policy with inside(point), and if it
// knows a short cut near the surface, side(point, closest point).
//
// A mesh that is closed and oriented has one answer whoever asks. One that is not has none everywhere, and
// policies differ: facing goes by the nearest faces and repairs small holes, a winding number averages.
#pragma once

#include <optional>

#include "accel/triangle_queries.hpp"
#include "accel/volume.hpp"
#include "geometry/exact/orientation.hpp"
#include "geometry/mesh.hpp"

namespace treeline::accel::field {

template <class S>
concept InsidePolicy = requires(const S& sign, const Vec3f& p) {
  { sign.inside(p) } -> std::convertible_to<bool>;
};

/// The policy knows the side of a point from its closest point alone, at times.
template <class S>
concept SidePolicy = InsidePolicy<S> &&
    requires(const S& sign, const Vec3d& p, const ClosestPoint<float>& closest) {
  { sign.side(p, closest) } -> std::same_as<std::optional<bool>>;  // true: inside
};

/// By the face that is nearest, where the closest point lies within it: nothing stands between, so that the
/// side of its plane, decided exactly, is the side of the surface. Elsewhere by the face that a ray meets
/// first (accel/volume.hpp). For closed, oriented meshes whose faces neither cross
/// nor coincide: of two at one place the lower id decides, which may be the wrong one.
template <class Tree>
class Facing {
 public:
  /// Both must outlive the policy; the tree is over the mesh's faces.
  Facing(const geometry::Mesh3f& mesh, const Tree& tree) : mesh_(mesh), tree_(tree) {}

  bool inside(const Vec3f& p) const {
    if constexpr (VolumeIndex<Tree>)
      return tree_.contains(p);
    else
      return tree_.bounds().contains(p) &&
             votes_inside(p, [&](const geometry::Rayf& ray) { return Cast(mesh_, tree_.closest_hit(ray)); });
  }
  std::optional<bool> side(const Vec3d& p, const ClosestPoint<float>& closest) const {
    if (closest.feature != Feature::face) return std::nullopt;
    const geometry::Triangle3d t(mesh_.triangle(closest.primitive));
    return geometry::orientation(t.a, t.b, t.c, p) <= 0;
  }

 private:
  /// A hit as votes_inside() wants it.
  struct Cast {
    Cast(const geometry::Mesh3f& mesh, const Hit<float>& hit) : hit_(hit) {
      if (hit) stored_ = {mesh.triangle(hit.primitive), hit.primitive};
    }
    const Hit<float>& hit() const { return hit_; }
    const StoredTriangle<float>* stored() const { return &stored_; }
    Hit<float> hit_;
    StoredTriangle<float> stored_{};
  };

  const geometry::Mesh3f& mesh_;
  const Tree& tree_;
};

/// Whatever answers inside(Vec3f) or is callable so, asked for every patch of samples: no short cuts.
template <class F>
class InsideBy {
 public:
  explicit InsideBy(F f) : f_(std::move(f)) {}
  bool inside(const Vec3f& p) const { return f_(p); }

 private:
  F f_;
};

}  // namespace treeline::accel::field
