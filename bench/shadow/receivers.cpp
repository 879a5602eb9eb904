#include "bench/shadow/receivers.hpp"

#include <cmath>

#include "bench/shadow/lights.hpp"
#include "shading/shadow/light_view.hpp"

namespace treeline::bench::shadow {

using geometry::Vec3d;
using geometry::Vec3f;

namespace {
constexpr double least_slope = 1e-3;  // of the way to a surface: below, its crossing with the plane slides
}

Receivers receivers_of(const shading::Scene& scene, const Tree& tree, int threads) {
  const shading::Camera& c = scene.camera;
  if (c.width < 1 || c.height < 1) throw shading::InvalidScene("the image has no pixels");
  const Vec3d forward = normalized(c.target - c.position), right = normalized(cross(forward, c.up)),
              up = cross(right, forward);
  const double half = std::tan(0.5 * c.height_angle), aspect = double(c.width) / c.height;
  std::vector<geometry::Rayf> rays;
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; ++x) {
      const double sx = (2 * (x + 0.5) / c.width - 1) * half * aspect,
                   sy = (1 - 2 * (y + 0.5) / c.height) * half;
      rays.push_back({Vec3f(c.position), Vec3f(forward + right * sx + up * sy)});
    }
  std::vector<accel::Hit<float>> hits(rays.size());
  tree.closest_hit(std::span<const geometry::Rayf>(rays), hits, threads);
  Receivers r;
  r.width = c.width, r.height = c.height;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!hits[i]) continue;
    const geometry::Triangle3d t(scene.mesh.triangle(hits[i].primitive));
    const Vec3d cut = cross(t.b - t.a, t.c - t.a);
    if (!(length(cut) > 0)) continue;
    Vec3d normal = normalized(cut);
    const Vec3d origin = c.position, way(rays[i].direction);
    if (dot(normal, way) > 0) normal = -normal;
    // On the triangle's plane: what float leaves of the hit is off it.
    const double along = dot(normal, way);
    const Vec3d at =
        along < -least_slope * length(way)
            ? origin + way * (dot(t.a - origin, normal) / along)
            : t.a * double(1 - hits[i].u - hits[i].v) + t.b * double(hits[i].u) + t.c * double(hits[i].v);
    if (!is_finite(at) || !lights(scene.light, at, normal, least_sine)) continue;
    r.list.push_back({at, normal});
    r.pixel.push_back(static_cast<std::uint32_t>(i));
  }
  if (r.list.empty()) throw shading::InvalidScene("the camera sees nothing that the light could reach");
  return r;
}

}  // namespace treeline::bench::shadow
