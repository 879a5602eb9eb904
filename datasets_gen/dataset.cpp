#include "datasets_gen/dataset.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace treeline::datasets {

static_assert(sizeof(geometry::Vec3d) == 24 && sizeof(geometry::Vec3f) == 12 &&
                  sizeof(geometry::Mesh3f::Face) == 12,
              "hashed as plain bytes");

namespace {

/// All of a material but its name.
std::vector<double> numbers_of(const shading::Material& m) {
  std::vector<double> r{double(m.kind), double(m.distribution), double(m.masking),      m.alpha_x,
                        m.alpha_y,      double(m.fresnel),      double(m.compensation), m.index};
  for (const shading::Rgb& rgb : {m.reflectance, m.emission, m.conductor_index, m.conductor_extinction})
    for (int c = 0; c < 3; ++c) r.push_back(double(rgb[c]));
  return r;
}

}  // namespace

void Dataset::keep_precise(geometry::Cloud3d points) {
  precise = std::move(points);
  cloud.points.clear();
  for (const geometry::Vec3d& p : precise.points) {
    cloud.points.push_back(geometry::Vec3f(p));
    for (int a = 0; a < 3; ++a)
      if (const double moved = std::abs(p[a] - double(cloud.points.back()[a])); std::isfinite(moved))
        rounding = std::max(rounding, moved);
  }
}

std::size_t Dataset::size() const {
  switch (kind) {
    case Kind::cloud:
      return cloud.size();
    case Kind::mesh:
      return mesh.size();
    case Kind::vectors:
      return vectors.size();
    case Kind::scene:
      return scene.mesh.size();
    case Kind::image:
      return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    case Kind::room:
      return room.mesh.size();
    case Kind::surface:
      return 1;
  }
  return 0;
}

std::uint64_t Dataset::hash() const {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  XXH3_64bits_reset(state.get());
  // Lengths go in first, so that a vertex cannot be taken for a face.
  const auto add = [&](const auto& array) {
    const std::uint64_t length = array.size();
    XXH3_64bits_update(state.get(), &length, sizeof length);
    if (length > 0) XXH3_64bits_update(state.get(), array.data(), length * sizeof array[0]);
  };
  if (kind == Kind::cloud) {
    add(cloud.points);
    if (precise.size() > 0) add(precise.points);
  } else if (kind == Kind::vectors) {
    add(std::vector<std::uint64_t>{vectors.columns});
    add(vectors.scalars);
  } else if (kind == Kind::image) {
    add(std::vector<std::int32_t>{image.width, image.height, image.channels});
    add(image.values);
  } else if (kind == Kind::scene) {
    add(scene.mesh.vertices), add(scene.mesh.faces);
    const shading::Camera& c = scene.camera;
    const shading::Light& l = scene.light;
    add(std::vector{c.position, c.target, c.up, l.position, l.direction, l.u, l.v});
    add(std::vector{c.height_angle, double(c.width), double(c.height), double(l.kind), l.angle});
  } else if (kind == Kind::room) {
    add(room.mesh.vertices), add(room.mesh.faces), add(room.face_materials);
    for (const shading::Material& m : room.materials) add(numbers_of(m));
    const shading::Camera& c = room.camera;
    add(std::vector{c.position, c.target, c.up});
    add(std::vector{c.height_angle, double(c.width), double(c.height)});
    add(std::vector{room.background});
  } else if (kind == Kind::surface) {
    add(numbers_of(material));
  } else {
    add(mesh.vertices);
    add(mesh.faces);
  }
  return XXH3_64bits_digest(state.get());
}

}  // namespace treeline::datasets
