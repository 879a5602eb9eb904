#include "bench/ray/queries.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>

#include "accel/bvh.hpp"
#include "bench/ray/edge_rays.hpp"
#include "bench/ray/stray_rays.hpp"
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

bool has_area(const Triangle3d& t) {
  return geometry::is_finite(t) && geometry::length2(t.area_normal()) > 0;
}

double size_of(const Triangle3d& t) {
  return std::max({geometry::length(t.b - t.a), geometry::length(t.c - t.b), geometry::length(t.a - t.c)});
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

/// Where along the Morton curve a ray is, by where the picture plane sees its direction.
std::uint64_t picture_order(const Camera& camera, const Rayf& ray) {
  const Vec3d d(ray.direction);
  const double depth = std::max(geometry::dot(d, camera.forward), 1e-3);
  const auto cell = [](double x) {
    return static_cast<std::uint64_t>(std::clamp(0.5 + 0.5 * x, 0.0, 1.0) * 65535);
  };
  const std::uint64_t x = cell(geometry::dot(d, camera.right) / depth / camera.half_width),
                      y = cell(-geometry::dot(d, camera.up) / depth / camera.half_height);
  std::uint64_t order = 0;
  for (int bit = 0; bit < 16; ++bit)
    order |= ((x >> bit) & 1) << (2 * bit) | ((y >> bit) & 1) << (2 * bit + 1);
  return order;
}

using Tree = accel::Bvh<accel::Triangles<float>>;

Tree tree_over(const Mesh3f& mesh) {
  Tree::Options options;
  options.non_finite = accel::NonFinite::drop;
  return Tree(mesh, options);
}

/// A ray aimed at a random point of a random triangle: from the eye if it meets the mesh from there, else
/// from a few triangle sizes off. Ids of triangles are drawn, so that dense parts are seen as often as they
/// are dense.
Rayf aimed_ray(const Mesh3f& mesh, const Tree& tree, const Vec3d& eye, geometry::Pcg32& random) {
  Rayf ray{Vec3f(eye), {0, 0, 1}};
  for (int attempt = 0; attempt < 8; ++attempt) {
    const Triangle3d target(mesh.triangle(random.below(static_cast<std::uint32_t>(mesh.size()))));
    const Vec3d w = geometry::sample_triangle(random.uniform(), random.uniform());
    if (!has_area(target)) continue;
    const Vec3d point = target.a * w[0] + target.b * w[1] + target.c * w[2];
    const Vec3d n = geometry::normalized(target.area_normal());
    const double side = geometry::dot(eye - point, n) < 0 ? -1.0 : 1.0;
    for (const Vec3d& from : {eye, point + n * (side * 4 * size_of(target))}) {
      // Towards the point as seen from the origin that float can hold.
      const Vec3d direction = point - Vec3d(Vec3f(from));
      if (!(geometry::length2(direction) > 0)) continue;
      ray = {Vec3f(from), Vec3f(geometry::normalized(direction))};
      if (geometry::is_finite(ray.origin) && tree.closest_hit(ray)) return ray;
    }
  }
  return ray;
}

/// A point of the surface, the unit normal on the side it is seen from, and how far off it rays start: a few
/// ulps of its coordinates, and a small part of its triangle.
struct Seen {
  Vec3d point, normal;
  double offset = 0;
};

/// What the rays meet; in place of one that meets nothing, what an aimed one meets.
std::vector<Seen> seen_by(const Mesh3f& mesh, const Tree& tree, const Camera& camera,
                          std::span<const Rayf> rays, std::uint64_t seed, int threads) {
  std::vector<accel::Hit<float>> hits(rays.size());
  tree.closest_hit(rays, hits, threads);
  geometry::Pcg32 random(seed, 1);
  std::vector<Seen> seen;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    accel::Hit<float> hit = hits[i];
    Vec3d direction(rays[i].direction);
    if (!hit) {
      const Rayf ray = aimed_ray(mesh, tree, camera.origin, random);
      hit = tree.closest_hit(ray), direction = Vec3d(ray.direction);
    }
    if (!hit) continue;
    const Triangle3d t(mesh.triangle(hit.primitive));
    if (!has_area(t)) continue;
    const double u = hit.u, v = hit.v;
    Vec3d n = geometry::normalized(t.area_normal());
    if (geometry::dot(n, direction) > 0) n = -n;
    const Vec3d point = t.a * (1 - u - v) + t.b * u + t.c * v;
    const double largest = std::max({std::abs(point[0]), std::abs(point[1]), std::abs(point[2])});
    seen.push_back({point, n, 8 * geometry::tolerance::unit_roundoff<float> * largest + 1e-4 * size_of(t)});
  }
  return seen;
}

