#include "bench/distance_field/truth.hpp"

#include <cmath>
#include <optional>

#include "accel/bvh/triangles.hpp"
#include "geometry/exact/column_grid.hpp"

namespace treeline::bench::distance_field {

struct Truth::Parts {
  accel::Bvh<accel::Triangles<double>> faces;
  geometry::Mesh3f whole;
  std::optional<geometry::ColumnGrid> columns;  // over the whole mesh, if there is one
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
    : parts_(new Parts{accel::Bvh<accel::Triangles<double>>(in_double(mesh)), {}, {}}) {
  if (whole == nullptr) return;
  parts_->whole = *whole;
  parts_->columns.emplace(parts_->whole);
}
Truth::~Truth() = default;

bool Truth::has_sides() const { return parts_->columns.has_value(); }

std::vector<double> Truth::distances(std::span<const geometry::Vec3d> points, int threads) const {
  std::vector<double> r(points.size());
  accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      r[i] = std::sqrt(parts_->faces.closest_point(points[i]).distance2);
      if (has_sides() && (*parts_->columns)(points[i]).winding > 0) r[i] = -r[i];
    }
  });
  return r;
}

std::vector<double> Truth::hits(std::span<const geometry::Rayf> rays, int threads) const {
  std::vector<double> r(rays.size());
  accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const geometry::Rayf& ray = rays[i];
      r[i] = parts_->faces
                 .closest_hit(
                     {geometry::Vec3d(ray.origin), geometry::Vec3d(ray.direction), ray.t_min, ray.t_max})
                 .t;
    }
  });
  return r;
}

}  // namespace treeline::bench::distance_field
