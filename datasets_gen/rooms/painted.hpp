// What rooms are put together from. Internal to the recipes of rooms.
#pragma once

#include <string>
#include <utility>

#include "datasets_gen/rooms/room.hpp"
#include "datasets_gen/scenes/parts.hpp"

namespace treeline::datasets {

using shading::LitScene;
using shading::Material;
using shading::Rgb;

/// Parts that are painted as they are added.
class Painted : public Parts {
 public:
  /// All faces that have been added since the last call are of this material.
  void paint(Material material);
  /// Turns their sides about.
  void turn_over();
  /// A block upright on the floor, turned about its axis; angle in turns.
  void block(double x, double z, double half_side, double height, double turns, std::size_t faces);
  /// The room so far, all of it painted.
  LitScene take(const shading::Camera&);

 private:
  std::vector<Material> materials_;
  std::vector<std::uint32_t> face_materials_;
};

Material diffuse(std::string name, const Rgb& albedo);
/// A surface that emits, and reflects as much of what falls on it.
Material lamp(std::string name, const Rgb& radiance, const Rgb& albedo = {});
Material mirror(std::string name, float reflectance);
Material glass(std::string name, double index);
/// A rough conductor that reflects as Schlick has it.
Material metal(std::string name, const Rgb& reflectance, double alpha);

/// The walls of a room that is seen from inside, 2 m wide and high: x and z from -1 to 1, y from 0 to 2.
namespace box_room {
void floor(Painted&, std::size_t faces);
void left(Painted&, std::size_t faces);
void right(Painted&, std::size_t faces);
void back(Painted&, std::size_t faces);   ///< at z = -1
void front(Painted&, std::size_t faces);  ///< at z = 1
/// Without the square of this side in its middle, where the lamp goes.
void ceiling(Painted&, double lamp_side, std::size_t faces);
void ceiling_lamp(Painted&, double lamp_side, std::size_t faces);
/// Of one that looks in through the open front.
shading::Camera outside();
}  // namespace box_room

// One function per room; the table is in rooms.cpp.
LitScene furnace_room(const SceneJob&);
LitScene furnace_spheres(const SceneJob&);
LitScene closed_box(const SceneJob&);
LitScene cornell_box(const SceneJob&);
LitScene glass_and_mirror(const SceneJob&);
LitScene mirror_hall(const SceneJob&);
LitScene glass_panes(const SceneJob&);
LitScene near_contact(const SceneJob&);
LitScene plates_and_lamps(const SceneJob&);
LitScene architecture_under_sky(const SceneJob&);

}  // namespace treeline::datasets
