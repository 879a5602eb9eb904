// Meshes and truths that the tests of distance fields share.
#pragma once

#include <gtest/gtest.h>

#include <numbers>

#include "accel/bvh/triangles.hpp"
#include "accel/distance_field.hpp"
#include "tests/accel/triangles_common.hpp"

namespace treeline::accel::field::test {

using geometry::Box3d;
using geometry::Mesh3f;
using geometry::Pcg32;
using geometry::Rayd;
using geometry::Triangle3d;
using Tree = Bvh<Triangles<float>>;

inline Vec3d in_box(Pcg32& random, const Box3d& box) {
  Vec3d p;
  for (int k = 0; k < 3; ++k) p[k] = random.uniform(box.low[k], box.high[k]);
  return p;
}

/// How often the mesh goes around a point: the sum of the solid angles of its faces (Van Oosterom and
/// Strackee 1983). A second witness for signs: no ray, no nearest face.
inline double winding(const Mesh3f& mesh, const Vec3d& p) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const Triangle3d t(mesh.triangle(i));
    const Vec3d a = t.a - p, b = t.b - p, c = t.c - p;
    const double x = length(a), y = length(b), z = length(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
  }
  return sum / (4 * std::numbers::pi);
}

/// Signed distance by looking at every face, and by the winding number.
inline double true_distance(const Mesh3f& mesh, const Vec3d& p) {
  double d2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.size(); ++i)
    d2 = std::min(d2, closest_point_on_triangle(p, Triangle3d(mesh.triangle(i))).distance2);
  return winding(mesh, p) > 0.5 ? -std::sqrt(d2) : std::sqrt(d2);
}

/// A box turned so that no face is parallel to the lattice.
inline Mesh3f turned_box(const Vec3d& half) {
  Mesh3f mesh;
  accel::test::add_box(mesh, geometry::Box3f{-Vec3f(half), Vec3f(half)});
  const Vec3d u = normalized(Vec3d{2, 1, 0.3}), w = normalized(cross(u, Vec3d{0, 0.2, 1})), v = cross(w, u);
  for (Vec3f& p : mesh.vertices) {
    const Vec3d q(p);
    p = Vec3f(u * q[0] + v * q[1] + w * q[2]);
  }
  return mesh;
}

/// A ball, hollow but for a smaller ball: three shells that face outward and inward in turn.
inline Mesh3f nested(int levels) {
  Mesh3f mesh;
  int shell = 0;
  for (const float radius : {1.0f, 0.7f, 0.4f}) {
    const Mesh3f ball = accel::test::sphere<float>(levels, {}, radius);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), ball.vertices.begin(), ball.vertices.end());
    for (auto face : ball.faces) {
      for (auto& v : face) v += first;
      if (shell % 2 == 1) std::swap(face[1], face[2]);
      mesh.faces.push_back(face);
    }
    ++shell;
  }
  return mesh;
}

inline FieldOptions options(int resolution, double band = 3, int threads = 1) {
  FieldOptions o;
  o.resolution = resolution, o.band = band, o.threads = threads;
  return o;
}

}  // namespace treeline::accel::field::test
