#include "bench/ray/queries.hpp"

#include <bit>
#include <cstdint>

#include "accel/bvh.hpp"
#include "geometry/random.hpp"
#include "geometry/sampling.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::ray {
namespace {

using geometry::Mesh3f;
using geometry::Rayf;
using geometry::Triangle3d;
using geometry::Vec3d;
using geometry::Vec3f;

geometry::Box3d finite_box(const Mesh3f& mesh) {
  geometry::Box3d box;
  for (const auto& face : mesh.faces)
    for (const auto v : face)
      if (geometry::is_finite(mesh.vertices[v])) box.grow(Vec3d(mesh.vertices[v]));
  return box.empty() ? geometry::Box3d{{-1, -1, -1}, {1, 1, 1}} : box;
}

/// Cells of a 2^k square along a Morton curve: neighbours in the order are neighbours in the picture.
std::pair<std::uint32_t, std::uint32_t> morton(std::uint64_t index) {
  const auto even_bits = [](std::uint64_t x) {
    std::uint32_t r = 0;
    for (int bit = 0; bit < 32; ++bit) r |= static_cast<std::uint32_t>((x >> (2 * bit)) & 1) << bit;
    return r;
  };
  return {even_bits(index), even_bits(index >> 1)};
}

std::vector<Rayf> camera_rays(const Camera& camera, std::size_t count, std::uint64_t seed) {
  const auto side = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count)));
  const std::uint64_t square = std::bit_ceil(side);
  std::vector<Rayf> rays;
  for (std::uint64_t i = 0; i < square * square; ++i) {
    const auto [x, y] = morton(i);
    if (x >= side || y >= side) continue;
    const double jitter_x = geometry::uniform_at(seed, 2 * i),
                 jitter_y = geometry::uniform_at(seed, 2 * i + 1);
    rays.push_back(camera.ray((x + jitter_x) / side, (y + jitter_y) / side));
  }
  return rays;
}

/// A point of the surface and the unit normal on the side it is seen from.
struct Seen {
  Vec3d point, normal;
};

/// What the camera sees, one point a ray; where a ray misses, along a ray aimed at a random triangle.
std::vector<Seen> seen_by(const Mesh3f& mesh, const Camera& camera, std::span<const Rayf> rays,
                          std::uint64_t seed, int threads) {
  using Tree = accel::Bvh<accel::Triangles<float>>;
  Tree::Options options;
  options.non_finite = accel::NonFinite::drop;
  const Tree tree(mesh, options);
  std::vector<accel::Hit<float>> hits(rays.size());
  tree.closest_hit(rays, hits, threads);

  geometry::Pcg32 random(seed, 1);
  std::vector<Seen> seen;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    accel::Hit<float> hit = hits[i];
    Vec3d direction(rays[i].direction);
    for (int attempt = 0; attempt < 8 && !hit; ++attempt) {
      const Triangle3d target(mesh.triangle(random.below(static_cast<std::uint32_t>(mesh.size()))));
      if (!geometry::is_finite(target)) continue;
      const Vec3d w = geometry::sample_triangle(random.uniform(), random.uniform());
      direction = target.a * w[0] + target.b * w[1] + target.c * w[2] - camera.origin;
      if (geometry::length2(direction) > 0)
        hit = tree.closest_hit(Rayf{Vec3f(camera.origin), Vec3f(direction)});
    }
    if (!hit) continue;
    const Triangle3d t(mesh.triangle(hit.primitive));
    const double u = hit.u, v = hit.v;
    Vec3d n = t.area_normal();
    if (geometry::length2(n) == 0) continue;
    n = geometry::normalized(n);
    if (geometry::dot(n, direction) > 0) n = -n;
    seen.push_back({t.a * (1 - u - v) + t.b * u + t.c * v, n});
  }
  return seen;
}

