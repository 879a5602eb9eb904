// Maps by Embree's rays: the same through the same centres, neighbours (4 × 4 or 4 × 2) in packets of 16 or
// 8, from the near plane to the far one. Claim: as embree_single.cpp says of rays.
#include "bench/ray/embree_packet.hpp"
#include "bench/shadow/redrawn.hpp"
#include "shading/raster/cast_depth.hpp"

namespace treeline::bench::shadow {
namespace {

using geometry::Vec3d;
using geometry::Vec3f;

constexpr int columns = 4;  ///< of a packet

/// Rays through the centres of a map: origin and direction change evenly along rows and columns. N a packet.
template <int N>
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
        for (int lane = 0; lane < N; ++lane) {
          const double by = axis == 0 ? lane % columns : lane / columns;
          if (axis == 0) origin_[k][lane] = direction_[k][lane] = 0;
          origin_[k][lane] += float(step_[axis][k] * by), direction_[k][lane] += float(turn_[axis][k] * by);
        }
    }
  }
  /// Those of the texels from (x, y) on.
  void fill(typename ray::EmbreePacketTypes<N>::RayHit& packet, int x, int y) const {
    const Vec3f o(from_ + step_[0] * double(x) + step_[1] * double(y)),
        d(way_ + turn_[0] * double(x) + turn_[1] * double(y));
    for (int lane = 0; lane < N; ++lane) {
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
  alignas(64) float origin_[3][N], direction_[3][N];
};

template <int N>
void cast(const ray::EmbreeScene& scene, const LightView& view, int side, int threads, DepthMap& map) {
  map.view = view, map.width = map.height = side;
  map.first.assign(std::size_t(side) * std::size_t(side), 1.0f);
  constexpr int rows = N / columns;
  const Rays<N> rays(view, side);
  shading::raster::each(std::size_t(side + rows - 1) / rows, threads, [&](std::size_t row) {
    const ray::FlushDenormals flush;
    ray::EmbreeCall call(true);
    alignas(64) int valid[N];
    alignas(64) typename ray::EmbreePacketTypes<N>::RayHit packet;
    const int y = rows * int(row);
    for (int x = 0; x < side; x += columns) {
      for (int lane = 0; lane < N; ++lane)
        valid[lane] = x + lane % columns < side && y + lane / columns < side ? -1 : 0;
      rays.fill(packet, x, y);
      call(valid, scene.scene(), packet);
      for (int lane = 0; lane < N; ++lane)
        if (valid[lane] && packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID)
          map.first[map.index(x + lane % columns, y + lane / columns)] =
              std::min(1.0f, packet.ray.tfar[lane]);
    }
  });
}

template <int N>
std::unique_ptr<ShadowSubject> subject(const Input& input, const Knobs& knobs) {
  auto scene = std::make_unique<ray::EmbreeScene>(input.scene.mesh, knobs, input.threads);
  if (!rtcGetDeviceProperty(scene->device(), ray::EmbreePacketTypes<N>::native))
    throw Unsupported("this machine's instruction set has no native packets of " + std::to_string(N) +
                      " rays");
  return redrawn(input,
                 [scene = std::move(scene)](const LightView& view, int side, int threads, DepthMap& map) {
                   cast<N>(*scene, view, side, threads, map);
                 });
}

/// Packets as wide as the machine has them come first, for where only some of these are tried.
std::vector<Knobs> builds() {
  std::vector<Knobs> all;
  for (const auto& [quality, packet] : {std::pair{"high", 16}, {"high", 8}, {"medium", 16}, {"medium", 8}})
    all.push_back({{"quality", quality}, {"packet", packet}});
  return all;
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "embree_redrawn_map",
              .family = "map",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = ray::embree_version(),
              .build_knobs = builds(),
              .query_knobs = redrawn_resolutions(),
              .ladder = 2,
              .quick_builds = 2,
              .scales = false},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<ShadowSubject> {
       return knobs.at("packet") == 16 ? subject<16>(input, knobs) : subject<8>(input, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::shadow
