// A tree over a mesh and a rule for the sign, put together: see accel/signed_distance.hpp.
#pragma once

#include "accel/signed_distance/first_hit.hpp"
#include "geometry/closedness.hpp"
#include "geometry/distance.hpp"

namespace treeline::accel {

/// What Sign::Rule<Tree> offers: built from a mesh and a tree over it, it tells which points are inside.
template <class Sign, class Tree>
concept SignOf = requires(const typename Sign::template Rule<Tree>& rule, const Tree& tree,
                          const typename Tree::Point& q, std::span<const typename Tree::Point> queries,
                          std::span<std::uint8_t> out, int threads) {
  typename Sign::Options;
  { rule.inside(tree, q) } -> std::same_as<bool>;
  rule.inside(tree, queries, out, threads);
  { rule.bytes() } -> std::same_as<std::size_t>;
};

template <class Tree, class Sign = FirstHit>
class SignedDistance {
 public:
  using Scalar = typename Tree::Scalar;
  using Point = typename Tree::Point;
  using Mesh = geometry::Mesh<Scalar>;
  using Rule = typename Sign::template Rule<Tree>;
  static_assert(SignOf<Sign, Tree>);
  using TreeOptions = typename Tree::Options;
  using SignOptions = typename Sign::Options;

  /// Throws InvalidInput for what the tree does not take: a vertex that is not finite, a face that names no
  /// vertex; and for threads < 1. Nothing is kept of the mesh but what tree and rule copy, and the faces
  /// where squared distances may underflow or overflow. Faces that the tree drops as not finite are left out
  /// by every rule.
  explicit SignedDistance(const Mesh& mesh, const TreeOptions& tree_options = {},
                          const SignOptions& sign_options = {}, int threads = 1)
      : SignedDistance(mesh, Tree(mesh, tree_options), sign_options, threads) {}
  /// With a tree that was built over the same mesh. Throws InvalidInput for a face that names no vertex,
  /// a tree over another number of faces, or threads < 1.
  SignedDistance(const Mesh& mesh, Tree tree, const SignOptions& sign_options = {}, int threads = 1)
      : tree_(std::move(tree)),
        closedness_(checked_closedness(mesh, tree_, threads)),
        rule_(mesh, tree_, sign_options, threads),
        extreme_(extreme(mesh)) {}

  /// Whether every edge has an even number of faces, corners at equal positions being one and faces that are
  /// not finite missing.
  bool closed() const { return closedness_.closed; }
  /// Whether, besides, faces at an edge run opposite ways; FirstHit and Pseudonormal rely on both. That is
  /// not all they need: a mesh that crosses itself can have both, and so can one with two faces in one place,
  /// as where boxes touch, between which Pseudonormal has no answer (pseudonormal.hpp).
  bool oriented() const { return closedness_.oriented; }

  /// Throw InvalidInput for a query that is not finite, and batches for room that is not as many as the
  /// queries or threads < 1.
  bool inside(const Point& q) const {
    check({&q, 1});
    return rule_.inside(tree_, q);
  }
  void inside(std::span<const Point> queries, std::span<std::uint8_t> out, int threads) const {
    check(queries), check_room(queries.size(), out.size()), check_threads(threads);
    rule_.inside(tree_, queries, out, threads);
  }

