// A mesh whose faces emit from their fronts.
//
// Method: a face in proportion to its area, then a direction evenly over the solid angle of that face; so a
// receiver that touches the mesh gets no sample of huge weight. Source: Arvo 1995 for the face. Cost: as
// emitters.hpp and spherical_triangle.hpp; pdf of a direction walks all faces, pdf of a face that a ray was
// found to hit does not. Known weakness: faces that look away are drawn as often as others, and are samples
// lost: half of them for a closed mesh.
#pragma once

#include "shading/light/emitters.hpp"
#include "shading/light/light.hpp"
#include "shading/light/spherical_triangle.hpp"

namespace treeline::shading::light {

class MeshLight {
 public:
  /// radiance: W / (m² sr). Throws InvalidLight for a radiance that is negative or not finite, a face that
  /// names a vertex which is missing or not finite, and a mesh without area.
  MeshLight(const geometry::Mesh3f& mesh, const Rgb& radiance)
      : emitters_(lit(mesh)), mesh_(mesh), radiance_(radiance) {
    detail::check_colour(radiance_, "mesh light", "radiance");
    if (emitters_.empty()) throw InvalidLight("mesh light: its mesh has no area");
  }

  /// Nothing where the face that was drawn looks away.
  LightSample sample(const Vec3d& p, double u, double v) const {
    const EmitterChoice choice = emitters_.choose(u);
    const Triangle3d t(mesh_.triangle(choice.face));
    const Vec3d normal = t.area_normal();
    const double height = dot(p - t.a, normal);
    if (!(height > 0)) return {};
    const SphericalTriangle seen(t, p);
    if (!(seen.solid_angle() > 0)) return {};
    const Vec3d direction = seen.sample(choice.rest, v);
    return {direction, -height / dot(direction, normal), radiance_, choice.probability * seen.pdf(), false};
  }
  /// Of a direction in which that face is hit first; per steradian. 0 from behind the face.
  double pdf(const Vec3d& p, std::uint32_t face) const {
    const Triangle3d t(mesh_.triangle(face));
    const double angle = triangle_solid_angle(t, p);
    if (!(angle > 0) || !(dot(p - t.a, t.area_normal()) > 0)) return 0;
    return emitters_.pdf_area(face) * t.area() / angle;
  }
  /// Of the face that is hit first. O(n).
  double pdf(const Vec3d& p, const Vec3d& direction) const {
    double nearest = std::numeric_limits<double>::infinity(), found = 0;
    for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
      const Triangle3d t(mesh_.triangle(i));
      if (!triangle_covers(t, p, direction)) continue;
      const double distance = dot(t.a - p, t.area_normal()) / dot(direction, t.area_normal());
      if (distance < nearest) nearest = distance, found = pdf(p, i);
    }
    return found;
  }
  Vec3d power() const {
    const Vec3d white = emitters_.power();
    return {white[0] * radiance_[0], white[1] * radiance_[1], white[2] * radiance_[2]};
  }

 private:
  static Emitters lit(const geometry::Mesh3f& mesh) {
    LitScene scene;
    scene.mesh = mesh;
    scene.face_materials.assign(mesh.size(), 0);
    scene.materials.emplace_back().emission = Rgb::filled(1);
    return Emitters(scene);
  }

  Emitters emitters_;  // of radiance 1
  geometry::Mesh3f mesh_;
  Vec3d radiance_;
};
static_assert(AnyLight<MeshLight>);

}  // namespace treeline::shading::light
