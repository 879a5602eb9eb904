// A rough sphere of even triangles: the friendly mesh, closed, star-shaped about the origin.
#include "datasets_gen/meshes/geodesic.hpp"
#include "datasets_gen/noise.hpp"

namespace treeline::datasets {

geometry::Mesh3f icosphere(const Job& job) {
  const std::size_t f = Geodesic::frequency(static_cast<double>(job.n));
  geometry::Mesh3f mesh;
  mesh.vertices.resize(Geodesic::vertices(f));
  mesh.faces.resize(Geodesic::faces(f));
  Geodesic(f).write(job, mesh, 0, 0, false, 1, [&](const Vec3d& d) {
    return scaled(d, 1 + 0.2 * fractal_noise(job.seed, scaled(d, 2), 5));
  });
  return mesh;
}

}  // namespace treeline::datasets