  /// In the mesh's units: negative inside, 0 on the surface; infinite if there are no triangles. As the
  /// queries above where those throw.
  Scalar signed_distance(const Point& q) const requires ClosestPointIndex<Tree> {
    check({&q, 1});
    const ClosestPoint<Scalar> closest = tree_.closest_point(q);
    if constexpr (sign_of_closest)
      return with_sign(q, closest, [&] { return rule_.inside(q, closest); });
    else
      return with_sign(q, closest, [&] { return rule_.inside(tree_, q); });
  }
  void signed_distance(std::span<const Point> queries, std::span<Scalar> out,
                       int threads) const requires ClosestPointIndex<Tree> {
    check(queries), check_room(queries.size(), out.size()), check_threads(threads);
    std::vector<ClosestPoint<Scalar>> closest(queries.size());
    tree_.closest_point(queries, std::numeric_limits<Scalar>::infinity(), closest, threads);
    std::vector<std::uint8_t> inside(sign_of_closest ? 0 : queries.size());
    if constexpr (!sign_of_closest) rule_.inside(tree_, queries, inside, threads);
    parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        out[i] = with_sign(queries[i], closest[i], [&] {
          if constexpr (sign_of_closest)
            return rule_.inside(queries[i], closest[i]);
          else
            return inside[i] != 0;
        });
    });
  }

  const Tree& tree() const { return tree_; }
  const Rule& rule() const { return rule_; }
  std::size_t bytes() const {
    return tree_.bytes() + sizeof(*this) - sizeof(Tree) + rule_.bytes() +
           extreme_.capacity() * sizeof(geometry::Triangle<Scalar>);
  }

 private:
  /// Whether the closest point alone gives the sign.
  static constexpr bool sign_of_closest =
      requires(const Rule& rule, const Point& q, const ClosestPoint<Scalar>& c) {
    rule.inside(q, c);
  };

  template <class Inside>
  Scalar with_sign(const Point& q, const ClosestPoint<Scalar>& closest, Inside&& inside) const {
    if (!closest) return std::numeric_limits<Scalar>::infinity();
    // Squares lose their digits long before distances do.
    constexpr Scalar least = std::numeric_limits<Scalar>::min() * Scalar(1 << 24);
    const bool holds = closest.distance2 > least && std::isfinite(closest.distance2);
    const Scalar d = holds ? std::sqrt(closest.distance2) : apart(q, closest);
    return d != 0 && inside() ? -d : d;
  }
  /// The distance where its square is no number, or has no digits.
  [[gnu::noinline, gnu::cold]] Scalar apart(const Point& q, const ClosestPoint<Scalar>& closest) const {
    geometry::Vec3d from(q);
    if (extreme_.empty()) return static_cast<Scalar>(length_of(from - geometry::Vec3d(closest.point)));
    // The closest point is rounded by more than it may be away: anew, in double and about 1.
    const geometry::Triangle3d t(extreme_[closest.primitive]);
    double largest = 0;
    for (const geometry::Vec3d& p : {from, t.a, t.b, t.c})
      for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(p[k]));
    const int exponent = largest > 0 ? std::ilogb(largest) : 0;
    const auto scaled = [&](const geometry::Vec3d& p) {
      return geometry::Vec3d{std::scalbn(p[0], -exponent), std::scalbn(p[1], -exponent),
                             std::scalbn(p[2], -exponent)};
    };
    from = scaled(from);
    const double d2 =
        closest_point_on_triangle(from, geometry::Triangle3d{scaled(t.a), scaled(t.b), scaled(t.c)})
            .distance2;
    return static_cast<Scalar>(std::scalbn(std::sqrt(d2), exponent));
  }
  static double length_of(const geometry::Vec3d& v) { return std::hypot(v[0], v[1], v[2]); }
  /// All faces, of a mesh whose squared distances may leave the range of Scalar; else none.
  static std::vector<geometry::Triangle<Scalar>> extreme(const Mesh& mesh) {
    constexpr int comfortable = std::numeric_limits<Scalar>::max_exponent * 3 / 16;
    Scalar largest = 0;
    for (const Point& p : mesh.vertices)
      for (int k = 0; k < 3; ++k)
        if (std::isfinite(p[k])) largest = std::max(largest, std::abs(p[k]));
    std::vector<geometry::Triangle<Scalar>> faces;
    if (largest == 0 || std::abs(std::ilogb(largest)) < comfortable) return faces;
    faces.reserve(mesh.size());
    for (std::size_t f = 0; f < mesh.size(); ++f) faces.push_back(mesh.triangle(f));
    return faces;
  }
  static geometry::Closedness checked_closedness(const Mesh& mesh, const Tree& tree, int threads) {
    check_threads(threads);
    if constexpr (Inspectable<Tree>) {
      const TreeStats stats = tree.stats();
      if (stats.primitives + stats.dropped != mesh.size())
        throw InvalidInput("the tree is over " + std::to_string(stats.primitives + stats.dropped) +
                           " faces, the mesh has " + std::to_string(mesh.size()));
    }
    for (std::size_t f = 0; f < mesh.size(); ++f)
      for (const std::uint32_t corner : mesh.faces[f])
        if (corner >= mesh.vertices.size())
          throw InvalidInput("face " + std::to_string(f) + " names vertex " + std::to_string(corner) +
                             " of " + std::to_string(mesh.vertices.size()));
    return geometry::closedness(mesh);
  }
  static void check(std::span<const Point> queries) {
    for (std::size_t i = 0; i < queries.size(); ++i)
      if (!is_finite(queries[i]))
        throw InvalidInput("query " + std::to_string(i) + " has a coordinate that is not finite");
  }

  Tree tree_;
  geometry::Closedness closedness_;
  Rule rule_;
  std::vector<geometry::Triangle<Scalar>> extreme_;  // see there
};

}  // namespace treeline::accel
