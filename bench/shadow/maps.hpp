// What methods over shadow maps have in common: how a map of the scene is made, how knobs name a bias, and a
// subject that holds what was built and asks a method made of it.
#pragma once

#include <utility>

#include "bench/core/registry.hpp"
#include "bench/shadow/method.hpp"
#include "shading/shadow/bias.hpp"

namespace treeline::bench::shadow {

using shading::shadow::Bias;
using shading::shadow::DepthMap;
using shading::shadow::LightView;

/// The view that holds the scene. Throws shading::InvalidScene where one view cannot.
LightView whole_view(const shading::Scene&);

/// What the light sees through each of resolution² texels; with the surfaces behind, if wanted.
DepthMap depth_map(const Input&, const LightView&, int resolution, bool second = false);
inline DepthMap depth_map(const Input& input, const Knobs& knobs, bool second = false) {
  return depth_map(input, whole_view(input.scene), knobs.at("resolution").get<int>(), second);
}

/// Knobs: bias (multiples of the bound by slope), constant (share of the depth range), plane (compare with
/// the receiver's plane), offset (along the normal, in texels). What is absent is 0.
inline Bias bias_of(const Knobs& knobs) {
  Bias b;
  b.slope = knobs.value("bias", 0.0), b.constant = knobs.value("constant", 0.0);
  b.receiver_plane = knobs.value("plane", false), b.normal_offset = knobs.value("offset", 0.0);
  return b;
}

/// Texels along a side, the most telling first: where time is short the last are left out.
inline std::vector<Knobs> resolutions() {
  std::vector<Knobs> r;
  for (const int n : {1024, 256, 512, 2048}) r.push_back({{"resolution", n}});
  return r;
}
/// Each of these with each of those.
inline std::vector<Knobs> product(const std::vector<Knobs>& these, const std::vector<Knobs>& those) {
  std::vector<Knobs> r;
  for (const Knobs& a : these)
    for (const Knobs& b : those) {
      r.push_back(a);
      r.back().update(b);
    }
  return r;
}

/// method_of(built, scene, query_knobs) makes the method that is asked; it may refer to what was built.
template <class Built, class MethodOf>
class MapSubject final : public ShadowSubject {
 public:
  MapSubject(const Input& input, Built built, MethodOf method_of)
      : scene_(&input.scene), built_(std::move(built)), method_of_(std::move(method_of)) {}

  void visibility(std::span<const Receiver> receivers, const Knobs& knobs, int threads,
                  std::span<float> out) override {
    shading::shadow::shade(method_of_(std::as_const(built_), *scene_, knobs), receivers, threads, out);
  }

 private:
  const shading::Scene* scene_;
  Built built_;
  MethodOf method_of_;
};
template <class Built, class MethodOf>
std::unique_ptr<ShadowSubject> map_subject(const Input& input, Built built, MethodOf method_of) {
  return std::make_unique<MapSubject<Built, MethodOf>>(input, std::move(built), std::move(method_of));
}

}  // namespace treeline::bench::shadow
