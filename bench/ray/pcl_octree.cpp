// PCL's octree as a ray structure: voxels of one size, each with the triangles that reach into it.
//
// PCL casts rays at points: getIntersectedVoxelIndices lists the points of all voxels along a ray, the
// nearest voxel first, and leaves it at that; the centre of a voxel is no hit of a triangle. So the octree
// holds a point at the centre of every voxel that a triangle's box and plane reach into, and the triangles so
// found are tested here (Möller and Trumbore), voxel by voxel until the nearest hit so far lies before the
// next voxel.
//
// Claim: approximate, for the leaf test and because PCL moves rays: a component of 0 becomes 1e-10.
// Known weakness: a triangle is listed in every voxel that it touches, a long one in hundreds; PCL walks the
// whole way through the box before it answers. Hence the limit of n, and of voxels.
#include <pcl/octree/octree_search.h>
#include <pcl/pcl_config.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/ray/method.hpp"
#include "geometry/intersect_triangle.hpp"

namespace treeline::bench::ray {
namespace {

using geometry::Rayf;
using geometry::Triangle3d;
using geometry::Vec3d;

constexpr std::size_t most_references = 50'000'000;

class PclOctree final : public Index {
 public:
  PclOctree(const geometry::Mesh3f& mesh, const Knobs& knobs) : cloud_(std::make_shared<Cloud>()) {
    geometry::Box3d box;
    for (std::size_t f = 0; f < mesh.size(); ++f)
      if (const auto t = mesh.triangle(f); geometry::is_finite(t))
        for (const auto& corner : {t.a, t.b, t.c}) box.grow(Vec3d(corner));
    if (box.empty()) box = {{0, 0, 0}, {1, 1, 1}};
    // A surface of n triangles fills about as many voxels of an n^(1/2) grid as it has triangles.
    const double widest = std::max(box.extent()[box.widest_axis()], std::numeric_limits<double>::min());
    size_ = widest / std::max(1.0, std::sqrt(double(mesh.size()) / knobs.at("triangles").get<double>()));
    // PCL cuts a cube of a power of two of voxels and centres the box in it: given that cube, it keeps the
    // corner.
    double side = 2 * size_;
    while (side < widest + 2 * size_) side *= 2;
    low_ = box.low - Vec3d::filled(0.5 * size_);
    for (std::size_t f = 0; f < mesh.size(); ++f) add(mesh, f);
    tree_ = std::make_unique<Tree>(size_);
    const Vec3d high = low_ + Vec3d::filled(side);
    tree_->defineBoundingBox(low_[0], low_[1], low_[2], high[0], high[1], high[2]);
    tree_->setInputCloud(cloud_);
    tree_->addPointsFromInputCloud();
  }

  void closest(std::span<const Rayf> rays, std::span<RayAnswer> out, const Knobs&,
               int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      pcl::Indices found;
      for (std::size_t i = begin; i < end; ++i) out[i] = trace(rays[i], false, found);
    });
  }
  void any(std::span<const Rayf> rays, std::span<std::uint8_t> out, const Knobs&,
           int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      pcl::Indices found;
      for (std::size_t i = begin; i < end; ++i) out[i] = static_cast<bool>(trace(rays[i], true, found));
    });
  }

 private:
  using Cloud = pcl::PointCloud<pcl::PointXYZ>;
  using Tree = pcl::octree::OctreePointCloudSearch<pcl::PointXYZ>;

  /// A point for each voxel that the triangle may reach into.
  void add(const geometry::Mesh3f& mesh, std::size_t f) {
    const auto triangle = mesh.triangle(f);
    if (!geometry::is_finite(triangle)) return;
    const Triangle3d t(triangle);
    const Vec3d n = t.area_normal();
    if (!(geometry::length2(n) > 0)) return;
    const std::size_t number = triangles_.size();
    triangles_.push_back(triangle), faces_.push_back(static_cast<accel::Id>(f));
    const auto box = t.box();
    std::array<long, 3> from, to;
    for (int axis = 0; axis < 3; ++axis) {
      // A hundredth of a voxel to all sides: PCL sorts points and rays into voxels by rounded coordinates.
      from[axis] = std::lround(std::floor((box.low[axis] - low_[axis]) / size_ - 0.01));
      to[axis] = std::lround(std::floor((box.high[axis] - low_[axis]) / size_ + 0.01));
    }
    const double reach = 0.51 * size_ * (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]));
    for (long z = from[2]; z <= to[2]; ++z)
      for (long y = from[1]; y <= to[1]; ++y)
        for (long x = from[0]; x <= to[0]; ++x) {
          const Vec3d centre = low_ + Vec3d{x + 0.5, y + 0.5, z + 0.5} * size_;
          if (std::abs(geometry::dot(n, centre - t.a)) > reach) continue;
          if (of_point_.size() >= most_references)
            throw Unsupported("its triangles reach into too many voxels");
          cloud_->push_back(
              {static_cast<float>(centre[0]), static_cast<float>(centre[1]), static_cast<float>(centre[2])});
          of_point_.push_back(static_cast<std::uint32_t>(number));
        }
  }

  RayAnswer trace(const Rayf& ray, bool any, pcl::Indices& found) const {
    RayAnswer best;
    found.clear();
    if (cloud_->empty()) return best;
    tree_->getIntersectedVoxelIndices({ray.origin[0], ray.origin[1], ray.origin[2]},
                                      {ray.direction[0], ray.direction[1], ray.direction[2]}, found);
    const geometry::MollerTrumbore::Prepared<float> test(ray);
    const Vec3d direction(ray.direction);
    const double length2 = geometry::length2(direction), half = 0.9 * size_ / std::sqrt(length2);
    for (const auto point : found) {
      const auto& centre = (*cloud_)[static_cast<std::size_t>(point)];
      const double middle =
          geometry::dot(Vec3d{centre.x, centre.y, centre.z} - Vec3d(ray.origin), direction) / length2;
      // Voxels come in the order of their entry, each of its points at its centre: half a diagonal before it.
      if (best && middle - half > double(best.t)) break;
      const std::uint32_t number = of_point_[static_cast<std::size_t>(point)];
      const auto hit = test(triangles_[number], ray.t_min, ray.t_max);
      if (!hit || (best && hit->t >= best.t)) continue;
      best.t = hit->t, best.primitive = faces_[number];
      if (any) break;
    }
    return best;
  }

  double size_;
  Vec3d low_;
  std::vector<geometry::Triangle3f> triangles_;
  std::vector<accel::Id> faces_;         // of each triangle
  std::vector<std::uint32_t> of_point_;  // the triangle that each point stands for
  std::shared_ptr<Cloud> cloud_;
  std::unique_ptr<Tree> tree_;
};

const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "pcl_octree",
              .family = "octree",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = PCL_VERSION_PRETTY,
              .build_knobs = {{{"triangles", 4}}, {{"triangles", 1}}, {{"triangles", 16}}},
              .ladder = 60,
              .quick_builds = 1,
              .largest_n = 200'000,
              .scales = false},
     .build = [](const geometry::Mesh3f& mesh, const Knobs& knobs, int) -> std::unique_ptr<Index> {
       return std::make_unique<PclOctree>(mesh, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::ray