std::vector<Rayf> diffuse_rays(std::span<const Seen> seen, double offset, std::uint64_t seed) {
  std::vector<Rayf> rays;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Vec3d local = geometry::sample_hemisphere_cosine(geometry::uniform_at(seed + 1, 2 * i),
                                                           geometry::uniform_at(seed + 1, 2 * i + 1));
    const Vec3d direction = geometry::Frame<double>(seen[i].normal)(local);
    rays.push_back({Vec3f(seen[i].point + seen[i].normal * offset), Vec3f(direction)});
  }
  geometry::Pcg32 random(seed, 2);
  for (std::size_t i = rays.size(); i > 1; --i)
    std::swap(rays[i - 1], rays[random.below(static_cast<std::uint32_t>(i))]);
  return rays;
}

std::vector<Rayf> shadow_rays(std::span<const Seen> seen, const geometry::Box3d& box, double offset,
                              std::uint64_t seed) {
  const double radius = 0.5 * geometry::length(box.extent());
  // High enough to light every side that faces up, big enough for soft shadows.
  const Vec3d light = box.centre() + Vec3d{0.5, 0.25, 2.0} * radius;
  std::vector<Rayf> rays;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto disc = geometry::sample_disc(geometry::uniform_at(seed + 2, 2 * i),
                                            geometry::uniform_at(seed + 2, 2 * i + 1));
    const Vec3d on_light = light + Vec3d{disc[0], disc[1], 0} * (0.3 * radius);
    const Vec3d from = seen[i].point + seen[i].normal * offset, way = on_light - from;
    const double distance = geometry::length(way);
    rays.push_back({Vec3f(from), Vec3f(way / distance), 0.0f, static_cast<float>(distance * 0.999)});
  }
  return rays;
}

}  // namespace

Rayf Camera::ray(double x, double y) const {
  const Vec3d d = forward + right * ((2 * x - 1) * half_width) + up * ((1 - 2 * y) * half_height);
  return {Vec3f(origin), Vec3f(geometry::normalized(d))};
}

Camera frame(const Mesh3f& mesh, double aspect) {
  const geometry::Box3d box = finite_box(mesh);
  const double radius = std::max(0.5 * geometry::length(box.extent()), 1e-30);
  Camera camera;
  camera.forward = geometry::normalized(Vec3d{-0.55, 0.9, -0.6});
  camera.right = geometry::normalized(geometry::cross(camera.forward, Vec3d{0, 0, 1}));
  camera.up = geometry::cross(camera.right, camera.forward);
  camera.half_height = 0.36;  // a field of view of 40 degrees
  camera.half_width = camera.half_height * aspect;
  camera.origin = box.centre() - camera.forward * (2.3 * radius);
  return camera;
}

std::vector<RaySet> make_ray_sets(const Mesh3f& mesh, std::size_t count, std::uint64_t seed, int threads) {
  const Camera camera = frame(mesh, 1.0);
  const geometry::Box3d box = finite_box(mesh);
  const std::vector<Rayf> primary = camera_rays(camera, count, seed);
  const std::vector<Seen> seen = seen_by(mesh, camera, primary, seed, threads);
  if (seen.empty())
    throw std::invalid_argument("no ray meets the mesh: it has no triangle with an area and finite corners");
  // Far above the rounding of the origin, far below what can be seen.
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    largest = std::max({largest, std::abs(box.low[axis]), std::abs(box.high[axis])});
  const double offset = std::max(1e-4 * geometry::length(box.extent()),
                                 128 * geometry::tolerance::unit_roundoff<float> * largest);
  return {{"camera", false, primary, 0},
          {"camera_any", true, primary, 0},
          {"diffuse", false, diffuse_rays(seen, offset, seed), 2},
          {"shadow", true, shadow_rays(seen, box, offset, seed), 3}};
}

std::uint64_t hash_of(const std::vector<Rayf>& rays) {
  std::uint64_t h = rays.size();
  for (const Rayf& r : rays)
    for (const float x : {r.origin[0], r.origin[1], r.origin[2], r.direction[0], r.direction[1],
                          r.direction[2], r.t_min, r.t_max})
      h = geometry::hash_u64(h, std::bit_cast<std::uint32_t>(x));
  return h;
}

}  // namespace treeline::bench::ray
