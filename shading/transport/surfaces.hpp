// A scene's faces as light meets them: normals, materials and emitters, checked once and kept ready.
//
// Opaque surfaces are the same from both sides, so that faces of users' meshes may turn either way; what is
// emitted leaves the front alone, and the front of glass is its outside. Normals are those of the faces.
// Known weakness: rays start off the surface by surfaces' offset() (tolerance::shadow_offset), and what is
// nearer to a surface than that is not seen from it: 0.08 mm in a scene of 10 m.
#pragma once

#include <charconv>
#include <string>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/ray.hpp"
#include "geometry/tolerances.hpp"
#include "shading/brdf/bsdf.hpp"
#include "shading/light/emitters.hpp"
#include "shading/scene.hpp"
#include "shading/transport/options.hpp"

namespace treeline::shading::transport {

/// Channel by channel.
inline Rgb times(const Rgb& a, const Rgb& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }
inline float largest(const Rgb& a) { return std::max({a[0], a[1], a[2]}); }

class Surfaces {
 public:
  struct Material {
    brdf::Bsdf<float> bsdf;
    SurfaceKind kind;
    bool emits;
    Rgb albedo;  ///< of a diffuse one; of a mirror, what it reflects
    Rgb emission;
    float index;  ///< of glass
  };
  /// Where a ray meets a surface.
  struct Vertex {
    geometry::Vec3f point;
    geometry::Frame<float>
        frame;            ///< z: the normal; of an opaque surface on the side that the ray comes from
    geometry::Vec3f out;  ///< back along the ray, in the frame
    const Material* material;
    float cosine;  ///< between out and the front's normal; negative behind
  };
  /// The same without where it is.
  struct Side {
    geometry::Vec3f normal;  ///< as the frame's z
    const Material* material;
    float cosine;
  };
  /// A point of the emitters, as seen from a surface.
  struct LightPoint {
    geometry::Vec3f in;  ///< towards it, in the surface's frame
    float pdf = 0;       ///< per steradian; 0: there is none, or it cannot be seen from that side
    Rgb emission;
    geometry::Rayf ray;  ///< hits whatever hides it
  };

  /// Keeps what it needs of the scene. Throws InvalidScene, light::InvalidLight or brdf::InvalidMaterial.
  explicit Surfaces(const LitScene& scene);

  const light::Emitters& emitters() const { return emitters_; }
  const Rgb& background() const { return background_; }
  /// Where rays start above a surface, along its normal.
  float offset() const { return offset_; }
  /// Of a ray of unit direction and the face that it hits.
  Side side(const geometry::Vec3f& direction, std::uint32_t face) const {
    const Face& f = faces_[face];
    const Material& m = materials_[f.material];
    const float cosine = -dot(f.normal, direction);
    return {cosine < 0 && m.kind != SurfaceKind::glass ? -f.normal : f.normal, &m, cosine};
  }
  /// And at t.
  Vertex meet(const geometry::Vec3f& origin, const geometry::Vec3f& direction, float t,
              std::uint32_t face) const {
    const Side is = side(direction, face);
    const geometry::Frame<float> frame(is.normal);
    return {origin + direction * t,
            frame,
            {-dot(frame.x, direction), -dot(frame.y, direction), -dot(frame.z, direction)},
            is.material,
            is.cosine};
  }
  /// Numbers as Emitters::sample takes them; not to be called where the scene has no emitters.
  LightPoint light(const Vertex& at, double choice, float u, float v) const {
    const light::EmitterSample s = emitters_.sample(choice, u, v);
    const geometry::Vec3f way = s.point - at.point;
    const float distance2 = length2(way), up = dot(way, at.frame.z), facing = -dot(way, s.normal);
    if (!(up > 0 && facing > 0 && distance2 > offset_ * offset_)) return {};
    const float inverse = 1 / std::sqrt(distance2);
    const geometry::Vec3f from = at.point + at.frame.z * offset_, to = s.point + s.normal * offset_;
    return {{dot(way, at.frame.x) * inverse, dot(way, at.frame.y) * inverse, up * inverse},
            s.pdf_area * distance2 / (facing * inverse),
            s.emission,
            {from, to - from, 0.0f, 1.0f}};
  }
  /// From a surface into a direction of its frame.
  geometry::Rayf leaving(const Vertex& at, const geometry::Vec3f& in) const {
    return {at.point + at.frame.z * std::copysign(offset_, in[2]), at.frame(in)};
  }
  /// Density, per steradian, with which light() draws what a ray meets on a face at distance t.
  float pdf_of_light(std::uint32_t face, float t, float cosine) const {
    return emitters_.pdf_area(face) * t * t / cosine;
  }

 private:
  struct Face {
    geometry::Vec3f normal;  // unit, of the front; zero for a face without area, which no ray hits
    std::uint32_t material;
  };

  light::Emitters emitters_;
  std::vector<Face> faces_;
  std::vector<Material> materials_;
  Rgb background_;
  float offset_ = 0;
};

inline Surfaces::Surfaces(const LitScene& scene) : emitters_(scene), background_(scene.background) {
  for (int k = 0; k < 3; ++k)
    if (!(background_[k] >= 0 && std::isfinite(background_[k])))
      throw InvalidScene("the background is " + std::to_string(background_[k]) +
                         "; radiance must be finite and not negative");
  for (const shading::Material& m : scene.materials) {
    const Rgb dark{};
    materials_.push_back({brdf::Bsdf<float>(m), m.kind, m.emission != dark, m.reflectance, m.emission,
                          static_cast<float>(m.index)});
  }
  geometry::Box3d box;
  box.grow(scene.camera.position);
  faces_.resize(scene.mesh.size());
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    for (const std::uint32_t corner : scene.mesh.faces[i]) {
      if (corner >= scene.mesh.vertices.size() || !is_finite(scene.mesh.vertices[corner]))
        throw InvalidScene("face " + std::to_string(i) + " has a vertex, " + std::to_string(corner) +
                           ", that is missing or not finite");
      box.grow(geometry::Vec3d(scene.mesh.vertices[corner]));
    }
    const geometry::Vec3d n = geometry::Triangle3d(scene.mesh.triangle(i)).area_normal();
    const double twice = length(n);
    faces_[i] = {twice > 0 ? geometry::Vec3f(n / twice) : geometry::Vec3f{}, scene.face_materials[i]};
  }
  double reach = 0;
  for (int k = 0; k < 3; ++k)
    reach =
        std::max({reach, box.high[k] - box.low[k], std::abs(box.low[k]) / 16, std::abs(box.high[k]) / 16});
  // Squared distances of floats, and of a point to what it was moved off, stay within range.
  if (!scene.mesh.faces.empty() && !(reach > 1e-15 && reach < 1e15)) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, reach, std::chars_format::general, 4).ptr;
    throw InvalidScene("the scene reaches " + std::string(digits, end) + " m; taken are 1e-15 to 1e15 m");
  }
  offset_ = static_cast<float>(double(geometry::tolerance::shadow_offset<float>) * reach);
}

}  // namespace treeline::shading::transport
