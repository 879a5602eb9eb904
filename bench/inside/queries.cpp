#include "bench/inside/queries.hpp"

#include <bit>
#include <stdexcept>

#include "bench/core/morton_order.hpp"
#include "geometry/random.hpp"
#include "geometry/sampling.hpp"

namespace treeline::bench::inside {
namespace {

using geometry::Vec3d;
using geometry::Vec3f;

constexpr double near_offset = 1e-3;    // of the diagonal
constexpr double centre_radius = 1e-2;  // of the diagonal

}  // namespace

std::vector<PointSet> make_point_sets(const geometry::Mesh3f& mesh, const SetSizes& sizes, bool few,
                                      std::uint64_t seed) {
  std::vector<std::uint32_t> finite;
  geometry::Box3d box;
  for (std::uint32_t f = 0; f < mesh.size(); ++f)
    if (const auto t = mesh.triangle(f); geometry::is_finite(t)) {
      finite.push_back(f);
      for (const Vec3f& p : {t.a, t.b, t.c}) box.grow(Vec3d(p));
    }
  if (finite.empty()) throw std::invalid_argument("the mesh has no finite triangle");
  const double diagonal = length(box.extent());
  const Vec3d centre = box.centre();

  std::vector<PointSet> sets;
  const auto add = [&](const char* name, std::size_t count, const auto& make) {
    geometry::Pcg32 random(seed, 21 + sets.size());
    PointSet& set = sets.emplace_back(PointSet{name, {}});
    for (std::size_t i = 0; i < count; ++i) set.points.push_back(make(random));
  };
  const auto direction = [](geometry::Pcg32& random) {
    const double u = random.uniform(), v = random.uniform();
    return geometry::sample_sphere(u, v);
  };
  const auto face = [&](geometry::Pcg32& random) {
    return mesh.triangle(finite[random.below(static_cast<std::uint32_t>(finite.size()))]);
  };
  const auto anywhere = [&](geometry::Pcg32& random) {
    Vec3d p;
    for (int k = 0; k < 3; ++k) p[k] = random.uniform(box.low[k], box.high[k]);
    return Vec3f(p);
  };
  add("near", sizes.near, [&](geometry::Pcg32& random) {
    const geometry::Triangle3d t(face(random));
    const double u = random.uniform(), v = random.uniform();
    const Vec3d w = geometry::sample_triangle(u, v);
    return Vec3f(t.a * w[0] + t.b * w[1] + t.c * w[2] + direction(random) * (near_offset * diagonal));
  });
  add("uniform", sizes.other, anywhere);
  if (few) return sets;
  for (const std::size_t at : {0u, 2u}) {
    PointSet sorted{sets[at].name + "_sorted", {}};
    for (const std::uint32_t i : morton_order(sets[at].points)) sorted.points.push_back(sets[at].points[i]);
    sets.insert(sets.begin() + static_cast<std::ptrdiff_t>(at) + 1, std::move(sorted));
  }
  add("far", sizes.other, [&](geometry::Pcg32& random) {
    const double distance = random.uniform(2.0, 4.0) * diagonal;
    return Vec3f(centre + direction(random) * distance);
  });
  add("centre", sizes.other, [&](geometry::Pcg32& random) {
    const double distance = std::cbrt(random.uniform()) * centre_radius * diagonal;
    return Vec3f(centre + direction(random) * distance);
  });
  add("on_vertex", sizes.near, [&](geometry::Pcg32& random) {
    Vec3f p = face(random).a;
    const int axis = static_cast<int>(random.below(3));
    p[axis] = anywhere(random)[axis];
    return p;
  });
  return sets;
}

std::uint64_t hash_of(const std::vector<Vec3f>& points) {
  std::uint64_t h = points.size();
  for (const Vec3f& p : points)
    for (int k = 0; k < 3; ++k) h = geometry::hash_u64(h, std::bit_cast<std::uint32_t>(p[k]));
  return h;
}

}  // namespace treeline::bench::inside
