// Embree, packets of N rays a call, in the caller's order: rtcIntersect8/16 and rtcOccluded8/16.
//
// Known weakness: rays of a packet walk together, which pays for coherent rays and costs for scattered ones.
#pragma once

#include "accel/batch.hpp"
#include "bench/ray/embree.hpp"

namespace treeline::bench::ray {

template <int N>
struct EmbreePacketTypes;
template <>
struct EmbreePacketTypes<8> {
  using Ray = RTCRay8;
  using RayHit = RTCRayHit8;
  static constexpr RTCDeviceProperty native = RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED;
};
template <>
struct EmbreePacketTypes<16> {
  using Ray = RTCRay16;
  using RayHit = RTCRayHit16;
  static constexpr RTCDeviceProperty native = RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED;
};

template <int N>
class EmbreePacket final : public Index {
 public:
  using Types = EmbreePacketTypes<N>;

  EmbreePacket(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) : scene_(mesh, knobs, threads) {
    if (!rtcGetDeviceProperty(scene_.device(), Types::native))
      throw Unsupported("this machine's instruction set has no native packets of " + std::to_string(N) +
                        " rays");
  }

  void closest(std::span<const geometry::Rayf> rays, std::span<RayAnswer> out, const Knobs& knobs,
               int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      const FlushDenormals flush;
      EmbreeCall call(knobs.value("coherent", false));
      alignas(64) int valid[N];
      typename Types::RayHit packet;
      for (std::size_t i = begin; i < end; i += N) {
        fill(packet.ray, valid, rays.subspan(i, std::min<std::size_t>(N, end - i)));
        for (int lane = 0; lane < N; ++lane) packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        call(valid, scene_.scene(), packet);
        for (std::size_t lane = 0; lane < std::min<std::size_t>(N, end - i); ++lane) {
          out[i + lane] = {};
          if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
          out[i + lane].t = packet.ray.tfar[lane], out[i + lane].primitive = packet.hit.primID[lane];
        }
      }
    });
  }
  void any(std::span<const geometry::Rayf> rays, std::span<std::uint8_t> out, const Knobs& knobs,
           int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      const FlushDenormals flush;
      EmbreeCall call(knobs.value("coherent", false));
      alignas(64) int valid[N];
      typename Types::Ray packet;
      for (std::size_t i = begin; i < end; i += N) {
        fill(packet, valid, rays.subspan(i, std::min<std::size_t>(N, end - i)));
        call(valid, scene_.scene(), packet);
        for (std::size_t lane = 0; lane < std::min<std::size_t>(N, end - i); ++lane)
          out[i + lane] = packet.tfar[lane] < 0;
      }
    });
  }

  bool refit(const geometry::Mesh3f& mesh) override { return scene_.refit(mesh); }

 private:
  /// Lanes past the last ray repeat it, switched off.
  static void fill(typename Types::Ray& packet, int* valid, std::span<const geometry::Rayf> rays) {
    for (int lane = 0; lane < N; ++lane) {
      const bool used = static_cast<std::size_t>(lane) < rays.size();
      const geometry::Rayf& r = rays[used ? static_cast<std::size_t>(lane) : rays.size() - 1];
      valid[lane] = used ? -1 : 0;
      packet.org_x[lane] = r.origin[0], packet.org_y[lane] = r.origin[1], packet.org_z[lane] = r.origin[2];
      packet.dir_x[lane] = r.direction[0], packet.dir_y[lane] = r.direction[1],
      packet.dir_z[lane] = r.direction[2];
      packet.tnear[lane] = r.t_min, packet.tfar[lane] = r.t_max, packet.time[lane] = 0;
      packet.mask[lane] = ~0u, packet.id[lane] = 0, packet.flags[lane] = 0;
    }
  }

  EmbreeScene scene_;
};

template <int N>
bool register_embree_packet() {
  // By threads as single rays do.
  return register_embree_batch<EmbreePacket<N>>("embree_packet" + std::to_string(N), 41, false);
}

}  // namespace treeline::bench::ray
