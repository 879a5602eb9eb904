// No shadows at all: the least model, and what every other one is worth.
#include <algorithm>

#include "bench/core/registry.hpp"
#include "bench/shadow/method.hpp"

namespace treeline::bench::shadow {
namespace {

class Unshadowed final : public ShadowSubject {
 public:
  void visibility(std::span<const Receiver>, const Knobs&, int, std::span<float> out) override {
    std::ranges::fill(out, 1.0f);
  }
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info =
         {.name = "unshadowed", .family = "brute", .claim = Claim::approximate, .ladder = 0, .scales = false},
     .build = [](const Input&, const Knobs&) -> std::unique_ptr<ShadowSubject> {
       return std::make_unique<Unshadowed>();
     }});

}  // namespace
}  // namespace treeline::bench::shadow