std::vector<Rayf> diffuse_rays(std::span<const Seen> seen, std::uint64_t seed) {
  std::vector<Rayf> rays;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Vec3d local = geometry::sample_hemisphere_cosine(geometry::uniform_at(seed + 1, 2 * i),
                                                           geometry::uniform_at(seed + 1, 2 * i + 1));
    const Vec3d direction = geometry::Frame<double>(seen[i].normal)(local);
    rays.push_back({Vec3f(seen[i].point + seen[i].normal * seen[i].offset), Vec3f(direction)});
  }
  return rays;
}

std::vector<Rayf> shadow_rays(std::span<const Seen> seen, const geometry::Box3d& box, std::uint64_t seed) {
  const double radius = 0.5 * geometry::length(box.extent());
  // High enough to light every side that faces up, big enough for soft shadows.
  const Vec3d light = box.centre() + Vec3d{0.5, 0.25, 2.0} * radius;
  std::vector<Rayf> rays;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto disc = geometry::sample_disc(geometry::uniform_at(seed + 2, 2 * i),
                                            geometry::uniform_at(seed + 2, 2 * i + 1));
    const Vec3d on_light = light + Vec3d{disc[0], disc[1], 0} * (0.3 * radius);
    const Vec3d from = seen[i].point + seen[i].normal * seen[i].offset, way = on_light - from;
    const double distance = geometry::length(way);
    rays.push_back({Vec3f(from), Vec3f(way / distance), 0.0f, static_cast<float>(distance * 0.999)});
  }
  return rays;
}

/// A random order, as the place of each of `size` things.
std::vector<std::uint32_t> shuffle(std::size_t size, geometry::Pcg32& random) {
  std::vector<std::uint32_t> place(size);
  std::iota(place.begin(), place.end(), 0u);
  for (std::size_t i = size; i > 1; --i)
    std::swap(place[i - 1], place[random.below(static_cast<std::uint32_t>(i))]);
  return place;
}

std::vector<Rayf> placed(std::span<const Rayf> rays, std::span<const std::uint32_t> place) {
  std::vector<Rayf> out(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) out[place[i]] = rays[i];
  return out;
}

}  // namespace

geometry::Box3d robust_box(const Mesh3f& mesh) {
  std::array<std::vector<double>, 3> sorted;
  for (const auto& face : mesh.faces)
    for (const auto v : face)
      if (geometry::is_finite(mesh.vertices[v]))
        for (int axis = 0; axis < 3; ++axis)
          sorted[static_cast<std::size_t>(axis)].push_back(double(mesh.vertices[v][axis]));
  const std::size_t n = sorted[0].size();
  if (n == 0) return {{-1, -1, -1}, {1, 1, 1}};
  geometry::Box3d box;
  Vec3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    auto& x = sorted[static_cast<std::size_t>(axis)];
    const auto at = [&](std::size_t rank) {
      std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(rank), x.end());
      return x[rank];
    };
    low[axis] = at(n / 100), high[axis] = at(n - 1 - n / 100);
    const double margin = 0.01 * (high[axis] - low[axis]);
    low[axis] -= margin, high[axis] += margin;
  }
  box.grow(low), box.grow(high);
  return box;
}

Rayf Camera::ray(double x, double y) const {
  const Vec3d d = forward + right * ((2 * x - 1) * half_width) + up * ((1 - 2 * y) * half_height);
  return {Vec3f(origin), Vec3f(geometry::normalized(d))};
}

