#include "bench/distance_field/truth.hpp"

#include <cmath>

#include "accel/bvh/triangles.hpp"

namespace treeline::bench::distance_field {

using Tree = accel::Bvh<accel::Triangles<double>>;

struct Truth::Trees {
  Tree faces;
  std::unique_ptr<Tree> whole;
};

namespace {

geometry::Mesh3d in_double(const geometry::Mesh3f& mesh) {
  geometry::Mesh3d r;
  for (const auto& p : mesh.vertices) r.vertices.push_back(geometry::Vec3d(p));
  r.faces = mesh.faces;
  return r;
}

}  // namespace

Truth::Truth(const geometry::Mesh3f& mesh, const geometry::Mesh3f* whole)
    : trees_(new Trees{Tree(in_double(mesh)), nullptr}), has_sides_(whole != nullptr) {
  if (whole != nullptr && whole != &mesh) trees_->whole = std::make_unique<Tree>(in_double(*whole));
}
Truth::~Truth() = default;

std::vector<double> Truth::distances(std::span<const geometry::Vec3d> points, int threads) const {
  std::vector<double> r(points.size());
  const Tree& sides = trees_->whole ? *trees_->whole : trees_->faces;
  accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      r[i] = std::sqrt(trees_->faces.closest_point(points[i]).distance2);
      if (has_sides_ && sides.contains(points[i])) r[i] = -r[i];
    }
  });
  return r;
}

std::vector<double> Truth::hits(std::span<const geometry::Rayf> rays, int threads) const {
  std::vector<double> r(rays.size());
  accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const geometry::Rayf& ray = rays[i];
      r[i] = trees_->faces
                 .closest_hit(
                     {geometry::Vec3d(ray.origin), geometry::Vec3d(ray.direction), ray.t_min, ray.t_max})
                 .t;
    }
  });
  return r;
}

}  // namespace treeline::bench::distance_field
