// Path tracing with every way to draw directions and to reach lamps, over our widest tree.
#include "bench/light_transport/path_subject.hpp"
#include "bench/light_transport/tracer.hpp"
#include "bench/light_transport/tree.hpp"

namespace treeline::bench::light_transport {
namespace {

using transport::Directions;
using transport::Lights;

template <Directions D, Lights L>
std::unique_ptr<RoomSubject> build(const Input& input, const Knobs&) {
  transport::PathOptions options;
  options.directions = D, options.lights = L, options.seed = input.seed;
  return std::make_unique<PathSubject<Tree>>(input, make_tree(input.room.mesh), options);
}

template <Directions D, Lights L>
bool add(const char* name, int ladder, std::vector<Knobs> knobs) {
  Method method;
  method.info.name = name, method.info.family = "bvh", method.info.claim = Claim::stochastic;
  method.info.query_knobs = std::move(knobs), method.info.ladder = ladder;
  method.info.scales = L == Lights::mis;
  method.build = build<D, L>, method.combines = L == Lights::mis;
  method.for_metal = D == Directions::bsdf && L != Lights::mis;
  return Registry<Method>::instance().add(std::move(method));
}

std::vector<Knobs> of_mis() {
  std::vector<Knobs> all = sample_knobs({4, 16, 64, 1});
  const auto more = [&](std::vector<Knobs> knobs) { all.insert(all.end(), knobs.begin(), knobs.end()); };
  more(sample_knobs({4, 16, 64, 1}, {{"points", "sobol"}}));
  for (const int bounces : {1, 2, 5, 10, 20}) more(sample_knobs({64}, {{"bounces", bounces}}));
  for (const double p : {0.9, 0.5}) more(sample_knobs({64}, {{"survival", p}}));
  return all;
}

const std::vector<Knobs> plain = sample_knobs({4, 16, 64, 1});

[[maybe_unused]] const bool registered =
    add<Directions::uniform, Lights::none>("path_uniform", 10, plain) &&
    add<Directions::cosine, Lights::none>("path_cosine", 11, plain) &&
    add<Directions::bsdf, Lights::none>("path_bsdf", 12, plain) &&
    add<Directions::uniform, Lights::next_event>("next_event_uniform", 20, plain) &&
    add<Directions::cosine, Lights::next_event>("next_event_cosine", 21, plain) &&
    add<Directions::bsdf, Lights::next_event>("next_event_bsdf", 22, plain) &&
    add<Directions::bsdf, Lights::mis>("mis", 30, of_mis());

class MisTracer final : public Tracer {
 public:
  MisTracer(const LitScene& room, std::uint64_t seed, int set)
      : tree_(make_tree(room.mesh)), tracer_(*tree_, room, [&] {
          transport::PathOptions o;
          o.points = transport::Points::sobol_owen, o.set = set, o.seed = seed, o.max_bounces = no_limit;
          return o;
        }()) {}
  Film film() const override { return tracer_.film(); }
  void add(Film& film, int samples, int threads) const override { tracer_.render(film, samples, threads); }

 private:
  std::unique_ptr<Tree> tree_;
  transport::PathTracer<Tree> tracer_;
};

}  // namespace

std::unique_ptr<Tree> make_tree(const geometry::Mesh3f& mesh) {
  Tree::Options options;
  options.non_finite = accel::NonFinite::drop;
  return std::make_unique<Tree>(mesh, options);
}

std::unique_ptr<Tracer> mis_tracer(const LitScene& room, std::uint64_t seed, int set) {
  return std::make_unique<MisTracer>(room, seed, set);
}

}  // namespace treeline::bench::light_transport
