// One to six maps by distance from the camera, of parallel light; fitted to what is visible, or to the
// frustum with texels that stay where they are.
#include "shading/shadow/cascades.hpp"

#include "bench/shadow/maps.hpp"
#include "shading/shadow/pcf.hpp"

namespace treeline::bench::shadow {
namespace {

using namespace shading::shadow;

struct Slices {
  CascadeViews views;
  std::vector<DepthMap> maps;
};

Slices slices(const Input& input, const Knobs& knobs) {
  const LightView whole = whole_view(input.scene);
  if (whole.perspective) throw Unsupported("cascades take parallel light alone");
  std::vector<Vec3d> visible;
  for (const Receiver& r : input.receivers) visible.push_back(r.position);
  CascadeOptions o;
  o.count = knobs.at("cascades").get<int>(), o.lambda = knobs.at("lambda").get<double>();
  o.resolution = knobs.at("resolution").get<int>(), o.fitted = knobs.at("fitted").get<bool>();
  o.margin = 8;
  Slices s{fit_cascades(whole, input.scene.camera, visible, o), {}};
  for (const LightView& view : s.views.views) s.maps.push_back(depth_map(input, view, o.resolution));
  return s;
}

/// The maps are the subject's; each query makes its methods anew.
class OverSlices {
 public:
  OverSlices(const Slices& s, const PcfGridOptions& options) : views_(&s.views) {
    for (const DepthMap& map : s.maps) methods_.emplace_back(map, options);
  }
  float visibility(const Receiver& r) const { return methods_[views_->slice(r.position)].visibility(r); }
  std::size_t bytes() const { return methods_.size() * methods_.front().bytes(); }

 private:
  const CascadeViews* views_;
  std::vector<PcfGrid> methods_;
};

std::vector<Knobs> builds() {
  std::vector<Knobs> r;
  for (const int n : {4, 1, 2, 3, 6})
    r.push_back({{"resolution", 512}, {"cascades", n}, {"lambda", 1}, {"fitted", true}});
  r.push_back({{"resolution", 512}, {"cascades", 4}, {"lambda", 1}, {"fitted", false}});
  r.push_back({{"resolution", 512}, {"cascades", 4}, {"lambda", 0.5}, {"fitted", true}});
  for (const int n : {256, 1024, 2048})
    r.push_back({{"resolution", n}, {"cascades", 4}, {"lambda", 1}, {"fitted", true}});
  return r;
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "cascades",
              .family = "map",
              .claim = Claim::approximate,
              .build_knobs = builds(),
              .query_knobs = {{{"radius", 0}, {"smooth", false}, {"plane", true}},
                              {{"radius", 1}, {"smooth", true}, {"plane", true}},
                              {{"radius", 4}, {"smooth", true}, {"plane", true}}},
              .ladder = 13,
              .quick_builds = 4},
     .build = [](const Input& input, const Knobs& knobs) {
       return map_subject(
           input, slices(input, knobs), [](const Slices& s, const shading::Scene&, const Knobs& q) {
             return OverSlices(s, {q.at("radius").get<int>(), q.at("smooth").get<bool>(), bias_of(q)});
           });
     }});

}  // namespace
}  // namespace treeline::bench::shadow
