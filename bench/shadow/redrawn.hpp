// Shadow maps of a light that moves: drawn anew each time that the receivers are asked about, so that what is
// timed is the drawing, by whichever way, and one comparison a receiver. What stays as long as the scene
// does, the tree of those that cast rays, is built once, and so is the memory that maps are drawn in.
#pragma once

#include "bench/shadow/maps.hpp"
#include "shading/shadow/shadow_map.hpp"

namespace treeline::bench::shadow {

/// draw(view, resolution, threads, map) draws over the map.
template <class Draw>
class RedrawnSubject final : public ShadowSubject {
 public:
  RedrawnSubject(const Input& input, Draw draw) : view_(whole_view(input.scene)), draw_(std::move(draw)) {}

  void visibility(std::span<const Receiver> receivers, const Knobs& knobs, int threads,
                  std::span<float> out) override {
    draw_(view_, knobs.at("resolution").get<int>(), threads, map_);
    shading::shadow::shade(shading::shadow::ShadowMap(map_, {{.slope = 1}}), receivers, threads, out);
  }

 private:
  LightView view_;
  Draw draw_;
  DepthMap map_;
};
template <class Draw>
std::unique_ptr<ShadowSubject> redrawn(const Input& input, Draw draw) {
  return std::make_unique<RedrawnSubject<Draw>>(input, std::move(draw));
}

/// Texels along a side.
inline std::vector<Knobs> redrawn_resolutions() { return {Knobs{{"resolution", 1024}}}; }

}  // namespace treeline::bench::shadow
