// Small scenes for the tests of shadows.
#pragma once

#include "geometry/random.hpp"
#include "shading/scene.hpp"
#include "shading/shadow/depth_map.hpp"

namespace treeline::shading::test {

using geometry::Mesh3f;
using geometry::Vec2d;
using geometry::Vec3d;
using geometry::Vec3f;

/// Counter-clockwise seen from where cross(b - a, c - a) points; corners of its own.
inline void add_triangle(Mesh3f& mesh, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3d& p : {a, b, c}) mesh.vertices.push_back(Vec3f(p));
  mesh.faces.push_back({first, first + 1, first + 2});
}
/// middle ± u ± v, facing cross(u, v).
inline void add_quad(Mesh3f& mesh, const Vec3d& middle, const Vec3d& u, const Vec3d& v) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3d& p : {middle - u - v, middle + u - v, middle + u + v, middle - u + v})
    mesh.vertices.push_back(Vec3f(p));
  mesh.faces.push_back({first, first + 1, first + 2}), mesh.faces.push_back({first, first + 2, first + 3});
}
/// A regular polygon of that many corners, inscribed in the circle; facing cross(u, v).
inline void add_disc(Mesh3f& mesh, const Vec3d& middle, const Vec3d& u, const Vec3d& v, int corners) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < corners; ++i) {
    const double a = 2 * 3.14159265358979323846 * i / corners;
    mesh.vertices.push_back(Vec3f(middle + u * std::cos(a) + v * std::sin(a)));
  }
  for (int i = 2; i < corners; ++i) {
    const auto n = static_cast<std::uint32_t>(i);
    mesh.faces.push_back({first, first + n - 1, first + n});
  }
}

inline void append(Mesh3f& mesh, const Mesh3f& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (auto face : other.faces) {
    for (auto& v : face) v += first;
    mesh.faces.push_back(face);
  }
}

/// What the camera sees through the middle of each pixel, row after row; where it sees nothing, a receiver
/// without a normal, just before the camera.
template <class Tree>
std::vector<shadow::Receiver> seen_by_camera(const Scene& scene, const Tree& tree) {
  const Camera& c = scene.camera;
  const Vec3d ahead = normalized(c.target - c.position), right = normalized(cross(ahead, c.up)),
              up = cross(right, ahead);
  const double half = std::tan(c.height_angle / 2);
  std::vector<shadow::Receiver> receivers;
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; ++x) {
      const Vec3d way = ahead + right * (half * (2 * x + 1 - c.width) / c.height) +
                        up * (half * (c.height - 2 * y - 1) / c.height);
      const auto hit = tree.closest_hit(geometry::Rayf{Vec3f(c.position), Vec3f(way)});
      if (!hit) {
        receivers.push_back({c.position + way * 1e-3, {}});
        continue;
      }
      const geometry::Triangle3d t(scene.mesh.triangle(hit.primitive));
      const double u = double(hit.u), v = double(hit.v);
      Vec3d normal = normalized(t.area_normal());
      if (dot(normal, way) > 0) normal = -normal;
      receivers.push_back({t.a * (1 - u - v) + t.b * u + t.c * v, normal});
    }
  return receivers;
}

}  // namespace treeline::shading::test
