// Eight rough spheres, one inside the other, facing outward and inward in turn: hollow balls within hollow
// balls. Stresses traversal through many layers of one surface, and inside tests: a point is inside where the
// number of shells around it is odd. Shells never touch: radii differ by a tenth, roughness stays below a
// fiftieth.
#include "datasets_gen/meshes/geodesic.hpp"
#include "datasets_gen/noise.hpp"

namespace treeline::datasets {

geometry::Mesh3f nested_shells(const Job& job) {
  constexpr std::size_t count = 8;
  double radii2 = 0;
  const auto radius = [](std::size_t k) { return 1 - 0.1 * static_cast<double>(k); };
  for (std::size_t k = 0; k < count; ++k) radii2 += radius(k) * radius(k);

  // Even triangles throughout: faces in proportion to radius squared. Frequencies are whole numbers, so the
  // sum misses n by some per cent; a slightly larger or smaller sum is asked for, whichever comes nearest.
  std::array<std::size_t, count> f{}, first_vertex, first_face;
  double least_miss = std::numeric_limits<double>::infinity();
  for (int step = -50; step <= 50; ++step) {
    const double aim = static_cast<double>(job.n) * (1 + 0.002 * step) / radii2;
    std::array<std::size_t, count> trial;
    double sum_of_faces = 0;
    for (std::size_t k = 0; k < count; ++k) {
      trial[k] = Geodesic::frequency(aim * radius(k) * radius(k));
      sum_of_faces += static_cast<double>(Geodesic::faces(trial[k]));
    }
    const double miss = std::abs(sum_of_faces - static_cast<double>(job.n));
    if (miss < least_miss) least_miss = miss, f = trial;
  }
  geometry::Mesh3f mesh;
  std::size_t vertices = 0, faces = 0;
  for (std::size_t k = 0; k < count; ++k) {
    first_vertex[k] = vertices, first_face[k] = faces;
    vertices += Geodesic::vertices(f[k]), faces += Geodesic::faces(f[k]);
  }
  mesh.vertices.resize(vertices);
  mesh.faces.resize(faces);
  for (std::size_t k = 0; k < count; ++k)
    Geodesic(f[k]).write(job, mesh, first_vertex[k], first_face[k], k % 2 == 1,
                         radius(k) * radius(k) / radii2, [&](const Vec3d& d) {
                           const double rough = fractal_noise(job.seed + 100 * k, scaled(d, 3), 4);
                           return scaled(d, radius(k) + 0.02 * rough);
                         });
  return mesh;
}

}  // namespace treeline::datasets
