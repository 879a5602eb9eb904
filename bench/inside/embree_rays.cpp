// Embree: the side of what a ray first meets, by the normal it returns; and the number of all that a ray
// meets, counted by a filter that lets every hit pass.
//
// Its rays run as ours do, outward by the octant of the point.
// Claim: approximate. They may slip through edges (see bench/ray/embree_single.cpp), and hits are in
// float.
#include "accel/batch.hpp"
#include "accel/signed_distance/first_hit.hpp"
#include "bench/inside/method.hpp"
#include "bench/ray/embree.hpp"

namespace treeline::bench::inside {
namespace {

using geometry::Vec3f;

RTCRayHit ray_along(const Vec3f& p, const Vec3f& direction) {
  RTCRayHit query;
  ray::to_embree({.origin = p, .direction = direction}, query.ray);
  query.hit.geomID = query.hit.primID = RTC_INVALID_GEOMETRY_ID;
  return query;
}

class EmbreeRays : public Index {
 public:
  EmbreeRays(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads)
      : directions_(mesh.vertices.empty() ? Vec3f{} : mesh.box().centre()), scene_(mesh, knobs, threads) {}

  void inside(std::span<const Vec3f> points, std::span<std::uint8_t> out, const Knobs&,
              int threads) const override {
    accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      const ray::FlushDenormals flush;
      for (std::size_t i = begin; i < end; ++i) out[i] = inside(points[i]);
    });
  }

 protected:
  virtual bool inside(const Vec3f& p) const = 0;
  RTCScene scene() const { return scene_.scene(); }
  RTCRayHit ray_from(const Vec3f& p) const { return ray_along(p, directions_(p, 0)); }

 private:
  accel::ProbeDirections directions_;
  ray::EmbreeScene scene_;
};

class EmbreeFacing final : public EmbreeRays {
 public:
  using EmbreeRays::EmbreeRays;

 private:
  bool inside(const Vec3f& p) const override {
    ray::EmbreeCall call(false);
    RTCRayHit query = ray_from(p);
    call(scene(), query);
    return query.hit.geomID != RTC_INVALID_GEOMETRY_ID && query.hit.Ng_x * query.ray.dir_x +
                                                                  query.hit.Ng_y * query.ray.dir_y +
                                                                  query.hit.Ng_z * query.ray.dir_z >
                                                              0;
  }
};

class EmbreeParity final : public EmbreeRays {
 public:
  EmbreeParity(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads)
      : EmbreeRays(mesh, knobs, threads) {
    const RTCGeometry triangles = rtcGetGeometry(scene(), 0);
    rtcSetGeometryIntersectFilterFunction(triangles, [](const RTCFilterFunctionNArguments* arguments) {
      arguments->valid[0] = 0;  // on to the next
      ++hits_;
    });
    rtcCommitGeometry(triangles);
    rtcCommitScene(scene());
  }

 private:
  static inline thread_local unsigned hits_ = 0;

  bool inside(const Vec3f& p) const override {
    ray::EmbreeCall call(false);
    RTCRayHit query = ray_from(p);
    hits_ = 0;
    call(scene(), query);
    return hits_ % 2 == 1;
  }
};

std::vector<Knobs> builds() {
  std::vector<Knobs> all;
  for (const bool robust : {false, true}) all.push_back(Knobs{{"quality", "medium"}, {"robust", robust}});
  return all;
}

template <class Of>
bool add(const char* name, int ladder, bool by_facing) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "bvh",
                .source = Source::peer,
                .claim = Claim::approximate,
                .peer_version = ray::embree_version(),
                .build_knobs = builds(),
                .stress_builds = {0, 1},
                .ladder = ladder},
       .build = [](const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) -> std::unique_ptr<Index> {
         return std::make_unique<Of>(mesh, knobs, threads);
       },
       .by_facing = by_facing,
       .warm_up = ray::warm_up_embree});
}
[[maybe_unused]] const bool facing = add<EmbreeFacing>("embree_facing", 15, true);
[[maybe_unused]] const bool parity = add<EmbreeParity>("embree_parity", 25, false);

}  // namespace
}  // namespace treeline::bench::inside
