// Maps by Embree's rays: the same through the same centres, 16 neighbours (4 × 4) a packet, from the near
// plane to the far one. Claim: as embree_single.cpp says of rays.
#include "bench/ray/embree.hpp"
#include "bench/shadow/redrawn.hpp"
#include "shading/raster/cast_depth.hpp"

namespace treeline::bench::shadow {
namespace {

using geometry::Vec3d;
using geometry::Vec3f;

/// Rays through the centres of a map: origin and direction change evenly along rows and columns.
class Rays {
 public:
  Rays(const LightView& view, int side)
      : from_(view.at({0.5 / side, 0.5 / side, 0})), way_(view.at({0.5 / side, 0.5 / side, 1}) - from_) {
    for (int axis = 0; axis < 2; ++axis) {
      const double x = axis == 0 ? 1 : 0, y = 1 - x;
      const Vec3d to = view.at({x, y, 0}) - view.at({0, 0, 0}),
                  far = view.at({x, y, 1}) - view.at({0, 0, 1}) - to;
      step_[axis] = to / double(side), turn_[axis] = far / double(side);
      for (int k = 0; k < 3; ++k)
        for (int lane = 0; lane < 16; ++lane) {
          const double by = axis == 0 ? lane % 4 : lane / 4;
          if (axis == 0) origin_[k][lane] = direction_[k][lane] = 0;
          origin_[k][lane] += float(step_[axis][k] * by), direction_[k][lane] += float(turn_[axis][k] * by);
        }
    }
  }
  /// Those of 4 × 4 texels.
  void fill(RTCRayHit16& packet, int x, int y) const {
    const Vec3f o(from_ + step_[0] * double(x) + step_[1] * double(y)),
        d(way_ + turn_[0] * double(x) + turn_[1] * double(y));
    for (int lane = 0; lane < 16; ++lane) {
      packet.ray.org_x[lane] = o[0] + origin_[0][lane], packet.ray.org_y[lane] = o[1] + origin_[1][lane];
      packet.ray.org_z[lane] = o[2] + origin_[2][lane], packet.ray.tnear[lane] = 0;
      packet.ray.dir_x[lane] = d[0] + direction_[0][lane],
      packet.ray.dir_y[lane] = d[1] + direction_[1][lane];
      packet.ray.dir_z[lane] = d[2] + direction_[2][lane], packet.ray.time[lane] = 0;
      packet.ray.tfar[lane] = 1, packet.ray.mask[lane] = ~0u, packet.ray.flags[lane] = 0;
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
  }

 private:
  Vec3d from_, way_, step_[2], turn_[2];
  alignas(64) float origin_[3][16], direction_[3][16];
};

void cast(const ray::EmbreeScene& scene, const LightView& view, int side, int threads, DepthMap& map) {
  map.view = view, map.width = map.height = side;
  map.first.assign(std::size_t(side) * std::size_t(side), 1.0f);
  const Rays rays(view, side);
  shading::raster::each(std::size_t(side + 3) / 4, threads, [&](std::size_t row) {
    const ray::FlushDenormals flush;
    ray::EmbreeCall call(true);
    alignas(64) int valid[16];
    alignas(64) RTCRayHit16 packet;
    const int y = 4 * int(row);
    for (int x = 0; x < side; x += 4) {
      for (int lane = 0; lane < 16; ++lane) valid[lane] = x + lane % 4 < side && y + lane / 4 < side ? -1 : 0;
      rays.fill(packet, x, y);
      call(valid, scene.scene(), packet);
      for (int lane = 0; lane < 16; ++lane)
        if (valid[lane] && packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID)
          map.first[map.index(x + lane % 4, y + lane / 4)] = std::min(1.0f, packet.ray.tfar[lane]);
    }
  });
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "embree_redrawn_map",
              .family = "map",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = ray::embree_version(),
              .build_knobs = {Knobs{{"quality", "high"}}, Knobs{{"quality", "medium"}}},
              .query_knobs = redrawn_resolutions(),
              .ladder = 2,
              .quick_builds = 1,
              .scales = false},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<ShadowSubject> {
       auto scene = std::make_unique<ray::EmbreeScene>(input.scene.mesh, knobs, input.threads);
       if (!rtcGetDeviceProperty(scene->device(), RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED))
         throw Unsupported("this machine's instruction set has no native packets of 16 rays");
       return redrawn(
           input, [scene = std::move(scene)](const LightView& view, int side, int threads, DepthMap& map) {
             cast(*scene, view, side, threads, map);
           });
     }});

}  // namespace
}  // namespace treeline::bench::shadow
