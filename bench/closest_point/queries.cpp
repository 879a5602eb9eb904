#include "bench/closest_point/queries.hpp"

#include <bit>
#include <stdexcept>

#include "bench/core/morton_order.hpp"
#include "geometry/random.hpp"
#include "geometry/sampling.hpp"

namespace treeline::bench::closest_point {
namespace {

using geometry::Mesh3f;
using geometry::Vec3d;
using geometry::Vec3f;

constexpr double near_offset = 1e-3;    // of the diagonal
constexpr double centre_radius = 1e-2;  // of the diagonal

/// A finite triangle, at random; after a few tries the first that there is from a random one on.
class Draw {
 public:
  Draw(const Mesh3f& mesh, std::uint64_t seed, std::uint64_t stream) : mesh_(mesh), random_(seed, stream) {}

  geometry::Triangle3f triangle() {
    const auto n = static_cast<std::uint32_t>(mesh_.size());
    for (std::uint32_t f = random_.below(n), tried = 0; tried < n; ++tried, f = (f + 1) % n)
      if (const auto t = mesh_.triangle(f); geometry::is_finite(t)) return t;
    throw std::invalid_argument("the mesh has no finite triangle");
  }
  Vec3d direction() { return geometry::sample_sphere(random_.uniform(), random_.uniform()); }
  double uniform() { return random_.uniform(); }
  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  std::uint32_t below(std::uint32_t n) { return random_.below(n); }

 private:
  const Mesh3f& mesh_;
  geometry::Pcg32 random_;
};

template <class Make>
Queries made(std::size_t count, Make make) {
  std::vector<Vec3f> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) points.push_back(make(i));
  return Queries(std::move(points));
}

PointSet sorted(const PointSet& set, std::size_t truth) {
  PointSet out;
  out.name = set.name + "_sorted", out.truth = truth;
  const std::vector<std::uint32_t> order = morton_order(set.points.floats);
  out.place.resize(order.size());
  std::vector<Vec3f> points(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i)
    points[i] = set.points.floats[order[i]], out.place[order[i]] = i;
  out.points = Queries(std::move(points));
  return out;
}

}  // namespace

geometry::Box3d box_of(const Mesh3f& mesh) {
  geometry::Box3d box;
  for (std::size_t f = 0; f < mesh.size(); ++f)
    if (const auto t = mesh.triangle(f); geometry::is_finite(t))
      box.grow(Vec3d(t.a)), box.grow(Vec3d(t.b)), box.grow(Vec3d(t.c));
  return box;
}

std::vector<PointSet> make_point_sets(const Mesh3f& mesh, const SetSizes& sizes, std::uint64_t seed) {
  const geometry::Box3d box = box_of(mesh);
  if (!(box.low[0] <= box.high[0])) throw std::invalid_argument("the mesh has no finite triangle");
  const double diagonal = geometry::length(box.extent());
  const Vec3d centre = box.centre();

  std::vector<PointSet> sets;
  Draw near(mesh, seed, 11);
  sets.push_back({.name = "near", .points = made(sizes.near, [&](std::size_t) {
                                    const geometry::Triangle3d t(near.triangle());
                                    const Vec3d w = geometry::sample_triangle(near.uniform(), near.uniform());
                                    return Vec3f(t.a * w[0] + t.b * w[1] + t.c * w[2] +
                                                 near.direction() * (near_offset * diagonal));
                                  })});
  sets.push_back(sorted(sets[0], 0));
  Draw anywhere(mesh, seed, 12);
  sets.push_back({.name = "uniform",
                  .points = made(sizes.other,
                                 [&](std::size_t) {
                                   Vec3d p;
                                   for (int k = 0; k < 3; ++k)
                                     p[k] = anywhere.between(box.low[k], box.high[k]);
                                   return Vec3f(p);
                                 }),
                  .truth = 2});
  sets.push_back(sorted(sets[2], 2));
  Draw far(mesh, seed, 13);
  sets.push_back({.name = "far",
                  .points = made(sizes.other,
                                 [&](std::size_t) {
                                   const double distance = far.between(2, 4) * diagonal;
                                   return Vec3f(centre + far.direction() * distance);
                                 }),
                  .truth = 4});
  Draw middle(mesh, seed, 14);
  sets.push_back({.name = "centre",
                  .points = made(sizes.centre,
                                 [&](std::size_t) {
                                   const double radius = std::cbrt(middle.uniform()) * centre_radius;
                                   return Vec3f(centre + middle.direction() * (radius * diagonal));
                                 }),
                  .truth = 5});
  Draw vertex(mesh, seed, 15);
  sets.push_back({.name = "on_vertex",
                  .points = made(sizes.near,
                                 [&](std::size_t i) {
                                   const geometry::Triangle3f t = vertex.triangle();
                                   const Vec3f* corners[] = {&t.a, &t.b, &t.c};
                                   Vec3f p = *corners[vertex.below(3)];
                                   const auto axis = static_cast<int>(vertex.below(3));
                                   const auto moves = [&](int k) {
                                     return i % 3 == 1 ? k == axis : k != axis;
                                   };
                                   const Vec3d by = vertex.direction() * (near_offset * diagonal);
                                   for (int k = 0; k < 3; ++k)
                                     if (i % 3 != 0 && moves(k)) p[k] = static_cast<float>(p[k] + by[k]);
                                   return p;
                                 }),
                  .truth = 6});
  return sets;
}

std::uint64_t hash_of(const std::vector<Vec3f>& points) {
  std::uint64_t h = points.size();
  for (const Vec3f& p : points)
    for (int k = 0; k < 3; ++k) h = geometry::hash_u64(h, std::bit_cast<std::uint32_t>(p[k]));
  return h;
}

}  // namespace treeline::bench::closest_point
