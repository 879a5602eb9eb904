#include "bench/ray/stray_rays.hpp"

#include <algorithm>
#include <numbers>

#include "geometry/random.hpp"
#include "geometry/sampling.hpp"

namespace treeline::bench::ray {
namespace {

using geometry::Mesh3f;
using geometry::Rayf;
using geometry::Triangle3d;
using geometry::Vec3d;
using geometry::Vec3f;

constexpr int draws = 32;  // of a triangle for one ray

struct Aim {
  Triangle3d triangle;
  Vec3d point, area_normal;
};

/// A point of a random triangle.
Aim draw(const Mesh3f& mesh, std::span<const accel::Id> faces, geometry::Pcg32& random) {
  const Triangle3d t(mesh.triangle(faces[random.below(static_cast<std::uint32_t>(faces.size()))]));
  const Vec3d w = geometry::sample_triangle(random.uniform(), random.uniform());
  return {t, t.a * w[0] + t.b * w[1] + t.c * w[2], t.area_normal()};
}

bool usable(const Rayf& ray) {
  return geometry::is_finite(ray.origin) && geometry::is_finite(ray.direction) &&
         geometry::length2(Vec3d(ray.direction)) > 0;
}

}  // namespace

std::vector<accel::Id> solid_faces(const Mesh3f& mesh) {
  std::vector<accel::Id> faces;
  for (std::size_t f = 0; f < mesh.size(); ++f)
    if (const Triangle3d t(mesh.triangle(f));
        geometry::is_finite(t) && geometry::length2(t.area_normal()) > 0)
      faces.push_back(static_cast<accel::Id>(f));
  return faces;
}

std::vector<Rayf> random_rays(const geometry::Box3d& box, std::size_t count, std::uint64_t seed) {
  geometry::Pcg32 random(seed, 5);
  const auto point = [&] {
    Vec3d p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(box.low[axis], box.high[axis]);
    return p;
  };
  std::vector<Rayf> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d from = point(), to = point();
    const Rayf ray{Vec3f(from), Vec3f(geometry::normalized(to - from))};
    if (usable(ray)) rays.push_back(ray);
  }
  return rays;
}

std::vector<Rayf> axis_rays(const Mesh3f& mesh, std::span<const accel::Id> faces, const geometry::Box3d& box,
                            std::size_t count, std::uint64_t seed) {
  geometry::Pcg32 random(seed, 6);
  std::vector<Rayf> rays;
  if (faces.empty()) return rays;
  for (std::size_t i = 0; i < count; ++i) {
    const int axis = static_cast<int>(random.below(3));
    const double sign = random.below(2) == 0 ? 1 : -1;
    Aim aim = draw(mesh, faces, random);
    for (int d = 1; d < draws && aim.area_normal[axis] == 0; ++d) aim = draw(mesh, faces, random);
    Vec3d from = aim.point;
    from[axis] = (sign > 0 ? box.low : box.high)[axis] - sign * 0.5 * box.extent()[axis];
    Vec3f direction;
    for (int other = 0; other < 3; ++other) direction[other] = random.below(2) == 0 ? 0.0f : -0.0f;
    direction[axis] = static_cast<float>(sign);
    const Rayf ray{Vec3f(from), direction};
    if (usable(ray)) rays.push_back(ray);
  }
  return rays;
}

std::vector<Rayf> grazing_rays(const Mesh3f& mesh, std::span<const accel::Id> faces, std::size_t count,
                               std::uint64_t seed) {
  geometry::Pcg32 random(seed, 7);
  std::vector<Rayf> rays;
  if (faces.empty()) return rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Aim aim = draw(mesh, faces, random);
    const geometry::Frame<double> frame(geometry::normalized(aim.area_normal));
    const double turn = 2 * std::numbers::pi * random.uniform();
    const double angle = std::pow(10.0, random.uniform(-4.0, -1.0));
    const Vec3d way =
        frame(Vec3d{std::cos(turn) * std::cos(angle), std::sin(turn) * std::cos(angle), -std::sin(angle)});
    const Triangle3d& t = aim.triangle;
    const double size =
        std::max({geometry::length(t.b - t.a), geometry::length(t.c - t.b), geometry::length(t.a - t.c)});
    const Vec3f from(aim.point - way * (8 * size));
    // Towards the point as seen from the origin that float can hold.
    const Rayf ray{from, Vec3f(geometry::normalized(aim.point - Vec3d(from)))};
    if (usable(ray)) rays.push_back(ray);
  }
  return rays;
}

}  // namespace treeline::bench::ray
