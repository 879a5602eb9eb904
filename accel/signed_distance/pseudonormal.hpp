// Inside or outside by the normal at the closest point: of a face, an edge or a corner.
//
// Source: Baerentzen and Aanaes 2005, "Signed distance computation using the angle weighted pseudonormal": a
// point is outside if and only if it lies on the side that the normal at its closest point looks to, where an
// edge has the sum of its two faces' unit normals and a corner the sum of its faces' normals weighted by
// their angles there. Corners at equal positions are one, so that soups are answered as welded meshes are.
// Faces without area have no normal and give none to anyone; where they lie between two others as a flat
// seam, the normals of both sides of the seam are added up on its edges, as if the faces met there. On which
// side of a face a point lies is decided exactly; edges and corners are taken from the mesh, not from the
// rounded closest point. Needs a closed, oriented mesh, beyond whose box nothing is inside; with others it
// answers by the nearest face, which near a hole's rim and beside faces turned around is wrong. Cost: the
// closest point, and 40 bytes a face. Known weakness: two faces in one place that look opposite ways, as
// where closed boxes touch, are equally near and say opposite things: points nearest to them are told right
// on one side and wrong on the other, though the mesh is closed and oriented (FirstHit has an answer). Points
// on a part of the mesh that has no area at all are told inside. A
// closest point found in float may belong to a triangle that is not nearest, where two parts of the surface
// are as far to the last digits, or where the mesh is of mixed scale and the tree has lost coordinates
// (triangle_scale.hpp); the sign is that of the part found.
#pragma once

#include <numbers>
#include <numeric>

#include "accel/concepts.hpp"
#include "geometry/exact/orientation.hpp"
#include "geometry/exact/triangle_distance.hpp"
#include "geometry/mesh.hpp"
#include "geometry/weld.hpp"

namespace treeline::accel {

/// Normals of faces, edges and corners of a mesh; a part of it that has none, for want of faces with area,
/// has zeros.
template <class T>
class PseudonormalTable {
 public:
  using Normal = geometry::Vec3d;
  /// Throws InvalidInput for a face that names no vertex.
  explicit PseudonormalTable(const geometry::Mesh<T>& mesh) : corners_(mesh.size()) {
    const std::vector<std::uint32_t> welded = geometry::first_at_position(mesh.vertices);
    for (std::size_t f = 0; f < mesh.size(); ++f)
      for (std::size_t i = 0; i < 3; ++i) {
        if (mesh.faces[f][i] >= welded.size())
          throw InvalidInput("face " + std::to_string(f) + " names vertex " +
                             std::to_string(mesh.faces[f][i]) + " of " + std::to_string(welded.size()));
        corners_[f][i] = welded[mesh.faces[f][i]];
      }
    vertices_ = mesh.vertices;
    sum_up();
  }

  /// Whether nothing beyond its box can be behind the mesh: it is closed, with faces that run opposite ways
  /// at every edge.
  bool encloses() const { return encloses_; }
  const geometry::Box<T, 3>& box() const { return box_; }

  /// Whether q, whose closest point is on the given feature of a face, lies behind it; on the face, too.
  bool is_behind(const geometry::Vec<T, 3>& q, std::size_t face, Feature feature) const {
    const geometry::Triangle3d t = triangle(face);
    const geometry::Vec3d point(q), corner[3] = {t.a, t.b, t.c};
    int number = static_cast<int>(feature);
    if (number == 0) {
      const int side = geometry::orientation(t.a, t.b, t.c, point);
      if (side != 0 || !geometry::is_degenerate(t)) return side <= 0;
      number = 1 + longest_side(t);  // one without area is no more than that
    }
    if (number > 3) {
      const auto i = static_cast<std::size_t>(number - 4);
      return dot(point - corner[i], of_vertex_[corners_[face][i]]) < 0;
    }
    const auto i = static_cast<std::size_t>(number - 1);
    const geometry::Vec3d from = corner[i], along = corner[(i + 1) % 3] - from;
    const double whole = length2(along);
    const double s = whole > 0 ? std::clamp(dot(point - from, along) / whole, 0.0, 1.0) : 0;
    return dot(point - (from + along * s), of_edge_[edge_[face][i]]) < 0;
  }
  std::size_t bytes() const {
    return vertices_.capacity() * sizeof(vertices_[0]) + corners_.capacity() * sizeof(corners_[0]) +
           edge_.capacity() * sizeof(edge_[0]) +
           (of_vertex_.capacity() + of_edge_.capacity()) * sizeof(Normal);
  }
  /// Unit length, or zero.
  const Normal& vertex_normal(std::size_t face, std::size_t corner) const {
    return of_vertex_[corners_[face][corner]];
  }
  const Normal& edge_normal(std::size_t face, std::size_t side) const { return of_edge_[edge_[face][side]]; }

