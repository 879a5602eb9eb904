// What is wrong with a mesh, as far as its faces one by one and their neighbours show: the diagnosis behind
// `treeline_gen --check`. Crossings of faces far apart need a tree: accel/self_intersections.hpp.
//
// Problem: volume queries, decimation and half-edge structures need closed, oriented, manifold meshes; files
// hold others, and most programs repair them without a word. Method: adjacency by sorted half-edges
// (adjacency.hpp); fans of a vertex and components by union-find (Tarjan 1975); equal vertices by hashing,
// equal faces by sorting; which part lies in which by part_nesting.hpp. Everything goes by the indices of the
// file; `welded` says what joining vertices at equal positions would leave. Cost: O(n log n), and what
// part_nesting.hpp says. Known weakness: equal means bit for bit; vertices that nearly coincide are
// different.
#pragma once

#include <numeric>
#include <optional>

#include "geometry/adjacency.hpp"
#include "geometry/disjoint_sets.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "geometry/part_nesting.hpp"
#include "geometry/predicates.hpp"
#include "geometry/weld.hpp"

namespace treeline::geometry {

/// One kind of defect: how often, and where first.
struct Finding {
  struct Example {
    std::vector<std::uint32_t> faces, vertices;
    std::optional<Vec3d> at = {};  ///< where, if at no vertex
  };
  std::size_t count = 0;
  std::vector<Example> first;
};

struct MeshCheck {
  struct Welded {
    std::size_t vertices = 0, boundary_edges = 0, non_manifold_edges = 0, misoriented_edges = 0,
                odd_edges = 0;
    bool closed = false, oriented = false;
  };

  std::size_t vertices = 0, faces = 0, edges = 0;
  std::size_t components = 0;         ///< parts whose faces hang together by edges
  std::size_t inward_components = 0;  ///< those of negative volume: hollows, or shells inside out
  std::size_t odd_edges = 0;       ///< with an odd number of faces: one, or more than two; closed means none
  std::size_t boundary_loops = 0;  ///< of edges with one face
  bool closed = false, oriented = false;
  double volume =
      0;  ///< signed: positive if the faces look outward; of no meaning unless closed and oriented
  Welded welded;

  Finding non_finite_vertices;    ///< a coordinate is NaN or infinite
  Finding unused_vertices;        ///< no face names them
  Finding duplicate_vertices;     ///< at the position of an earlier one; examples name both
  Finding repeated_corner_faces;  ///< name a vertex twice: left out of all below
  Finding degenerate_faces;       ///< three corners on one line
  Finding duplicate_faces;     ///< of the same corners as an earlier one, either way around; both are named
  Finding boundary_edges;      ///< with one face
  Finding non_manifold_edges;  ///< with more than two
  Finding misoriented_edges;   ///< whose faces do not run opposite ways
  /// With more than two faces, vertices at equal positions joined, which do not look this way and that in
  /// turn all around: along such an edge the surface runs through itself, or a part lies within another one
  /// that looks the same way, and space beside it is enclosed twice or less than not at all. Faces without
  /// area or in one another say nothing.
  Finding crossed_edges;
  Finding non_manifold_vertices;  ///< where several fans of faces touch
  /// Closed parts that look the wrong way for where they lie: outward within a solid, or inward in the open.
  /// Looked for in closed, oriented meshes. Examples name a face; a part turned inside out is one, too.
  Finding misnested_components;

  /// With area, finite, and the first of equal ones: what crossings are worth being looked for among.
  std::vector<std::uint32_t> sound_faces;

  bool inside_out() const { return closed && oriented && faces > 0 && volume < 0; }
};

namespace detail {

class MeshChecker {
 public:
  MeshChecker(const Mesh3f& mesh, std::size_t examples) : mesh_(mesh), examples_(examples) {}

  MeshCheck operator()() {
    const Adjacency adjacency(mesh_);
    made_.vertices = mesh_.vertices.size(), made_.faces = mesh_.size(),
    made_.edges = adjacency.edges().size();
    made_.closed = adjacency.closed(), made_.oriented = adjacency.oriented();
    made_.odd_edges = adjacency.odd_edges(), made_.boundary_loops = adjacency.boundary_loops();
    check_vertices();
    check_faces();
    check_edges(adjacency);
    check_fans(adjacency);
    check_components(adjacency);
    if (made_.closed && made_.oriented && made_.components > 1) check_nesting();
    weld();
    return std::move(made_);
  }

 private:
  void found(Finding& finding, std::vector<std::uint32_t> faces, std::vector<std::uint32_t> vertices) {
    if (finding.count++ < examples_) finding.first.push_back({std::move(faces), std::move(vertices)});
  }
  static bool repeats(const Adjacency::Face& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; }

  void check_vertices() {
    std::vector<bool> used(mesh_.vertices.size());
    for (const auto& face : mesh_.faces)
      for (const std::uint32_t v : face) used[v] = true;
    first_at_ = first_at_position(mesh_.vertices);
    for (std::uint32_t v = 0; v < first_at_.size(); ++v) {
      if (!used[v]) found(made_.unused_vertices, {}, {v});
      if (!is_finite(mesh_.vertices[v])) found(made_.non_finite_vertices, {}, {v});
    }
    for (std::uint32_t v = 0; v < first_at_.size(); ++v)
      if (first_at_[v] != v) found(made_.duplicate_vertices, {}, {v, first_at_[v]});
  }

