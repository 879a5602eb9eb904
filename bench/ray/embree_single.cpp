// Embree, one ray a call: rtcIntersect1 and rtcOccluded1.
//
// Claim: approximate. Its fast mode documents that rays may slip through edges (RTC_SCENE_FLAG_ROBUST: "avoid
// optimizations that reduce arithmetic accuracy"), and its robust mode still leaks at vertices (embree issues
// 174, 181, 387).
#include "accel/batch.hpp"
#include "bench/ray/embree.hpp"

namespace treeline::bench::ray {
namespace {

using geometry::Rayf;

class EmbreeSingle final : public Index {
 public:
  EmbreeSingle(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads)
      : scene_(mesh, knobs, threads) {}

  void closest(std::span<const Rayf> rays, std::span<RayAnswer> out, const Knobs&,
               int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      const FlushDenormals flush;
      EmbreeCall call(false);
      for (std::size_t i = begin; i < end; ++i) {
        RTCRayHit query;
        to_embree(rays[i], query.ray);
        query.hit.geomID = query.hit.primID = RTC_INVALID_GEOMETRY_ID;
        call(scene_.scene(), query);
        out[i] = {};
        if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID)
          out[i].t = query.ray.tfar, out[i].primitive = query.hit.primID;
      }
    });
  }
  void any(std::span<const Rayf> rays, std::span<std::uint8_t> out, const Knobs&,
           int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      const FlushDenormals flush;
      EmbreeCall call(false);
      for (std::size_t i = begin; i < end; ++i) {
        RTCRay query;
        to_embree(rays[i], query);
        call(scene_.scene(), query);
        out[i] = query.tfar < 0;  // Embree's mark of an occluded ray is -infinity
      }
    });
  }
  bool refit(const geometry::Mesh3f& mesh) override { return scene_.refit(mesh); }

 private:
  EmbreeScene scene_;
};

const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "embree_single",
              .family = "bvh",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = embree_version(),
              .build_knobs = embree_builds(),
              .stress_builds = {0, 2, 1, 4},  // medium, fast and robust; high; low
              .ladder = 40,
              .quick_builds = 4},
     .build = [](const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) -> std::unique_ptr<Index> {
       return std::make_unique<EmbreeSingle>(mesh, knobs, threads);
     },
     .warm_up = warm_up_embree});

}  // namespace
}  // namespace treeline::bench::ray
