// The path tracer `mis` with rays cast one by one through Embree: the same paths, another tree.
#include "bench/light_transport/path_subject.hpp"
#include "bench/ray/embree.hpp"

namespace treeline::bench::light_transport {
namespace {

using geometry::Rayf;

/// One ray a call. Embree keeps the first of hits at the same t that it meets, not that of lowest id.
class SingleRays {
 public:
  using Scalar = float;
  using Ray = Rayf;

  SingleRays(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) : scene_(mesh, knobs, threads) {}

  accel::Hit<float> closest_hit(const Rayf& ray) const {
    const ray::FlushDenormals flush;
    return closest(ray);
  }
  accel::Hit<float> closest_hit(const Rayf& ray, accel::Work&) const { return closest_hit(ray); }
  bool any_hit(const Rayf& ray) const {
    const ray::FlushDenormals flush;
    return any(ray);
  }
  bool any_hit(const Rayf& ray, accel::Work&) const { return any_hit(ray); }
  void closest_hit(std::span<const Rayf> rays, std::span<accel::Hit<float>> hits, int) const {
    const ray::FlushDenormals flush;
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = closest(rays[i]);
  }
  void any_hit(std::span<const Rayf> rays, std::span<std::uint8_t> out, int) const {
    const ray::FlushDenormals flush;
    for (std::size_t i = 0; i < rays.size(); ++i) out[i] = any(rays[i]);
  }

 private:
  accel::Hit<float> closest(const Rayf& ray) const {
    ray::EmbreeCall call(false);
    RTCRayHit query;
    ray::to_embree(ray, query.ray);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    call(scene_.scene(), query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {query.ray.tfar, query.hit.primID, query.hit.u, query.hit.v};
  }
  bool any(const Rayf& ray) const {
    ray::EmbreeCall call(false);
    RTCRay query;
    ray::to_embree(ray, query);
    call(scene_.scene(), query);
    return query.tfar < 0;  // Embree's mark of an occluded ray is -infinity
  }

  ray::EmbreeScene scene_;
};
static_assert(accel::RayIndex<SingleRays>);

std::vector<Knobs> builds() { return {{{"quality", "medium"}}, {{"quality", "high"}}}; }

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "mis_embree",
              .family = "bvh",
              .source = Source::peer,
              .claim = Claim::stochastic,
              .peer_version = ray::embree_version(),
              .build_knobs = builds(),
              .query_knobs = sample_knobs({4, 16, 64, 1}),
              .ladder = 31,
              .quick_builds = 1},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<RoomSubject> {
       transport::PathOptions options;
       options.seed = input.seed;
       return std::make_unique<PathSubject<SingleRays>>(
           input, std::make_unique<SingleRays>(input.room.mesh, knobs, input.threads), options);
     },
     .combines = true});

}  // namespace
}  // namespace treeline::bench::light_transport
