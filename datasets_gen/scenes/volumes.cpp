// Scenes that shadow volumes break on: casters that are open, casters that are no manifold, and an eye in the
// shadow.
#include <algorithm>

#include "datasets_gen/scenes/parts.hpp"

namespace treeline::datasets {
namespace {

using shading::Scene;

}  // namespace

/// A box without its top side, one that lacks a single triangle, and a slanting sheet.
Scene open_casters(const SceneJob& j) {
  Parts parts;
  const std::size_t share = j.job.n / 6;
  parts.floor(8, j.job.n - 3 * share);
  const std::size_t cells = box_cells(share);
  parts.box({0.6, 0.6, -0.6}, {1.8, 1.8, 0.6}, cells);
  parts.mesh.faces.pop_back();  // of the side at the upper end of z
  parts.sheet({-0.6, 1, -1}, {0, 0.3, 2}, {1, 0.4, 0}, share);
  // Sides in the order of axes, the lower before the upper: that at the top of y is before the last two.
  Parts lidless;
  lidless.box({-2.2, 0.5, -0.6}, {-1, 1.5, 0.6}, cells);
  auto& faces = lidless.mesh.faces;
  const auto of_side = std::ptrdiff_t(2 * cells * cells);
  faces.erase(faces.begin() + 3 * of_side, faces.begin() + 4 * of_side);
  parts.add(lidless.mesh);
  Scene r;
  r.mesh = std::move(parts.mesh), r.light = sun({0.35, -1, 0.4});
  r.camera.position = {1, 3.8, 6}, r.camera.target = {0.2, 0.5, 0.3};
  return r;
}

/// Three sheets that share an edge, two boxes that touch in one, and a sheet that is there twice.
Scene non_manifold(const SceneJob& j) {
  Parts parts;
  const std::size_t share = j.job.n / 8;
  parts.floor(8, j.job.n - 4 * share);
  auto& mesh = parts.mesh;

  // The fan: an edge along z, three wings of two triangles.
  const auto put = [&](double x, double y, double z) {
    mesh.vertices.push_back(rounded({x, y, z}));
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  };
  const std::uint32_t a = put(-1.8, 1.2, -0.8), b = put(-1.8, 1.2, 0.8);
  for (const auto& [x, y] : {std::pair{-2.5, 1.5}, std::pair{-1.1, 1.6}, std::pair{-1.7, 0.4}}) {
    const std::uint32_t c = put(x, y, -0.8), d = put(x, y, 0.8);
    mesh.faces.push_back({a, b, d}), mesh.faces.push_back({a, d, c});
  }
  // The boxes, with one edge between them: its vertices are those of the first for both.
  const std::size_t cells = box_cells(share);
  const std::size_t first = mesh.vertices.size(), first_face = mesh.faces.size();
  parts.box({-0.4, 0.5, -0.5}, {0.3, 1.1, 0.5}, cells);
  const std::size_t second = mesh.vertices.size();
  parts.box({0.3, 1.1, -0.5}, {1, 1.7, 0.5}, cells);
  const auto on_edge = [&](std::size_t v) {
    return mesh.vertices[v][0] == 0.3f && mesh.vertices[v][1] == 1.1f;
  };
  std::vector<std::uint32_t> edge;
  for (std::size_t v = first; v < second; ++v)
    if (on_edge(v)) edge.push_back(static_cast<std::uint32_t>(v));
  for (std::size_t f = first_face; f < mesh.faces.size(); ++f)
    for (auto& v : mesh.faces[f])
      if (v >= second && on_edge(v))
        v = *std::ranges::find_if(edge, [&](auto w) { return mesh.vertices[w] == mesh.vertices[v]; });
  // The sheet, both times with the same vertices.
  const std::size_t once = mesh.faces.size();
  parts.sheet({1.5, 0.8, -0.6}, {0, 0, 1.2}, {0.9, 0.3, 0}, share);
  const std::size_t twice = mesh.faces.size();
  for (std::size_t f = once; f < twice; ++f) mesh.faces.push_back(geometry::Mesh3f::Face(mesh.faces[f]));
  Scene r;
  r.mesh = std::move(mesh), r.light = sun({0.3, -1, 0.5});
  r.camera.position = {1, 3.8, 6}, r.camera.target = {0.1, 0.5, 0.4};
  return r;
}

/// The eye in the shadow of a large box, looking at where it ends. slide: so many metres sideways; at 1.5 the
/// border of the shadow runs through the eye.
Scene eye_inside_volume(const SceneJob& j) {
  const double slide = j.knobs[0];
  Parts parts;
  parts.floor(12, j.job.n - j.job.n / 2);
  parts.box({-1.5, 2, -1.5}, {1.5, 3, 1.5}, box_cells(j.job.n / 2));
  Scene r;
  r.mesh = std::move(parts.mesh), r.light = sun({0, -1, 0});
  r.camera.position = {slide, 1, 1}, r.camera.target = {slide, 0, -2}, r.camera.height_angle = 0.9;
  return r;
}

}  // namespace treeline::datasets
