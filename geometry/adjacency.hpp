// Which faces of an indexed mesh meet at which edges; whether the mesh is closed, oriented and manifold.
//
// Problem: volume queries need a closed, consistently oriented mesh; users' files promise neither.
// Method: half-edge h = 3 f + i runs from corner i of face f to the next corner. Sorting half-edges by their
// unordered pair of vertices brings the faces of an edge together. Faces that name a vertex twice bound
// nothing: they are counted and left out. Cost: O(n log n) for n faces; 48 bytes per face, 72 more while
// building. Known weakness: works on indices alone. Vertices at equal positions under different indices are
// different (weld them first), and a vertex where two fans touch is not reported.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"

namespace treeline::geometry {

class Adjacency {
 public:
  using Face = std::array<std::uint32_t, 3>;
  static constexpr std::uint32_t none = 0xffffffffu;

  struct Edge {
    std::array<std::uint32_t, 2> vertices;  ///< lower index first
    std::uint32_t first, count;  ///< its half-edges: first, … first + count - 1 of sorted_half_edges()
  };

  /// Throws std::out_of_range for a face with an index that is no vertex, std::length_error for 2^32 / 3
  /// faces.
  Adjacency(std::span<const Face> faces, std::size_t vertex_count);
  template <class T>
  explicit Adjacency(const Mesh<T>& mesh) : Adjacency(mesh.faces, mesh.vertices.size()) {}

  static std::uint32_t face_of(std::uint32_t half_edge) { return half_edge / 3; }
  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

  /// Edges by ascending pair of vertices.
  std::span<const Edge> edges() const { return edges_; }
  std::span<const std::uint32_t> half_edges_of(const Edge& e) const {
    return std::span(sorted_half_edges()).subspan(e.first, e.count);
  }
  const std::vector<std::uint32_t>& sorted_half_edges() const { return sorted_; }
  /// The half-edge across the same edge, or none at a boundary. Where more than two faces meet, or two faces
  /// run the same way, half-edges are paired in order, opposite directions first; one may be left over.
  std::uint32_t twin(std::uint32_t half_edge) const { return twin_[half_edge]; }
  /// The face across side i of a face, or none.
  std::uint32_t neighbour(std::uint32_t face, int i) const {
    const std::uint32_t t = twin_[3 * face + static_cast<std::uint32_t>(i)];
    return t == none ? none : face_of(t);
  }

  std::size_t boundary_edges() const { return boundary_edges_; }          ///< with one face
  std::size_t non_manifold_edges() const { return non_manifold_edges_; }  ///< with more than two faces
  std::size_t misoriented_edges() const {
    return misoriented_edges_;
  }  ///< its faces' directions do not pair up
  std::size_t repeated_vertex_faces() const { return repeated_vertex_faces_; }  ///< left out of the tables
  std::size_t odd_edges() const { return odd_edges_; }  ///< with an odd number of faces
  /// Closed walks along half-edges without a twin, turning around each fan of faces, that pass an edge with
  /// one face: none where there is no such edge, though the odd face of three has no twin, either.
  std::size_t boundary_loops() const { return boundary_loops_; }

  /// Every edge has an even number of faces.
  bool closed() const { return odd_edges_ == 0; }
  /// At every edge as many faces run one way as the other, give or take the odd one of a boundary.
  bool oriented() const { return misoriented_edges_ == 0; }
  bool manifold() const { return non_manifold_edges_ == 0; }

 private:
  struct Key {
    std::uint64_t vertices;
    std::uint32_t half_edge;
    bool operator<(const Key& o) const {
      return vertices != o.vertices ? vertices < o.vertices : half_edge < o.half_edge;
    }
  };

  static void check(std::span<const Face> faces, std::size_t vertex_count);
  std::vector<Key> sorted_keys(std::span<const Face> faces);
  void pair_up(std::span<const Face> faces, const Edge& edge);
  void count_boundary_loops(std::span<const Face> faces);