  void check_faces() {
    using Keyed = std::pair<Adjacency::Face, std::uint32_t>;
    std::vector<Keyed> keyed;
    std::vector<bool> sound(mesh_.size());
    for (std::uint32_t f = 0; f < mesh_.size(); ++f) {
      if (repeats(mesh_.faces[f])) {
        found(made_.repeated_corner_faces, {f}, corners(f));
        continue;
      }
      const Triangle3f t = mesh_.triangle(f);
      sound[f] = is_finite(t) && !is_degenerate(t);
      if (is_finite(t) && !sound[f]) found(made_.degenerate_faces, {f}, corners(f));
      Adjacency::Face key = mesh_.faces[f];
      for (std::uint32_t& v : key) v = first_at_[v];  // copies of a face in a soup share no index
      std::sort(key.begin(), key.end());
      keyed.push_back({key, f});
    }
    std::sort(keyed.begin(), keyed.end());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> copies;
    for (std::size_t first = 0, i = 1; i < keyed.size(); ++i) {
      if (keyed[i].first != keyed[first].first)
        first = i;
      else if (!repeats(keyed[i].first))
        copies.push_back({keyed[i].second, keyed[first].second});
    }
    std::sort(copies.begin(), copies.end());
    for (const auto& [f, original] : copies) {
      found(made_.duplicate_faces, {f, original}, corners(f));
      sound[f] = false;
    }
    for (std::uint32_t f = 0; f < mesh_.size(); ++f)
      if (sound[f]) made_.sound_faces.push_back(f);
  }

  void check_edges(const Adjacency& adjacency) {
    for (const Adjacency::Edge& edge : adjacency.edges()) {
      std::size_t forward = 0;
      std::vector<std::uint32_t> faces;
      for (const std::uint32_t h : adjacency.half_edges_of(edge)) {
        faces.push_back(Adjacency::face_of(h));
        forward += mesh_.faces[Adjacency::face_of(h)][h % 3] == edge.vertices[0];
      }
      const std::size_t backward = edge.count - forward;
      const std::vector<std::uint32_t> ends{edge.vertices[0], edge.vertices[1]};
      if (edge.count == 1) found(made_.boundary_edges, faces, ends);
      if (edge.count > 2) found(made_.non_manifold_edges, faces, ends);
      if (std::max(forward, backward) - std::min(forward, backward) > 1)
        found(made_.misoriented_edges, std::move(faces), ends);
    }
  }

  /// Corners of one vertex in faces that share an edge there belong to one fan.
  void check_fans(const Adjacency& adjacency) {
    DisjointSets corners(3 * mesh_.size());
    const auto corner = [&](std::uint32_t face, std::uint32_t vertex) {
      const auto& f = mesh_.faces[face];
      return 3 * face + (f[0] == vertex ? 0u : f[1] == vertex ? 1u : 2u);
    };
    for (const Adjacency::Edge& edge : adjacency.edges()) {
      const auto half_edges = adjacency.half_edges_of(edge);
      for (std::size_t i = 1; i < half_edges.size(); ++i)
        for (const std::uint32_t v : edge.vertices)
          corners.join(corner(Adjacency::face_of(half_edges[0]), v),
                       corner(Adjacency::face_of(half_edges[i]), v));
    }
    std::vector<std::uint32_t> fans(mesh_.vertices.size());
    for (std::uint32_t f = 0; f < mesh_.size(); ++f)
      for (std::uint32_t i = 0; i < 3 && !repeats(mesh_.faces[f]); ++i)
        fans[mesh_.faces[f][i]] += corners.find(3 * f + i) == 3 * f + i;
    for (std::uint32_t v = 0; v < fans.size(); ++v)
      if (fans[v] > 1) found(made_.non_manifold_vertices, {}, {v});
  }

  void check_components(const Adjacency& adjacency) {
    DisjointSets parts(mesh_.size());
    for (const Adjacency::Edge& edge : adjacency.edges()) {
      const auto half_edges = adjacency.half_edges_of(edge);
      for (const std::uint32_t h : half_edges.subspan(1))
        parts.join(Adjacency::face_of(half_edges[0]), Adjacency::face_of(h));
    }
    Box<float, 3> box;
    for (const auto& p : mesh_.vertices)
      if (is_finite(p)) box.grow(p);
    const Vec3d centre = box.empty() ? Vec3d{} : Vec3d(box.centre());
    std::vector<double>& volumes = volumes_;
    volumes.assign(mesh_.size(), 0);
    part_.resize(mesh_.size());
    for (std::uint32_t f = 0; f < mesh_.size(); ++f) part_[f] = parts.find(f);
    for (std::uint32_t f = 0; f < mesh_.size(); ++f) {
      if (repeats(mesh_.faces[f])) continue;
      const std::uint32_t part = parts.find(f);
      made_.components += part == f;
      const Triangle3d t(mesh_.triangle(f));
      const double v = dot(t.a - centre, cross(t.b - centre, t.c - centre));
      volumes[part] += v, made_.volume += v;
    }
    made_.volume /= 6;  // once, so that sums of exact terms stay exact
    for (const double v : volumes) made_.inward_components += v < 0;
  }

