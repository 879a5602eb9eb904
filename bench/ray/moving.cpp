#include "bench/ray/moving.hpp"

#include <cmath>

#include "bench/ray/stray_rays.hpp"

namespace treeline::bench::ray {

using geometry::Mesh3f;
using geometry::Vec3d;
using geometry::Vec3f;

namespace {

constexpr double turn_per_frame = 0.1;  // rad, from the bottom to the top

}  // namespace

std::vector<std::size_t> moving_frames(bool quick) {
  return quick ? std::vector<std::size_t>{1, 16} : std::vector<std::size_t>{1, 2, 4, 8, 16, 32};
}

Mesh3f twisted(const Mesh3f& mesh, std::size_t frame) {
  const geometry::Box3d box = robust_box(mesh);
  const Vec3d centre = box.centre();
  const double height = std::max(box.extent()[2], std::numeric_limits<double>::min());
  Mesh3f out = mesh;
  for (Vec3f& vertex : out.vertices) {
    const Vec3d p = Vec3d(vertex) - centre;
    const double angle = turn_per_frame * static_cast<double>(frame) * p[2] / height;
    const double c = std::cos(angle), s = std::sin(angle);
    vertex = Vec3f(centre + Vec3d{c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]});
  }
  return out;
}

void add_moving_sets(std::vector<RaySet>& sets, const std::vector<Mesh3f>& meshes,
                     const std::vector<std::size_t>& frames, std::size_t count, std::uint64_t seed) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::vector<geometry::Rayf> rays = primary_rays(frame(meshes[i], 1.0), count / 2, seed);
    for (const geometry::Rayf& ray : random_rays(robust_box(meshes[i]), count / 2, seed)) rays.push_back(ray);
    const std::string name = "frame" + std::to_string(frames[i]);
    const std::size_t truth = sets.size();
    sets.push_back(
        {.name = name + "_refit", .rays = rays, .truth = truth, .frame = i + 1, .update = Update::refit});
    sets.push_back({.name = name + "_rebuilt",
                    .rays = std::move(rays),
                    .truth = truth,
                    .frame = i + 1,
                    .update = Update::rebuild});
  }
}

}  // namespace treeline::bench::ray
