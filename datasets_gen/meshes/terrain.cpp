// A height field of hills and ridges over a square: open, everywhere seen from above.
#include "datasets_gen/noise.hpp"
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

geometry::Mesh3f terrain(const Job& job) {
  const std::size_t wide = static_cast<std::size_t>(std::sqrt(static_cast<double>(job.n) / 2) + 0.5);
  const std::size_t deep = (job.n / 2 + wide / 2) / wide, row = wide + 1;
  geometry::Mesh3f mesh;
  mesh.vertices.resize(row * (deep + 1));
  mesh.faces.resize(2 * wide * deep);
  job.each(
      mesh.vertices.size(),
      [&](std::size_t i) {
        const double x = static_cast<double>(i % row) / static_cast<double>(wide);
        const double y = static_cast<double>(i / row) / static_cast<double>(deep);
        const double hills = fractal_noise(job.seed, {3 * x, 3 * y, 0.5}, 6);
        const double ridge = 1 - std::abs(fractal_noise(job.seed + 50, {5 * x, 5 * y, 0.5}, 6));
        mesh.vertices[i] = rounded({x, y, 0.25 * hills + 0.15 * ridge * ridge});
      },
      0.9);
  job.each(
      wide * deep,
      [&](std::size_t quad) {
        const auto a = static_cast<std::uint32_t>(quad / wide * row + quad % wide);
        const std::uint32_t b = a + 1, c = a + static_cast<std::uint32_t>(row), d = c + 1;
        mesh.faces[2 * quad] = {a, b, d};
        mesh.faces[2 * quad + 1] = {a, d, c};
      },
      0.1);
  return mesh;
}

}  // namespace treeline::datasets