std::vector<Rayf> primary_rays(const Camera& camera, std::size_t count, std::uint64_t seed) {
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

Camera frame(const Mesh3f& mesh, double aspect) {
  const geometry::Box3d box = robust_box(mesh);
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

void refuse_empty(const std::vector<RaySet>& sets) {
  std::string empty;
  for (const RaySet& set : sets)
    if (set.rays.empty()) empty += (empty.empty() ? "" : ", ") + set.name;
  if (!empty.empty())
    throw std::invalid_argument("no rays for the mesh could be made for " + empty +
                                ", which would measure nothing: its triangles are too few, too small or too "
                                "far from the origin for rays in float");
}

std::vector<RaySet> make_ray_sets(const Mesh3f& mesh, std::size_t count, std::uint64_t seed, int threads) {
  const Camera camera = frame(mesh, 1.0);
  const geometry::Box3d box = robust_box(mesh);
  const Tree tree = tree_over(mesh);
  std::vector<Rayf> primary = primary_rays(camera, count, seed);
  // Every second ray is aimed at a triangle; those are put in the order of their directions, so that
  // neighbours stay neighbours.
  geometry::Pcg32 random(seed, 3);
  std::vector<Rayf> aimed;
  for (std::size_t i = 1; i < primary.size(); i += 2)
    aimed.push_back(aimed_ray(mesh, tree, camera.origin, random));
  std::ranges::stable_sort(aimed, {}, [&](const Rayf& r) { return picture_order(camera, r); });
  for (std::size_t i = 0; i < aimed.size(); ++i) primary[2 * i + 1] = aimed[i];

  const std::vector<Seen> seen = seen_by(mesh, tree, camera, primary, seed, threads);
  if (seen.empty()) {
    for (std::size_t f = 0; f < mesh.size(); ++f)
      if (has_area(Triangle3d(mesh.triangle(f))))
        throw std::invalid_argument(
            "no ray of the set camera hits the mesh, so it would measure nothing: its triangles are too "
            "small "
            "or too far from the origin for rays in float; move or scale the mesh");
    throw std::invalid_argument("no ray meets the mesh: it has no triangle with an area and finite corners");
  }
  const FirstHit first_hit = [&](const Rayf& ray) { return tree.closest_hit(ray); };
  const std::vector<Rayf> diffuse = diffuse_rays(seen, seed);
  std::vector<Seen> seen_next = seen_by(mesh, tree, camera, diffuse, seed + 3, threads);
  if (seen_next.empty()) seen_next = seen;  // what bounces off a single triangle meets nothing
  const std::vector<Rayf> second = diffuse_rays(seen_next, seed + 4);
  const std::vector<accel::Id> solid = solid_faces(mesh);
  geometry::Pcg32 order(seed, 2);
  const auto camera_order = shuffle(primary.size(), order), second_order = shuffle(second.size(), order);
  const std::size_t most = primary.size();
  std::vector<RaySet> sets{
      {.name = "camera", .rays = primary, .truth = 0},
      {.name = "camera_shuffled", .rays = placed(primary, camera_order), .truth = 0, .place = camera_order},
      {.name = "camera_any", .any = true, .rays = primary, .truth = 0},
      {.name = "diffuse", .rays = diffuse, .truth = 3},
      {.name = "bounce2", .rays = placed(second, second_order), .truth = 4},
      {.name = "random", .rays = random_rays(box, most, seed), .truth = 5},
      {.name = "shadow", .any = true, .rays = shadow_rays(seen, box, seed), .truth = 6},
      {.name = "axis", .rays = axis_rays(mesh, solid, box, most, seed), .truth = 7},
      {.name = "grazing", .rays = grazing_rays(mesh, solid, most, seed), .truth = 8},
      {.name = "edge", .rays = edge_rays(mesh, first_hit, camera.origin, most, seed), .truth = 9}};
  refuse_empty(sets);
  return sets;
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
