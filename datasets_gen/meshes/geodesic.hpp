// Spheres of even triangles: each face of an icosahedron split into f² triangles and pushed to a surface.
// 20·f² faces and 10·f² + 2 vertices, closed, every vertex stored once. Source: Fuller's class I geodesic
// polyhedra. Weakness: triangles near the icosahedron's corners are about 0.6 times as large as those at its
// face centres.
#pragma once

#include <array>

#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

class Geodesic {
 public:
  explicit Geodesic(std::size_t f) : f_(f) {}

  static std::size_t faces(std::size_t f) { return 20 * f * f; }
  static std::size_t vertices(std::size_t f) { return 10 * f * f + 2; }
  /// The f whose number of faces is nearest to n.
  static std::size_t frequency(double n);

  /// Writes the sphere into mesh from first_vertex and first_face on; mesh must have the room.
  /// shape(direction) gives the point of the surface in that direction; it must be the same on every thread.
  template <class Shape>
  void write(const Job& job, geometry::Mesh3f& mesh, std::size_t first_vertex, std::size_t first_face,
             bool inward, double share, const Shape& shape) const {
    const auto put = [&](std::size_t vertex, const Vec3d& p) {
      mesh.vertices[first_vertex + vertex] = rounded(shape(unit_portable(p)));
    };
    for (std::size_t k = 0; k < 12; ++k) put(k, corner(k));
    for (std::size_t e = 0; e < 30; ++e)
      for (std::size_t t = 1; t < f_; ++t) {
        const auto [a, b] = edge_corners(e);
        put(12 + e * (f_ - 1) + t - 1, sum(scaled(corner(a), double(f_ - t)), scaled(corner(b), double(t))));
      }
    // One row of one icosahedron face at a time: its inner vertices, and the triangles above it.
    job.each(
        20 * f_,
        [&](std::size_t task) {
          const std::size_t face = task / f_, j = task % f_;
          const auto [a, b, c] = face_corners(face);
          for (std::size_t i = 1; j > 0 && i + j < f_; ++i)
            put(vertex(face, i, j), sum(scaled(corner(a), double(f_ - i - j)),
                                        sum(scaled(corner(b), double(i)), scaled(corner(c), double(j)))));
          std::size_t out = first_face + face * f_ * f_ + j * (2 * f_ - j);
          const auto add = [&](std::size_t p, std::size_t q, std::size_t r) {
            if (inward) std::swap(q, r);
            mesh.faces[out++] = {std::uint32_t(first_vertex + p), std::uint32_t(first_vertex + q),
                                 std::uint32_t(first_vertex + r)};
          };
          for (std::size_t i = 0; i + j < f_; ++i) {
            add(vertex(face, i, j), vertex(face, i + 1, j), vertex(face, i, j + 1));
            if (i + j + 1 < f_)
              add(vertex(face, i + 1, j), vertex(face, i + 1, j + 1), vertex(face, i, j + 1));
          }
        },
        share, 16);
  }

 private:
  static Vec3d corner(std::size_t k);
  static std::array<std::size_t, 3> face_corners(std::size_t face);
  static std::array<std::size_t, 2> edge_corners(std::size_t edge);
  /// Number of the vertex at i steps from corner a to b and j steps from a to c.
  std::size_t vertex(std::size_t face, std::size_t i, std::size_t j) const;
  std::size_t edge_vertex(std::size_t from, std::size_t to, std::size_t steps) const;

  std::size_t f_;
};

}  // namespace treeline::datasets
