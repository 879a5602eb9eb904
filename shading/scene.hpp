// Scenes: the least that shading needs. Data only; what is done with them is elsewhere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"
#include "geometry/vec.hpp"
#include "shading/material.hpp"

namespace treeline::shading {

/// A pinhole. Pixel (0, 0) is the top left one; a pixel is seen through its centre.
struct Camera {
  geometry::Vec3d position{0, 0, 1}, target{}, up{0, 1, 0};
  double height_angle = 0.7;  ///< between the upper and the lower edge of the image, in radians
  int width = 640, height = 480;
};

enum class LightKind { directional, point, spot, rectangle, disc };

struct Light {
  LightKind kind = LightKind::directional;
  geometry::Vec3d position{};  ///< of its middle; of no account for a directional one
  geometry::Vec3d direction{0, -1,
                            0};  ///< unit, the way the light goes: also axis of a spot, normal of an area
  /// Half sides of a rectangle, half axes of a disc, perpendicular to the direction and to each other.
  geometry::Vec3d u{}, v{};
  /// Radians. Directional: half the angle that its disc subtends, as the sun's 0.00465; 0 for hard shadows.
  /// Spot: between its axis and its border.
  double angle = 0;
};

struct Scene {
  std::string name;
  geometry::Mesh3f mesh;  ///< casts shadows and receives them
  Camera camera;
  Light light;
};

/// A scene that light is carried through. All of its light comes from faces that emit and from the
/// background.
struct LitScene {
  std::string name;
  geometry::Mesh3f mesh;  ///< front sides are those from which corners turn counterclockwise
  Camera camera;
  std::vector<Material> materials;
  std::vector<std::uint32_t> face_materials;  ///< for each face, a place in materials
  Rgb background{};                           ///< radiance where a ray meets nothing
};

}  // namespace treeline::shading
