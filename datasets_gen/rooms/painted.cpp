#include "datasets_gen/rooms/painted.hpp"

namespace treeline::datasets {

void Painted::paint(Material material) {
  face_materials_.resize(mesh.size(), static_cast<std::uint32_t>(materials_.size()));
  materials_.push_back(std::move(material));
}

void Painted::turn_over() {
  for (std::size_t f = face_materials_.size(); f < mesh.size(); ++f)
    std::swap(mesh.faces[f][1], mesh.faces[f][2]);
}

void Painted::block(double x, double z, double half_side, double height, double turns, std::size_t faces) {
  const std::size_t first = mesh.vertices.size();
  box({-half_side, 0, -half_side}, {half_side, height, half_side}, box_cells(faces));
  const SinCos a = sincos_turns(turns);
  for (std::size_t v = first; v < mesh.vertices.size(); ++v) {
    const Vec3d p(mesh.vertices[v]);
    mesh.vertices[v] = rounded({x + a.cos * p[0] + a.sin * p[2], p[1], z - a.sin * p[0] + a.cos * p[2]});
  }
}

LitScene Painted::take(const shading::Camera& camera) {
  LitScene room;
  room.mesh = std::move(mesh), room.camera = camera;
  room.materials = std::move(materials_), room.face_materials = std::move(face_materials_);
  return room;
}

Material diffuse(std::string name, const Rgb& albedo) {
  Material m;
  m.name = std::move(name), m.reflectance = albedo;
  return m;
}

Material lamp(std::string name, const Rgb& radiance, const Rgb& albedo) {
  Material m = diffuse(std::move(name), albedo);
  m.emission = radiance;
  return m;
}

Material mirror(std::string name, float reflectance) {
  Material m = diffuse(std::move(name), Rgb::filled(reflectance));
  m.kind = shading::SurfaceKind::mirror;
  return m;
}

Material glass(std::string name, double index) {
  Material m = diffuse(std::move(name), Rgb::filled(1));
  m.kind = shading::SurfaceKind::glass, m.index = index;
  return m;
}

Material metal(std::string name, const Rgb& reflectance, double alpha) {
  Material m = diffuse(std::move(name), reflectance);
  m.kind = shading::SurfaceKind::microfacet, m.fresnel = shading::FresnelKind::schlick;
  m.alpha_x = m.alpha_y = alpha;
  return m;
}

namespace box_room {

void floor(Painted& to, std::size_t faces) { to.sheet({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, faces); }
void left(Painted& to, std::size_t faces) { to.sheet({-1, 0, -1}, {0, 2, 0}, {0, 0, 2}, faces); }
void right(Painted& to, std::size_t faces) { to.sheet({1, 0, -1}, {0, 0, 2}, {0, 2, 0}, faces); }
void back(Painted& to, std::size_t faces) { to.sheet({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, faces); }
void front(Painted& to, std::size_t faces) { to.sheet({-1, 0, 1}, {0, 2, 0}, {2, 0, 0}, faces); }

void ceiling(Painted& to, double lamp_side, std::size_t faces) {
  const double at[] = {-1, -0.5 * lamp_side, 0.5 * lamp_side, 1};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != 1 || j != 1)
        to.sheet({at[i], 2, at[j]}, {at[i + 1] - at[i], 0, 0}, {0, 0, at[j + 1] - at[j]}, faces / 8);
}

void ceiling_lamp(Painted& to, double lamp_side, std::size_t faces) {
  to.sheet({-0.5 * lamp_side, 2, -0.5 * lamp_side}, {lamp_side, 0, 0}, {0, 0, lamp_side}, faces);
}

shading::Camera outside() {
  return {.position = {0, 1, 4.2}, .target = {0, 1, 0}, .height_angle = 0.62, .width = 480, .height = 480};
}

}  // namespace box_room
}  // namespace treeline::datasets
