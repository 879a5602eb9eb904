// Path tracing over any tree, as a method.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "bench/core/registry.hpp"
#include "bench/light_transport/method.hpp"
#include "shading/transport/path_tracer.hpp"

namespace treeline::bench::light_transport {

namespace transport = shading::transport;

inline constexpr int no_limit = 100'000;  // of bounces

/// What the knobs say beyond the method's own options.
inline transport::PathOptions with_knobs(transport::PathOptions options, const Knobs& knobs) {
  options.max_bounces = knobs.value("bounces", no_limit);
  if (knobs.contains("survival")) {
    const auto p = knobs.at("survival").get<float>();
    options.survival = p < 1 ? transport::survive_with(p) : transport::Survival();
  }
  if (knobs.value("points", std::string("random")) == "sobol") {
    options.points = transport::Points::sobol_owen;
    options.set = knobs.at("samples").get<int>();  // all samples of a pixel are one net
  }
  return options;
}

/// Samples alone.
inline std::vector<Knobs> sample_knobs(std::initializer_list<int> samples,
                                       const Knobs& rest = Knobs::object()) {
  std::vector<Knobs> out;
  for (const int n : samples) {
    Knobs& knobs = out.emplace_back(Knobs{{"samples", n}});
    knobs.update(rest);
  }
  return out;
}

inline Traced traced(const transport::RayCounts& c) {
  return {static_cast<double>(c.paths), static_cast<double>(c.rays), static_cast<double>(c.shadow_rays), {}};
}

/// Keeps what a tracer makes of the room for each set of knobs, so that no run waits for it but the first.
template <class Index>
class PathSubject final : public RoomSubject {
 public:
  PathSubject(const Input& input, std::unique_ptr<Index> index, transport::PathOptions options)
      : room_(input.room), index_(std::move(index)), options_(std::move(options)) {
    transport::PathTracer<Index>(*index_, room_,
                                 options_);  // refuses what it cannot take, as part of the build
  }

  Film render(const Question& asked, const Knobs& knobs, int threads, Traced& counts) override {
    auto& tracer = tracers_[knobs.dump()];
    if (!tracer)
      tracer = std::make_unique<transport::PathTracer<Index>>(*index_, room_, with_knobs(options_, knobs));
    Film film = tracer->film(asked.width, asked.height);
    const int samples = knobs.at("samples").get<int>();
    counts = traced(asked.source ? tracer->render(film, samples, threads, asked.source)
                                 : tracer->render(film, samples, threads));
    return film;
  }

 private:
  const LitScene& room_;
  std::unique_ptr<Index> index_;
  transport::PathOptions options_;
  std::map<std::string, std::unique_ptr<transport::PathTracer<Index>>> tracers_;
};

}  // namespace treeline::bench::light_transport
