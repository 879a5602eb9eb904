// How a sampled field learns on which side of a mesh its samples lie: a policy with inside(point), and if it
// knows a short cut near the surface, side(point, closest point).
//
// How often a closed, oriented mesh goes around a point does not change where no face is passed; with
// "inside" where that is more than 0 times, distances are 1-Lipschitz with their sign, whatever touches,
// coincides or crosses. A mesh that is inside out goes around what it bounds -1 times, so that nothing is
// inside: FieldReport::inside_out tells. A mesh that is open has no inside everywhere, and policies differ:
// facing goes by the nearest faces and repairs small holes, a winding number averages.
#pragma once

#include <memory>
#include <optional>
#include <type_traits>

#include "accel/field/closed_cycle.hpp"
#include "accel/signed_distance/signed_distance.hpp"
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

/// The policy may find no answer; it then says so, and does not guess.
template <class S>
concept DecidingPolicy = InsidePolicy<S> && requires(const S& sign, const Vec3f& p) {
  { sign.decided(p) } -> std::same_as<std::optional<bool>>;
};

/// By the face that is nearest, where the closest point lies within it: nothing stands between, so that the
/// side of its plane, decided exactly, is the side of the surface. Elsewhere by the face that a ray meets
/// first (accel/volume.hpp). For oriented meshes whose faces neither cross nor lie in one another: of two
/// that are equally near it takes whichever the tree names.
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

/// By how often the mesh goes around a point: the crossings of one ray, counted with their signs, each
/// decided exactly (bvh/wide_crossing.hpp). A ray that meets an edge or a corner says nothing, and another
/// direction is tried. Points on the mesh are inside. For closed, oriented meshes: faces may touch, coincide
/// and cross, and what is enclosed more than 0 times is inside; of a mesh inside out, nothing.
template <class Tree>
class CrossingSum {
  using Exact = std::conditional_t<ExactCrossings<Tree>, Tree, Bvh<Triangles<float>, Wide>>;

 public:
  /// Both must outlive the policy; the tree is over the mesh's faces. A tree that does not decide crossings
  /// exactly has a wide one built beside it, of some 50 bytes a face.
  CrossingSum(const geometry::Mesh3f& mesh, const Tree& tree, int threads = 1) {
    if constexpr (ExactCrossings<Tree>) {
      exact_ = &tree;
    } else {
      WideTriangleOptions options;
      options.non_finite = NonFinite::drop, options.threads = threads;
      exact_ = (own_ = std::make_unique<Exact>(mesh, options)).get();
    }
    box_ = exact_->bounds();
    if (!box_.empty()) directions_ = ProbeDirections(box_.centre());
  }

  bool inside(const Vec3f& p) const { return decided(p).value_or(false); }
  /// None where all rays met edges.
  std::optional<bool> decided(const Vec3f& p) const {
    if (!box_.contains(p)) return false;
    const wide::Crossings<Exact> crossings(*exact_);
    for (int attempt = 0; attempt < ProbeDirections::most; ++attempt) {
      const CrossingCount count = crossings.count({p, directions_(p, attempt)});
      if (count.surface) return true;
      if (!count.unclear) return count.outward > count.inward;
    }
    return std::nullopt;
  }

 private:
  std::unique_ptr<const Exact> own_;
  const Exact* exact_ = nullptr;
  geometry::Box3f box_;
  ProbeDirections directions_;
};

/// CrossingSum where the mesh is closed, else Facing.
template <class Tree>
class MeshSign {
 public:
  /// Both must outlive the policy; the tree is over the mesh's faces. Throws InvalidInput for a face that
  /// names a vertex that is not there.
  MeshSign(const geometry::Mesh3f& mesh, const Tree& tree, int threads = 1) : facing_(mesh, tree) {
    if (is_closed_cycle(mesh)) sum_.emplace(mesh, tree, threads);
  }
  /// See is_closed_cycle().
  bool closed() const { return sum_.has_value(); }
  bool inside(const Vec3f& p) const { return decided(p).value_or(false); }
  std::optional<bool> decided(const Vec3f& p) const { return sum_ ? sum_->decided(p) : facing_.inside(p); }
  std::optional<bool> side(const Vec3d& p, const ClosestPoint<float>& closest) const {
    if (sum_) return std::nullopt;  // another face may be as near
    return facing_.side(p, closest);
  }

 private:
  Facing<Tree> facing_;
  std::optional<CrossingSum<Tree>> sum_;
};

/// By a rule of accel/signed_distance.hpp over the tree: FirstHit, RayParity, Pseudonormal or Winding, as in
/// SignBy<Winding, Tree>. What the rule does not stand, the field does not either; of shells that face the
/// same way FirstHit calls what is between them outside and RayParity every second layer, where the default
/// has all of it inside. On a mesh with holes Winding is the rule; samples of a brick that hang together
/// through a hole get one side all the same (build.hpp), and the report says that the mesh is open.
template <class Rule, class Tree>
class SignBy {
  static_assert(SignOf<Rule, Tree>);

 public:
  /// The tree must outlive the policy. Throws as the rule does.
  SignBy(const geometry::Mesh3f& mesh, const Tree& tree, const typename Rule::Options& options = {},
         int threads = 1)
      : tree_(tree), rule_(mesh, tree, options, threads) {}
  bool inside(const Vec3f& p) const { return rule_.inside(tree_, p); }

 private:
  const Tree& tree_;
  typename Rule::template Rule<Tree> rule_;
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