  geometry::Triangle3d triangle(std::size_t face) const {
    const auto p = [&](std::size_t i) { return geometry::Vec3d(vertices_[corners_[face][i]]); };
    return {p(0), p(1), p(2)};
  }

 private:
  using Three = std::array<std::uint32_t, 3>;

  void sum_up() {
    std::vector<Normal> of_face(corners_.size());
    std::vector<bool> flat(corners_.size());
    for (std::size_t f = 0; f < corners_.size(); ++f) {
      const geometry::Triangle3d t = triangle(f);
      const bool finite = geometry::is_finite(t);
      if (finite)
        for (const std::uint32_t v : corners_[f]) box_.grow(vertices_[v]);
      flat[f] = !finite || geometry::is_degenerate(t);
      if (!flat[f]) of_face[f] = unit(t.area_normal());
    }
    join_edges();
    encloses_ = every_edge_balances();
    of_vertex_.assign(vertices_.size(), Normal{});
    of_edge_.assign(edges_, Normal{});
    for (std::size_t f = 0; f < corners_.size(); ++f) {
      if (flat[f]) continue;
      const geometry::Triangle3d t = triangle(f);
      const geometry::Vec3d corner[3] = {t.a, t.b, t.c};
      for (std::size_t i = 0; i < 3; ++i) {
        const Normal to_next = unit(corner[(i + 1) % 3] - corner[i]),
                     to_last = unit(corner[(i + 2) % 3] - corner[i]);
        const double angle = std::atan2(length(cross(to_next, to_last)), dot(to_next, to_last));
        of_vertex_[corners_[f][i]] += of_face[f] * angle;
        of_edge_[edge_[f][i]] += of_face[f];
      }
    }
    close_seams(flat);
    for (Normal& n : of_vertex_) n = unit(n);
    for (Normal& n : of_edge_) n = unit(n);
  }

  /// Numbers the edges: sides are put beside those of the same lower corner, and sorted there by the other.
  void join_edges() {
    struct Side {
      std::uint32_t high, face_side;
      bool operator<(const Side& o) const { return high < o.high; }
    };
    const auto ends = [&](std::size_t f, std::size_t i) {
      return std::minmax(corners_[f][i], corners_[f][(i + 1) % 3]);
    };
    std::vector<std::size_t> end(vertices_.size() + 1);  // of each lower corner's sides
    for (std::size_t f = 0; f < corners_.size(); ++f)
      for (std::size_t i = 0; i < 3; ++i) ++end[ends(f, i).first + 1];
    std::partial_sum(end.begin(), end.end(), end.begin());
    std::vector<Side> sides(3 * corners_.size());
    for (std::size_t f = 0; f < corners_.size(); ++f)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [low, high] = ends(f, i);
        sides[end[low]++] = {high, static_cast<std::uint32_t>(3 * f + i)};
      }
    edge_.resize(corners_.size());
    for (std::size_t v = 0, first = 0; v < vertices_.size(); first = end[v++]) {
      std::sort(sides.begin() + std::ptrdiff_t(first), sides.begin() + std::ptrdiff_t(end[v]));
      for (std::size_t j = first; j < end[v]; ++j) {
        if (j == first || sides[j].high != sides[j - 1].high) ++edges_;
        edge_[sides[j].face_side / 3][sides[j].face_side % 3] = static_cast<std::uint32_t>(edges_ - 1);
      }
    }
  }

