#include "datasets_gen/hard/family.hpp"

#include <map>

#include "datasets_gen/meshes/geodesic.hpp"
#include "datasets_gen/noise.hpp"

namespace treeline::datasets {

std::vector<HardCase> hard_cases() {
  std::vector<HardCase> all;
  for (const auto family :
       {hard::ties_duplicates, hard::lines_planes_outliers, hard::degenerate_triangles, hard::far_from_origin,
        hard::edge_vertex_rays, hard::axis_parallel_rays, hard::nan_infinity, hard::empty_one_kn,
        hard::float_range, hard::radius_borders, hard::grazing_rays, hard::self_intersection, hard::box_rays,
        hard::closest_points})
    for (HardCase& c : family()) all.push_back(std::move(c));
  return all;
}

namespace hard {

std::vector<Vec3f> random_points(std::uint64_t seed, std::size_t n, const Vec3d& low, const Vec3d& high) {
  std::vector<Vec3f> r(n);
  for (std::size_t i = 0; i < n; ++i) r[i] = rounded(Draws(seed, i).in_box(low, high));
  return r;
}

std::vector<Vec3f> every(const std::vector<Vec3f>& points, std::size_t step) {
  std::vector<Vec3f> r;
  for (std::size_t i = 0; i < points.size(); i += step) r.push_back(points[i]);
  return r;
}

geometry::Mesh3f snapped_sphere(std::size_t f, std::uint64_t seed) {
  const Progress none;
  Ticker ticker(none);
  const Job job{Geodesic::faces(f), seed, ticker};
  geometry::Mesh3f mesh;
  mesh.vertices.resize(Geodesic::vertices(f));
  mesh.faces.resize(Geodesic::faces(f));
  Geodesic(f).write(job, mesh, 0, 0, false, 1, [&](const Vec3d& d) {
    const Vec3d p = scaled(d, 1 + 0.2 * fractal_noise(seed, scaled(d, 2), 3));
    const auto to_grid = [](double x) { return std::floor(x / snap + 0.5) * snap; };
    return Vec3d{to_grid(p[0]), to_grid(p[1]), to_grid(p[2])};
  });
  return mesh;
}

geometry::Mesh3f wall(std::uint32_t cells) {
  geometry::Mesh3f m;
  for (std::uint32_t j = 0; j <= cells; ++j)
    for (std::uint32_t i = 0; i <= cells; ++i)
      m.vertices.push_back({0, static_cast<float>(i) / static_cast<float>(cells),
                            static_cast<float>(j) / static_cast<float>(cells)});
  for (std::uint32_t j = 0; j < cells; ++j)
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      m.faces.push_back({a, b, d});
      m.faces.push_back({a, d, c});
    }
  return m;
}

geometry::Mesh3f cube(std::uint32_t cells) {
  geometry::Mesh3f m;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> known;
  const auto vertex = [&](const std::array<std::uint32_t, 3>& k) {
    const auto [at, is_new] = known.try_emplace(k, static_cast<std::uint32_t>(m.vertices.size()));
    if (is_new) {
      Vec3f p;
      for (int i = 0; i < 3; ++i) p[i] = 2 * static_cast<float>(k[i]) / static_cast<float>(cells) - 1;
      m.vertices.push_back(p);
    }
    return at->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::uint32_t side : {0u, cells})
      for (std::uint32_t j = 0; j < cells; ++j)
        for (std::uint32_t i = 0; i < cells; ++i) {
          const auto at = [&](std::uint32_t u, std::uint32_t v) {
            std::array<std::uint32_t, 3> k;
            k[axis] = side, k[(axis + 1) % 3] = u, k[(axis + 2) % 3] = v;
            return vertex(k);
          };
          std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          if (side == 0) std::swap(b, d);
          m.faces.push_back({a, b, c});
          m.faces.push_back({a, c, d});
        }
  return m;
}

void add_triangle(geometry::Mesh3f& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.faces.push_back({first, first + 1, first + 2});
}

std::vector<geometry::Rayf> rays_from_around(std::uint64_t seed, std::size_t n, double radius,
                                             const Vec3d& centre) {
  std::vector<geometry::Rayf> r;
  for (std::size_t i = 0; i < n; ++i) {
    Draws draws(seed, i);
    const Vec3f from = rounded(sum(centre, scaled(draws.direction(), radius)));
    const Vec3d aim = draws.direction();
    const Vec3f to = rounded(sum(centre, scaled(aim, radius / 3 * draws.uniform())));
    r.push_back(ray_to(from, to));
  }
  return r;
}

}  // namespace hard
}  // namespace treeline::datasets
