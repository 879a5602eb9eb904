// What scenes are put together from. Internal to the recipes of scenes.
#pragma once

#include <functional>
#include <vector>

#include "datasets_gen/recipe.hpp"
#include "datasets_gen/scenes/scene.hpp"

namespace treeline::datasets {

/// What the recipe of a scene gets.
struct SceneJob {
  const Job& job;
  std::vector<double> knobs;  ///< one for each that the recipe has
};

/// A mesh in the making. Faces turn counterclockwise as seen from outside, or from where a sheet's normal
/// points.
class Parts {
 public:
  using Height = std::function<double(double x, double z)>;

  geometry::Mesh3f mesh;

  /// A parallelogram from a corner and two sides, with normal u × v, in about `faces` triangles (two at
  /// least).
  void sheet(const Vec3d& corner, const Vec3d& u, const Vec3d& v, std::size_t faces);
  /// A square floor at y = 0, `side` long, about the origin, its normal up; raised by the height.
  void floor(double side, std::size_t faces, const Height& height = {});
  /// A closed box, each side split into cells × cells × 2 triangles; corners are shared.
  void box(const Vec3d& low, const Vec3d& high, std::size_t cells = 1);
  /// A closed sphere of about `faces` even triangles.
  void sphere(const Job& job, const Vec3d& centre, double radius, std::size_t faces);
  void add(const geometry::Mesh3f& other);

 private:
  void grid(std::size_t columns, std::size_t rows, const std::function<Vec3d(double, double)>& at);
};

/// Cells of a box's side for about so many faces of the box; one at least.
std::size_t box_cells(std::size_t faces);

inline shading::Light sun(const Vec3d& direction, double angle = 0) {
  return {.kind = shading::LightKind::directional, .direction = unit_portable(direction), .angle = angle};
}
/// Of the sun as seen from the earth: half the angle of its disc, in radians.
inline constexpr double sun_angle = 0.00465;

// One function per scene; the table is in scenes.cpp.
shading::Scene tilted_plane(const SceneJob&);
shading::Scene wall_on_floor(const SceneJob&);
shading::Scene slab_and_sheet(const SceneJob&);
shading::Scene half_plane_edge(const SceneJob&);
shading::Scene sphere_over_floor(const SceneJob&);
shading::Scene two_stacked(const SceneJob&);
shading::Scene three_layers(const SceneJob&);
shading::Scene slit(const SceneJob&);
shading::Scene picket_fence(const SceneJob&);
shading::Scene leaves(const SceneJob&);
shading::Scene city(const SceneJob&);
shading::Scene open_casters(const SceneJob&);
shading::Scene non_manifold(const SceneJob&);
shading::Scene eye_inside_volume(const SceneJob&);

}  // namespace treeline::datasets
