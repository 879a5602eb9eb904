// Whitted tracing: mirrors and glass to their ends, lamps by shadow rays, and nothing beyond a diffuse
// surface.
#include "shading/transport/whitted.hpp"
#include "bench/light_transport/path_subject.hpp"
#include "bench/light_transport/tree.hpp"

namespace treeline::bench::light_transport {
namespace {

class WhittedSubject final : public RoomSubject {
 public:
  explicit WhittedSubject(const Input& input)
      : room_(input.room), seed_(input.seed), tree_(make_tree(room_.mesh)) {
    tracer(Knobs::object());
  }

  Film render(const Question& asked, const Knobs& knobs, int threads, Traced& traced) override {
    auto& made = tracers_[knobs.dump()];
    if (!made) made = tracer(knobs);
    Film film(asked.width, asked.height);
    const int samples = knobs.at("samples").get<int>();
    const transport::WhittedCounts counts = asked.source ? made->render(film, samples, threads, asked.source)
                                                         : made->render(film, samples, threads);
    traced = {};
    traced.paths = static_cast<double>(counts.primary), traced.rays = traced.paths;
    for (const transport::BounceCounts& b : counts.bounces) {
      const BounceRays rays{static_cast<double>(b.reflected), static_cast<double>(b.refracted),
                            static_cast<double>(b.shadow)};
      traced.rays += rays.reflected + rays.refracted, traced.shadow_rays += rays.shadow;
      traced.bounces.push_back(rays);
    }
    return film;
  }

 private:
  using Whitted = transport::Whitted<Tree>;

  std::unique_ptr<Whitted> tracer(const Knobs& knobs) const {
    transport::WhittedOptions options;
    options.max_bounces = knobs.value("bounces", 5), options.shadow_rays = knobs.value("shadow_rays", 1);
    options.seed = seed_;
    return std::make_unique<Whitted>(*tree_, room_, options);
  }

  const LitScene& room_;
  std::uint64_t seed_;
  std::unique_ptr<Tree> tree_;
  std::map<std::string, std::unique_ptr<Whitted>> tracers_;
};

std::vector<Knobs> knobs() {
  std::vector<Knobs> all;
  for (const int bounces : {5, 3, 1, 8})
    all.push_back({{"samples", 4}, {"bounces", bounces}, {"shadow_rays", 4}});
  all.push_back({{"samples", 1}, {"bounces", 5}, {"shadow_rays", 1}});
  all.push_back({{"samples", 16}, {"bounces", 5}, {"shadow_rays", 4}});
  return all;
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "whitted",
              .family = "bvh",
              .claim = Claim::approximate,
              .query_knobs = knobs(),
              .ladder = 0,
              .scales = false},
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<RoomSubject> {
       return std::make_unique<WhittedSubject>(input);
     }});

}  // namespace
}  // namespace treeline::bench::light_transport
