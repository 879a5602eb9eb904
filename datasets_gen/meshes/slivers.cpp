// Soups of thin triangles in the cube [-1, 1]^3, of aspect ratios from ten to a hundred thousand: needles,
// with one short side, and caps, whose third corner lies almost on the side across. Kernels in float lose
// their normals. Source of the names: Shewchuk 2002, "What is a good linear finite element?".
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {
namespace {

/// Corners a and b anywhere in the cube; c beside the point at `share` of the way from a to b.
template <class Share>
geometry::Mesh3f slivers(const Job& job, const Share& share) {
  geometry::Mesh3f mesh;
  mesh.vertices.resize(3 * job.n);
  mesh.faces.resize(job.n);
  job.each(job.n, [&](std::size_t i) {
    Draws draws(job.seed, i);
    const Vec3d a = draws.in_box({-1, -1, -1}, {1, 1, 1}), b = draws.in_box({-1, -1, -1}, {1, 1, 1});
    const Vec3d side{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double aspect = draws.uniform(1, 10);
    for (std::uint64_t digits = 1 + draws.below(4); digits > 0; --digits) aspect *= 10;
    // As long as the side, times the sine of the angle between it and a random direction: seldom much less.
    const Vec3d across = cross_portable(side, draws.direction());
    Vec3d c = sum(sum(a, scaled(side, share(draws))), scaled(across, 1 / aspect));
    for (int k = 0; k < 3; ++k) c[k] = c[k] < -1 ? -1 : c[k] > 1 ? 1 : c[k];
    const auto first = static_cast<std::uint32_t>(3 * i);
    mesh.vertices[first] = rounded(a), mesh.vertices[first + 1] = rounded(b),
    mesh.vertices[first + 2] = rounded(c);
    mesh.faces[i] = {first, first + 1, first + 2};
  });
  return mesh;
}

}  // namespace

geometry::Mesh3f needles(const Job& job) {
  return slivers(job, [](Draws&) { return 1.0; });
}
geometry::Mesh3f caps(const Job& job) {
  return slivers(job, [](Draws& draws) { return draws.uniform(0.2, 0.8); });
}

}  // namespace treeline::datasets
