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

  geometry::Mesh3f mesh;
  std::array<std::size_t, count> f, first_vertex, first_face;
  std::size_t vertices = 0, faces = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double wanted =
        static_cast<double>(job.n) * radius(k) * radius(k) / radii2;  // even triangles throughout
    f[k] = Geodesic::frequency(wanted);
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