  std::vector<Edge> edges_;
  std::vector<std::uint32_t> sorted_, twin_;
  std::size_t boundary_edges_ = 0, non_manifold_edges_ = 0, misoriented_edges_ = 0, odd_edges_ = 0;
  std::size_t repeated_vertex_faces_ = 0, boundary_loops_ = 0;
};

inline Adjacency::Adjacency(std::span<const Face> faces, std::size_t vertex_count) {
  check(faces, vertex_count);
  const std::vector<Key> keys = sorted_keys(faces);
  sorted_.reserve(keys.size());
  for (const Key& k : keys) sorted_.push_back(k.half_edge);
  twin_.assign(3 * faces.size(), none);
  edges_.reserve(keys.size() / 2 + 1);
  for (std::size_t first = 0, last = 0; first < keys.size(); first = last) {
    while (last < keys.size() && keys[last].vertices == keys[first].vertices) ++last;
    const std::uint64_t v = keys[first].vertices;
    edges_.push_back({{static_cast<std::uint32_t>(v >> 32), static_cast<std::uint32_t>(v)},
                      static_cast<std::uint32_t>(first),
                      static_cast<std::uint32_t>(last - first)});
    pair_up(faces, edges_.back());
  }
  count_boundary_loops(faces);
}

inline void Adjacency::check(std::span<const Face> faces, std::size_t vertex_count) {
  if (faces.size() > none / 3)
    throw std::length_error("adjacency: " + std::to_string(faces.size()) +
                            " faces are more than 32-bit indices hold");
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::uint32_t v : faces[f])
      if (v >= vertex_count)
        throw std::out_of_range("adjacency: face " + std::to_string(f) + " refers to vertex " +
                                std::to_string(v) + ", but there are " + std::to_string(vertex_count) +
                                " vertices");
}

inline std::vector<Adjacency::Key> Adjacency::sorted_keys(std::span<const Face> faces) {
  std::vector<Key> keys;
  keys.reserve(3 * faces.size());
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    const Face& v = faces[f];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
      ++repeated_vertex_faces_;
      continue;
    }
    for (std::uint32_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(v[i], v[(i + 1) % 3]);
      keys.push_back({std::uint64_t{low} << 32 | high, 3 * f + i});
    }
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

inline void Adjacency::pair_up(std::span<const Face> faces, const Edge& edge) {
  const auto join = [&](std::uint32_t g, std::uint32_t h) { twin_[g] = h, twin_[h] = g; };
  const auto forward = [&](std::uint32_t h) { return faces[face_of(h)][h % 3] == edge.vertices[0]; };
  const auto half_edges = half_edges_of(edge);
  if (edge.count % 2 == 1) ++odd_edges_;
  if (edge.count == 1) return void(++boundary_edges_);
  if (edge.count == 2) {
    if (forward(half_edges[0]) == forward(half_edges[1])) ++misoriented_edges_;
    return join(half_edges[0], half_edges[1]);
  }
  ++non_manifold_edges_;
  std::array<std::vector<std::uint32_t>, 2> by_direction;
  for (std::uint32_t h : half_edges) by_direction[forward(h)].push_back(h);
  auto& [fewer, more] = by_direction;
  if (fewer.size() > more.size()) fewer.swap(more);
  if (more.size() - fewer.size() > 1) ++misoriented_edges_;
  for (std::size_t i = 0; i < fewer.size(); ++i) join(fewer[i], more[i]);
  for (std::size_t i = fewer.size(); i + 1 < more.size(); i += 2) join(more[i], more[i + 1]);
}

inline void Adjacency::count_boundary_loops(std::span<const Face> faces) {
  std::vector<bool> seen(twin_.size());
  for (const Edge& edge : edges_) {
    const std::uint32_t start = sorted_[edge.first];
    if (edge.count != 1 || seen[start]) continue;
    ++boundary_loops_;
    // Walk towards a vertex, turn around it through its fan of faces to the next open half-edge, and so on.
    // Fans are turned by vertex, not by direction, so that the walk also holds where orientation flips.
    std::uint32_t h = start, pivot = faces[face_of(start)][next(start) % 3];
    do {
      seen[h] = true;
      const auto other_side_at_pivot = [&](std::uint32_t side) {
        const bool ends_there = faces[face_of(side)][next(side) % 3] == pivot;
        return ends_there ? next(side) : previous(side);
      };
      h = other_side_at_pivot(h);
      while (twin_[h] != none) h = other_side_at_pivot(twin_[h]);
      const std::uint32_t from = faces[face_of(h)][h % 3], to = faces[face_of(h)][next(h) % 3];
      pivot = from == pivot ? to : from;
    } while (h != start);
  }
}

}  // namespace treeline::geometry
