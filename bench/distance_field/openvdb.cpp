// OpenVDB: a narrow-band level set from meshToVolume, asked by its own samplers and its own rays.
//
// The conversion is the one compiled into the library, which takes vertices as floats in units of a cell,
// like its own convenience functions. The sign is flood-filled from outside, and then the band renormalised
// unless that is switched off (both are swept: it smooths, at an error of its own).
#include <oneapi/tbb/task_arena.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/RayIntersector.h>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/distance_field/method.hpp"

namespace treeline::bench::distance_field {
namespace {

using Grid = openvdb::FloatGrid;

class OpenVdb final : public Field {
 public:
  OpenVdb(const Input& input, const Knobs& knobs) {
    static const bool initialized = (openvdb::initialize(), true);
    static_cast<void>(initialized);
    const auto transform = openvdb::math::Transform::createLinearTransform(input.spacing);
    const int flags = knobs.at("renormalize").get<bool>() ? 0 : int(openvdb::tools::DISABLE_RENORMALIZATION);
    const auto band = static_cast<float>(input.band);
    const auto make = [&] {
      std::vector<openvdb::Vec3s> corners;
      for (const auto& p : input.mesh.vertices)
        corners.push_back(openvdb::Vec3s(openvdb::Vec3d(p[0], p[1], p[2]) / input.spacing));
      std::vector<openvdb::Vec3I> faces;
      for (const auto& f : input.mesh.faces) faces.emplace_back(f[0], f[1], f[2]);
      const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(corners, faces);
      openvdb::util::NullInterrupter never;
      grid_ = openvdb::tools::meshToVolume<Grid>(never, mesh, *transform, band, band, flags);
    };
    tbb::task_arena arena(accel::allowed_threads(input.threads));
    arena.execute(make);
    grid_->setGridClass(openvdb::GRID_LEVEL_SET);
    spacing_ = input.spacing, band_ = input.band;
  }

  void distances(std::span<const geometry::Vec3f> points, const Knobs& knobs, int threads,
                 std::span<float> out) const override {
    if (knobs.at("look_up") == "box")
      ask<openvdb::tools::BoxSampler>(points, threads, out);
    else
      ask<openvdb::tools::QuadraticSampler>(points, threads, out);
  }
  void trace(std::span<const geometry::Rayf> rays, const Knobs& knobs, int threads,
             std::span<TraceAnswer> out) const override {
    if (knobs.at("look_up") != "box") throw Unsupported("its rays have a look-up of their own");
    // Throws for a grid without a surface.
    const openvdb::tools::LevelSetRayIntersector<Grid> shared(*grid_);
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      const openvdb::tools::LevelSetRayIntersector<Grid> own(shared);
      for (std::size_t i = begin; i < end; ++i) {
        const auto& r = rays[i];
        const openvdb::math::Ray<double> ray({r.origin[0], r.origin[1], r.origin[2]},
                                             {r.direction[0], r.direction[1], r.direction[2]});
        openvdb::Vec3d at;
        double t = 0;
        out[i] = {};
        if (own.intersectsWS(ray, at, t)) out[i].t = static_cast<float>(t);
      }
    });
  }
  std::vector<Sample> samples(std::size_t most) const override {
    const std::size_t stride = stride_for(grid_->activeVoxelCount(), most);
    std::vector<Sample> r;
    std::size_t seen = 0;
    for (auto voxel = grid_->cbeginValueOn(); voxel; ++voxel) {
      if (seen++ % stride != 0 || std::abs(double(*voxel)) > band_ * spacing_) continue;
      const auto at = grid_->indexToWorld(voxel.getCoord());
      r.push_back({{at[0], at[1], at[2]}, double(*voxel)});
    }
    return r;
  }
  Knobs facts() const override {
    return {{"distance_field_known_samples", static_cast<std::size_t>(grid_->activeVoxelCount())}};
  }

 private:
  template <class Sampler>
  void ask(std::span<const geometry::Vec3f> points, int threads, std::span<float> out) const {
    accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      const auto accessor = grid_->getConstAccessor();
      const openvdb::tools::GridSampler<Grid::ConstAccessor, Sampler> sampler(accessor, grid_->transform());
      for (std::size_t i = begin; i < end; ++i)
        out[i] = sampler.wsSample(openvdb::Vec3d(points[i][0], points[i][1], points[i][2]));
    });
  }

  Grid::Ptr grid_;
  double spacing_ = 0, band_ = 0;
};

std::vector<Knobs> builds() {
  std::vector<Knobs> r;
  for (const Knobs& k : resolutions())
    for (const bool renormalize : {false, true}) {
      r.push_back(k);
      r.back()["renormalize"] = renormalize;
    }
  return r;
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "openvdb",
              .family = "field",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = OPENVDB_LIBRARY_VERSION_STRING,
              .build_knobs = builds(),
              .query_knobs = {{{"look_up", "box"}}, {{"look_up", "quadratic"}}},
              .stress_builds = {2},
              .ladder = 50,
              .quick_builds = 6},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<Field> {
       return std::make_unique<OpenVdb>(input, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::distance_field
