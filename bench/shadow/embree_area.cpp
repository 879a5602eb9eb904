// Rays to points of the light, through Embree: the same points, in packets or one by one.
#include "bench/ray/embree_packet.hpp"
#include "bench/shadow/area_rays.hpp"

namespace treeline::bench::shadow {
namespace {

using geometry::Rayf;

/// One ray a call.
class Single {
 public:
  Single(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) : scene_(mesh, knobs, threads) {}
  void any(std::span<const Rayf> rays, std::span<std::uint8_t> out, const Knobs&, int) const {
    const ray::FlushDenormals flush;
    ray::EmbreeCall call(true);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      RTCRay query;
      ray::to_embree(rays[i], query);
      call(scene_.scene(), query);
      out[i] = query.tfar < 0;  // Embree's mark of an occluded ray is -infinity
    }
  }

 private:
  ray::EmbreeScene scene_;
};

/// Embree as a tree that shadows are asked of.
template <class Index>
class Occlusion {
 public:
  using Scalar = float;
  using Ray = Rayf;
  Occlusion(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) : index_(mesh, knobs, threads) {}
  void any_hit(std::span<const Rayf> rays, std::span<std::uint8_t> out, int threads) const {
    static const Knobs coherent{{"coherent", true}};
    index_.any(rays, out, coherent, threads);
  }

 private:
  Index index_;
};

template <class Index>
std::unique_ptr<ShadowSubject> subject(const Input& input, const Knobs& knobs) {
  using Tree = Occlusion<Index>;
  return std::make_unique<AreaRaySubject<Tree>>(input, [&](const geometry::Mesh3f& mesh, int threads) {
    return std::make_unique<Tree>(mesh, knobs, threads);
  });
}

/// Packets as wide as the machine has them come first, for where only some of these are tried.
std::vector<Knobs> builds() {
  std::vector<Knobs> all;
  for (const auto& [quality, packet] : {std::pair{"medium", 16}, {"medium", 8}, {"high", 8}, {"medium", 1}})
    all.push_back({{"quality", quality}, {"packet", packet}});
  return all;
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "embree_area",
              .family = "bvh",
              .source = Source::peer,
              .claim = Claim::stochastic,
              .peer_version = ray::embree_version(),
              .build_knobs = builds(),
              .query_knobs = area_ray_knobs(false),
              .ladder = 51,
              .quick_builds = 2},
     .build = [](const Input& input, const Knobs& knobs) -> std::unique_ptr<ShadowSubject> {
       switch (knobs.at("packet").get<int>()) {
         case 16:
           return subject<ray::EmbreePacket<16>>(input, knobs);
         case 8:
           return subject<ray::EmbreePacket<8>>(input, knobs);
         default:
           return subject<Single>(input, knobs);
       }
     }});

}  // namespace
}  // namespace treeline::bench::shadow
