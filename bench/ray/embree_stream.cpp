// Embree 3, a whole run of rays a call: rtcIntersect1M and rtcOccluded1M. Embree 4 has no such calls.
//
// Embree sorts the rays of a stream by octant and traces them in packets where the flag says that they are
// coherent, one by one where not. Its records are larger than ours, so rays are handed over a cacheful at a
// time.
#include "accel/batch.hpp"
#include "bench/ray/embree.hpp"

namespace treeline::bench::ray {
namespace {

constexpr std::size_t stream_rays = 256;  // a call; the manual speaks of thousands, measured no better

class EmbreeStream final : public Index {
 public:
  EmbreeStream(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) : scene_(mesh, knobs, threads) {
    if (!rtcGetDeviceProperty(scene_.device(), RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED))
      throw Unsupported("this Embree was built without ray streams");
  }

  void closest(std::span<const geometry::Rayf> rays, std::span<RayAnswer> out, const Knobs& knobs,
               int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      const FlushDenormals flush;
      EmbreeCall call(knobs.value("coherent", false));
      std::vector<RTCRayHit> queries(stream_rays);
      for (std::size_t first = begin; first < end; first += stream_rays) {
        const std::size_t count = std::min(stream_rays, end - first);
        for (std::size_t i = 0; i < count; ++i) {
          to_embree(rays[first + i], queries[i].ray);
          queries[i].hit.geomID = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect1M(scene_.scene(), &call.context, queries.data(), static_cast<unsigned>(count),
                       sizeof(RTCRayHit));
        for (std::size_t i = 0; i < count; ++i) {
          RayAnswer& answer = out[first + i] = {};
          if (queries[i].hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
          answer.t = queries[i].ray.tfar, answer.primitive = queries[i].hit.primID;
        }
      }
    });
  }
  void any(std::span<const geometry::Rayf> rays, std::span<std::uint8_t> out, const Knobs& knobs,
           int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      const FlushDenormals flush;
      EmbreeCall call(knobs.value("coherent", false));
      std::vector<RTCRay> queries(stream_rays);
      for (std::size_t first = begin; first < end; first += stream_rays) {
        const std::size_t count = std::min(stream_rays, end - first);
        for (std::size_t i = 0; i < count; ++i) to_embree(rays[first + i], queries[i]);
        rtcOccluded1M(scene_.scene(), &call.context, queries.data(), static_cast<unsigned>(count),
                      sizeof(RTCRay));
        for (std::size_t i = 0; i < count; ++i) out[first + i] = queries[i].tfar < 0;
      }
    });
  }

  bool refit(const geometry::Mesh3f& mesh) override { return scene_.refit(mesh); }

 private:
  EmbreeScene scene_;
};

const bool registered = register_embree_batch<EmbreeStream>("embree_stream", 42, true);

}  // namespace
}  // namespace treeline::bench::ray
