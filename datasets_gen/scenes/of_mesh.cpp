// A stage for any mesh.
#include <algorithm>
#include <limits>
#include <stdexcept>

#include "datasets_gen/scenes/parts.hpp"

namespace treeline::datasets {
namespace {

using geometry::Box3d;

/// Of the vertices that faces name, as far as they are finite.
Box3d box_of(const geometry::Mesh3f& mesh) {
  Box3d box;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (const auto v : mesh.faces[f])
      if (v >= mesh.vertices.size())
        throw std::invalid_argument("face " + std::to_string(f) + " names vertex " + std::to_string(v) +
                                    " of a mesh of " + std::to_string(mesh.vertices.size()));
    const auto t = mesh.triangle(f);
    if (is_finite(t.a) && is_finite(t.b) && is_finite(t.c))
      for (const auto& p : {t.a, t.b, t.c}) box.grow(Vec3d(p));
  }
  if (box.empty()) throw std::invalid_argument("a mesh without a face of finite corners makes no scene");
  return box;
}

/// What no face names, or no ray can meet, shall not stretch the scene: it is moved to the middle, or made
/// NaN.
void confine(geometry::Mesh3f& mesh, const geometry::Vec3f& middle) {
  std::vector<bool> named(mesh.vertices.size());
  for (const auto& face : mesh.faces)
    for (const auto v : face) named[v] = true;
  for (std::size_t v = 0; v < named.size(); ++v) {
    auto& p = mesh.vertices[v];
    if (!named[v])
      p = middle;
    else if (!is_finite(p))
      p = geometry::Vec3f::filled(std::numeric_limits<float>::quiet_NaN());
  }
}

}  // namespace

shading::Scene scene_of_mesh(geometry::Mesh3f mesh, std::string name, const Staging& staging) {
  const Vec3d up = staging.up;
  if (!(std::abs(dot_portable(up, up) - 1) < 1e-6))
    throw std::invalid_argument("the scene's up is not a unit vector");
  const Box3d box = box_of(mesh);
  const Vec3d centre = box.centre();
  confine(mesh, geometry::Vec3f(centre));
  Vec3d half = scaled(box.extent(), 0.5);
  const double radius = std::max(std::sqrt(dot_portable(half, half)), 1e-30);

  // Its own frame: x and z level.
  const Vec3d other = std::abs(up[1]) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  const Vec3d x = unit_portable(cross_portable(up, other)), z = cross_portable(x, up);
  const auto at = [&](double a, double b, double c) {
    return sum(centre, sum(scaled(x, a), sum(scaled(up, b), scaled(z, c))));
  };
  double lowest = 0, sideways = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d d = half;
    for (int k = 0; k < 3; ++k)
      if (corner >> k & 1) d[k] = -d[k];
    lowest = std::min(lowest, dot_portable(d, up));
    sideways = std::max({sideways, std::abs(dot_portable(d, x)), std::abs(dot_portable(d, z))});
  }
  if (staging.floor) {
    Parts parts;
    parts.mesh = std::move(mesh);
    const double reach = 3 * std::max(sideways, 0.5 * radius);
    parts.sheet(at(-reach, lowest, -reach), scaled(z, 2 * reach), scaled(x, 2 * reach), 128);
    mesh = std::move(parts.mesh);
  }
  shading::Scene scene;
  scene.name = std::move(name), scene.mesh = std::move(mesh);
  // (0.6, 0.8): sine and cosine of 53 degrees from the floor.
  const Vec3d level = sum(scaled(x, 0.8), scaled(z, -0.6));
  scene.light = sun(sum(scaled(level, 0.6), scaled(up, -0.8)), sun_angle);
  scene.camera.target = at(0, 0.2 * lowest, 0), scene.camera.up = up;
  scene.camera.position = at(1.4 * radius, 1.5 * radius, 2.4 * radius);
  return scene;
}

}  // namespace treeline::datasets
