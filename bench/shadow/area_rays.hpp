// What the methods that cast rays to points of the light have in common: their knobs, and the sampling. Which
// tree the rays are cast through is all that they differ in.
#pragma once

#include <map>
#include <string>

#include "bench/core/registry.hpp"
#include "bench/shadow/lights.hpp"
#include "bench/shadow/method.hpp"
#include "shading/shadow/area_rays.hpp"

namespace treeline::bench::shadow {

/// rays a receiver, of the best pattern; of our own still more, for small tolerances, and 16 of the others.
inline std::vector<Knobs> area_ray_knobs(bool ours) {
  std::vector<Knobs> all;
  for (const int rays : {16, 1, 64, 4, 2, 8, 32, 256}) all.push_back({{"rays", rays}});
  if (!ours) return all;
  all.push_back({{"rays", 512}});
  for (const char* pattern : {"jittered", "random", "regular"})
    all.push_back({{"rays", 16}, {"pattern", pattern}});
  return all;
}
inline shading::shadow::SamplePattern pattern_of(const Knobs& knobs) {
  using enum shading::shadow::SamplePattern;
  static const std::map<std::string, shading::shadow::SamplePattern> named{
      {"sobol_owen", sobol_owen}, {"random", random}, {"jittered", jittered}, {"regular", regular}};
  return named.at(knobs.value("pattern", "sobol_owen"));
}

/// `how` is passed on to the tree's any_hit.
template <shading::shadow::OcclusionIndex Tree, auto... how>
class AreaRaySubject : public ShadowSubject {
 public:
  /// tree(mesh, threads) makes the tree.
  template <class Make>
  AreaRaySubject(const Input& input, Make&& make)
      : scene_(input.scene),
        tree_(make(input.scene.mesh, input.threads)),
        offset_(shading::shadow::surface_offset<float>(input.scene)) {}

  void visibility(std::span<const Receiver> receivers, const Knobs& knobs, int threads,
                  std::span<float> out) override {
    if (is_hard(scene_.light) && knobs != Knobs{{"rays", 1}})
      throw Unsupported("a light without extent takes one ray, whatever is asked");
    shading::shadow::AreaRayOptions o;
    o.samples = knobs.value("rays", 16), o.pattern = pattern_of(knobs), o.offset = offset_;
    const shading::shadow::AreaRays rays(*tree_, scene_, o);
    rays.visibility(receivers, out, threads, how...);
  }

 private:
  const shading::Scene& scene_;
  std::unique_ptr<Tree> tree_;
  double offset_;
};

}  // namespace treeline::bench::shadow
