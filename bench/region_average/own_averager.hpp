// Our averagers as methods.
#pragma once

#include "bench/core/registry.hpp"
#include "bench/region_average/method.hpp"
#include "geometry/tolerances.hpp"
#include "shading/texture/region_averager.hpp"

namespace treeline::bench::region_average {

/// One that is asked without knobs.
template <shading::texture::RegionAverager A>
class Own final : public Averager {
 public:
  explicit Own(const Input& input) : averager_(make(input)) {}

  void means(std::span<const Footprint> footprints, const Knobs&, int threads,
             std::span<float> out) const override {
    shading::texture::means(averager_, footprints, out, threads);
  }
  void rebuild(const Image& image, int threads) override {
    if constexpr (requires { averager_.rebuild(image, threads); })
      averager_.rebuild(image, threads);
    else
      averager_.rebuild(image);
  }

 private:
  static A make(const Input& input) {
    if constexpr (std::constructible_from<A, const Image&, int>)
      return A(input.image, input.threads);
    else
      return A(input.image);
  }

  A averager_;
};

template <class A>
std::unique_ptr<Averager> make_own(const Input& input, const Knobs&) {
  return std::make_unique<Own<A>>(input);
}

}  // namespace treeline::bench::region_average