  /// Whether as many finite faces run along each edge one way as the other.
  bool every_edge_balances() const {
    std::vector<std::int32_t> balance(edges_);
    for (std::size_t f = 0; f < corners_.size(); ++f) {
      if (!geometry::is_finite(triangle(f))) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t from = corners_[f][i], to = corners_[f][(i + 1) % 3];
        if (from != to) balance[edge_[f][i]] += from < to ? 1 : -1;
      }
    }
    return std::ranges::all_of(balance, [](std::int32_t b) { return b == 0; });
  }

  /// The edges of a face without area lie on one line and have the same sum: that of all. Seams of several
  /// such faces are joined by union-find.
  void close_seams(const std::vector<bool>& flat) {
    std::vector<std::uint32_t> parent;
    const auto find = [&](std::uint32_t e) {
      while (parent[e] != e) e = parent[e] = parent[parent[e]];
      return e;
    };
    for (std::size_t f = 0; f < corners_.size(); ++f) {
      const Three& c = corners_[f];
      if (!flat[f] || c[0] == c[1] || c[1] == c[2] || c[2] == c[0] || !geometry::is_finite(triangle(f)))
        continue;
      if (parent.empty()) parent.resize(edges_), std::iota(parent.begin(), parent.end(), 0u);
      for (std::size_t i = 1; i < 3; ++i) parent[find(edge_[f][i])] = find(edge_[f][0]);
      // What lies across the longest edge turns half a circle about the corner in its middle.
      const geometry::Triangle3d t = triangle(f);
      const auto longest = static_cast<std::size_t>(longest_side(t));
      of_vertex_[c[(longest + 2) % 3]] += of_edge_[edge_[f][longest]] * std::numbers::pi;
    }
    if (parent.empty()) return;
    std::vector<Normal> sum(edges_);
    for (std::uint32_t e = 0; e < edges_; ++e) sum[find(e)] += of_edge_[e];
    for (std::uint32_t e = 0; e < edges_; ++e) of_edge_[e] = sum[find(e)];
  }

  static int longest_side(const geometry::Triangle3d& t) {
    const double side[3] = {length2(t.b - t.a), length2(t.c - t.b), length2(t.a - t.c)};
    return static_cast<int>(std::max_element(side, side + 3) - side);
  }
  static Normal unit(const Normal& n) {
    const double size = length(n);
    return size > 0 ? n / size : Normal{};
  }

  std::vector<geometry::Vec<T, 3>> vertices_;
  std::vector<Three> corners_, edge_;  // of each face, by number
  std::vector<Normal> of_vertex_, of_edge_;
  std::size_t edges_ = 0;
  geometry::Box<T, 3> box_;
  bool encloses_ = false;
};

struct Pseudonormal {
  struct Options {};

  template <class Tree>
  class Rule {
    static_assert(ClosestPointIndex<Tree>, "Pseudonormal needs a tree that answers closest_point()");

   public:
    using T = typename Tree::Scalar;
    using Point = typename Tree::Point;
    using Mesh = geometry::Mesh<T>;

    Rule(const Mesh& mesh, const Tree&, const Options&, int /*threads*/) : table_(mesh) {}
    std::size_t bytes() const { return table_.bytes(); }
    const PseudonormalTable<T>& table() const { return table_; }

    bool inside(const Tree& tree, const Point& q) const { return inside(q, tree.closest_point(q)); }
    bool inside(const Point& q, const ClosestPoint<T>& closest) const {
      if (!closest) return false;
      // Far away all of a small mesh is as near to the last digits of float, its far side, too.
      if (table_.encloses() && !table_.box().contains(q)) return false;
      if (q == closest.point &&
          geometry::exact_distance2(geometry::Vec3d(q), table_.triangle(closest.primitive)) == 0)
        return true;
      return table_.is_behind(q, closest.primitive, closest.feature);
    }
    void inside(const Tree& tree, std::span<const Point> queries, std::span<std::uint8_t> out,
                int threads) const {
      std::vector<ClosestPoint<T>> closest(queries.size());
      tree.closest_point(queries, std::numeric_limits<T>::infinity(), closest, threads);
      parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) out[i] = inside(queries[i], closest[i]) ? 1 : 0;
      });
    }

   private:
    PseudonormalTable<T> table_;
  };
};

}  // namespace treeline::accel
