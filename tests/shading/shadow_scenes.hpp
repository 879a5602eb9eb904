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

}  // namespace treeline::shading::test
