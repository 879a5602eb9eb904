// Closed meshes, points to ask about and the exact oracle, for the tests of inside and outside.
#pragma once

#include "geometry/exact/column.hpp"
#include "tests/accel/triangles_common.hpp"

namespace treeline::accel::test {

using Mesh3f = Mesh<float>;
using Point3f = Vec<float, 3>;

/// A sphere whose radius varies, on a grid of 2^-12 so that coordinates coincide often.
inline Mesh3f bumpy(int levels, std::uint64_t seed, Point3f centre = {}, float scale = 1) {
  Mesh3f mesh = sphere<float>(levels);
  Pcg32 random(seed);
  for (Point3f& p : mesh.vertices) {
    p = p * random.uniform<float>(0.8f, 1.2f);
    for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] * 4096) / 4096 * scale + centre[k];
  }
  return mesh;
}
inline void turn_around(Mesh3f& mesh) {
  for (auto& face : mesh.faces) std::swap(face[1], face[2]);
}
inline void append(Mesh3f& mesh, const Mesh3f& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (auto face : other.faces) {
    for (std::uint32_t& v : face) v += first;
    mesh.faces.push_back(face);
  }
}
/// A ball, a hollow in it and a ball in that.
inline Mesh3f shells() {
  Mesh3f mesh = bumpy(3, 3), hollow = bumpy(3, 4, {}, 0.5f);
  turn_around(hollow);
  append(mesh, hollow), append(mesh, bumpy(2, 5, {}, 0.25f));
  return mesh;
}

struct Truth {
  bool on = false;
  int winding = 0;
  bool inside() const { return on || winding != 0; }
};
inline Truth truth_of(const Mesh3f& mesh, const Point3f& p) {
  Truth r;
  for (std::size_t f = 0; f < mesh.size(); ++f) {
    r.winding += geometry::column_crossing(p, mesh.triangle(f));
    r.on = r.on || geometry::is_on_triangle(p, mesh.triangle(f));
  }
  return r;
}

/// Near the surface, in the box, straight beside and above vertices, on vertices and edges.
inline std::vector<Point3f> points_about(const Mesh3f& mesh, std::size_t n, std::uint64_t seed) {
  Pcg32 random(seed);
  const auto box = mesh.box();
  std::vector<Point3f> points;
  for (std::size_t i = 0; i < n; ++i) {
    const auto t = mesh.triangle(random.below(static_cast<std::uint32_t>(mesh.size())));
    Point3f in_box;
    for (int k = 0; k < 3; ++k) in_box[k] = random.uniform<float>(box.low[k], box.high[k]);
    switch (i % 5) {
      case 0: {
        const float u = random.uniform<float>(0, 0.5f), v = random.uniform<float>(0, 0.5f);
        const float off = random.uniform<float>(-1e-3f, 1e-3f);
        points.push_back(t.a * (1 - u - v) + t.b * u + t.c * v + normalized(t.area_normal()) * off);
        break;
      }
      case 1:
        points.push_back(in_box);
        break;
      case 2: {
        const int k = static_cast<int>(random.below(3));
        Point3f p = t.a;
        p[k] = in_box[k];
        points.push_back(p);
        break;
      }
      case 3:
        points.push_back(t.b);
        break;
      default:
        points.push_back(t.a * 0.5f + t.c * 0.5f);
    }
  }
  return points;
}

}  // namespace treeline::accel::test