  void check_nesting() {
    std::vector<std::uint32_t> number(mesh_.size());  // of a part, by its lowest face; from 1
    std::vector<PartNesting::Part> parts;
    for (std::uint32_t f = 0; f < mesh_.size(); ++f) {
      if (repeats(mesh_.faces[f])) continue;
      if (number[part_[f]] == 0) {
        parts.push_back({{}, volumes_[part_[f]]});
        number[part_[f]] = static_cast<std::uint32_t>(parts.size());
      }
      PartNesting::Part& part = parts[number[part_[f]] - 1];
      if (is_finite(mesh_.triangle(f)))
        part.faces.push_back(f);
      else
        part.whole = false;
    }
    std::erase_if(parts, [](const PartNesting::Part& part) { return part.faces.empty(); });
    PartNesting nesting(mesh_, parts);
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (nesting.looks_the_wrong_way(i)) found(made_.misnested_components, {parts[i].faces[0]}, {});
  }

  void weld() {
    std::vector<Adjacency::Face> faces = mesh_.faces;
    for (auto& face : faces)
      for (std::uint32_t& v : face) v = first_at_[v];
    const Adjacency adjacency(faces, mesh_.vertices.size());
    for (const Adjacency::Edge& edge : adjacency.edges())
      if (edge.count > 2 && edge.count % 2 == 0) check_turn(adjacency, faces, edge);
    made_.welded = {made_.vertices - made_.duplicate_vertices.count,
                    adjacency.boundary_edges(),
                    adjacency.non_manifold_edges(),
                    adjacency.misoriented_edges(),
                    adjacency.odd_edges(),
                    adjacency.closed(),
                    adjacency.oriented()};
  }

  /// Sorts an edge's faces around it, from one of them on, by exact orientations.
  void check_turn(const Adjacency& adjacency, std::span<const Adjacency::Face> faces,
                  const Adjacency::Edge& edge) {
    struct Around {
      Vec3f corner;  // off the edge
      std::uint32_t face;
      bool forward;
      bool half = false;  // opposite the first one, or beyond
    };
    const Vec3f from = mesh_.vertices[edge.vertices[0]], to = mesh_.vertices[edge.vertices[1]];
    std::vector<Around> all;
    std::size_t forward = 0;
    for (const std::uint32_t h : adjacency.half_edges_of(edge)) {
      const std::uint32_t f = Adjacency::face_of(h);
      const Triangle3f t = mesh_.triangle(f);
      if (!is_finite(t) || is_degenerate(t)) return;
      all.push_back({mesh_.vertices[faces[f][(h + 2) % 3]], f, faces[f][h % 3] == edge.vertices[0]});
      forward += all.back().forward;
    }
    if (2 * forward != all.size()) return;  // not oriented
    const auto turn = [&](const Around& a, const Around& b) {
      return orientation(from, to, a.corner, b.corner);
    };
    for (Around& a : std::span(all).subspan(1)) {
      const int side = turn(all[0], a);
      if (side == 0 && same_side(all[0].face, a.face)) return;
      a.half = side <= 0;
    }
    std::sort(all.begin() + 1, all.end(),
              [&](const Around& a, const Around& b) { return a.half != b.half ? b.half : turn(a, b) > 0; });
    for (std::size_t i = 2; i < all.size(); ++i)
      if (all[i - 1].half == all[i].half && turn(all[i - 1], all[i]) == 0) return;
    bool in_turn = true;
    std::vector<std::uint32_t> around;
    for (std::size_t i = 0; i < all.size(); ++i) {
      in_turn = in_turn && all[i].forward != all[(i + 1) % all.size()].forward;
      around.push_back(all[i].face);
    }
    if (!in_turn) found(made_.crossed_edges, std::move(around), {edge.vertices[0], edge.vertices[1]});
  }
  /// Of two faces in one plane that share an edge.
  bool same_side(std::uint32_t f, std::uint32_t g) const {
    const Triangle3f s = mesh_.triangle(f), t = mesh_.triangle(g);
    return SharedCorners(s, t).count == 3 || cross_each_other(s, t);
  }

  std::vector<std::uint32_t> corners(std::uint32_t f) const {
    return {mesh_.faces[f].begin(), mesh_.faces[f].end()};
  }

  const Mesh3f& mesh_;
  std::size_t examples_;
  MeshCheck made_;
  std::vector<double> volumes_;          // of each part, six times, at its lowest face
  std::vector<std::uint32_t> part_;      // of each face, the lowest of its part
  std::vector<std::uint32_t> first_at_;  // of each vertex, the first at its position
};

}  // namespace detail

/// Keeps so many examples of each finding. Throws what Adjacency throws.
inline MeshCheck check_mesh(const Mesh3f& mesh, std::size_t examples = 5) {
  return detail::MeshChecker(mesh, examples)();
}

}  // namespace treeline::geometry
