// The path tracer of the textbook, as its pseudo-code has it and put right; single rays, one after the other.
//
// slip: emitters (as printed: lamps that are met count nothing and end the path, so that neither their own
// light nor what they reflect is seen), roulette_first (beyond that, the die is cast before the light is
// drawn, which is not divided by its probability), half_pi (the hemisphere taken for π/2 steradians).
#include "shading/transport/textbook.hpp"
#include "bench/light_transport/path_subject.hpp"
#include "bench/light_transport/tree.hpp"

namespace treeline::bench::light_transport {
namespace {

class TextbookSubject final : public RoomSubject {
 public:
  TextbookSubject(const Input& input, bool corrected)
      : room_(input.room), seed_(input.seed), tree_(make_tree(room_.mesh)), corrected_(corrected) {
    tracer(Knobs::object());
  }

  Film render(const Question& asked, const Knobs& knobs, int threads, Traced& counts) override {
    auto& made = tracers_[knobs.dump()];
    if (!made) made = tracer(knobs);
    Film film(asked.width, asked.height);
    const int samples = knobs.at("samples").get<int>();
    counts = traced(asked.source ? made->render(film, samples, threads, asked.source)
                                 : made->render(film, samples, threads));
    return film;
  }

 private:
  using Textbook = transport::Textbook<Tree>;

  std::unique_ptr<Textbook> tracer(const Knobs& knobs) const {
    transport::TextbookOptions options;
    options.max_bounces = knobs.value("bounces", no_limit), options.seed = seed_;
    const std::string slip = knobs.value("slip", std::string("emitters"));
    options.roulette_first = !corrected_ && slip == "roulette_first";
    options.hemisphere_half_pi = !corrected_ && slip == "half_pi";
    options.drop_reflected_emitters = !corrected_, options.emission_seen = corrected_;
    return std::make_unique<Textbook>(*tree_, room_, options);
  }

  const LitScene& room_;
  std::uint64_t seed_;
  std::unique_ptr<Tree> tree_;
  bool corrected_;
  std::map<std::string, std::unique_ptr<Textbook>> tracers_;
};

template <bool Corrected>
std::unique_ptr<RoomSubject> build(const Input& input, const Knobs&) {
  return std::make_unique<TextbookSubject>(input, Corrected);
}

std::vector<Knobs> slips() {
  std::vector<Knobs> all = sample_knobs({64, 16, 4}, {{"slip", "emitters"}});
  for (const char* slip : {"roulette_first", "half_pi"})
    all.push_back(sample_knobs({64}, {{"slip", slip}}).front());
  return all;
}

[[maybe_unused]] const bool registered =
    Registry<Method>::instance().add({.info = {.name = "textbook_literal",
                                               .family = "bvh",
                                               .claim = Claim::approximate,
                                               .query_knobs = slips(),
                                               .ladder = 2,
                                               .scales = false},
                                      .build = build<false>,
                                      .mirrors = false}) &&
    Registry<Method>::instance().add({.info = {.name = "textbook_corrected",
                                               .family = "bvh",
                                               .claim = Claim::stochastic,
                                               .query_knobs = sample_knobs({64, 16, 4, 1}),
                                               .ladder = 13,
                                               .scales = false},
                                      .build = build<true>,
                                      .mirrors = false});

}  // namespace
}  // namespace treeline::bench::light_transport
