#include "bench/shadow/pictures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "bench/core/cells.hpp"
#include "bench/core/strip.hpp"
#include "bench/ray/album.hpp"
#include "bench/ray/work_picture.hpp"

namespace treeline::bench::shadow {
namespace {

using shading::Image;
using Colour = std::array<float, 3>;

constexpr int columns = 6;  // of panels
constexpr Colour not_asked{0.17f, 0.2f, 0.3f}, too_light{1.0f, 0.55f, 0.1f}, too_dark{0.25f, 0.6f, 1.0f};
constexpr float right = 0.1f;  // the grey of no error
constexpr double shown = 0.5;  // the power of errors that is: most are small
/// Strips of a scene, those whose knob changes the error most: all would be many megabytes.
constexpr std::size_t most_strips = 4;
constexpr double least_change = 0.01;  // of the error, or a knob does not matter
/// Scenes of a single wide penumbra, and of distances: all strips that there are, builds included.
constexpr const char* with_all_strips[] = {"sphere_over_floor", "city"};

void put(Image& image, std::uint32_t pixel, const Colour& c) {
  std::copy_n(c.begin(), 3, image.values.begin() + std::ptrdiff_t{3} * pixel);
}
Image blank(const Receivers& seen) {
  Image image(seen.width, seen.height, 3);
  for (std::uint32_t p = 0; p < std::uint32_t(seen.width * seen.height); ++p) put(image, p, not_asked);
  return image;
}
Image shares(const Receivers& seen, std::span<const float> answers) {
  Image image = blank(seen);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const float v = std::clamp(answers[i], 0.0f, 1.0f);
    put(image, seen.pixel[i], {v, v, v});
  }
  return image;
}
Image errors(const Receivers& seen, std::span<const float> answers, std::span<const double> truth) {
  Image image = blank(seen);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const double off = double(answers[i]) - truth[i];
    const Colour& full = off > 0 ? too_light : too_dark;
    const auto share = static_cast<float>(std::pow(std::min(1.0, std::abs(off)), shown));
    Colour c;
    for (std::size_t k = 0; k < 3; ++k) c[k] = right + share * (full[k] - right);
    put(image, seen.pixel[i], c);
  }
  return image;
}
/// What a configuration says of the image.
struct Answered : Configuration {
  std::vector<float> answers;
};

class Painter {
 public:
  Painter(ShadowBlock& block, const std::vector<Method>& methods, int threads)
      : block_(block), methods_(methods), threads_(threads) {
    const auto& truth = block.truth(0).visibility;
    exact_.assign(truth.begin(), truth.end());
  }

  /// All query knobs on one build; empty where the method takes no such scene.
  std::vector<Answered> asked(std::size_t m, const Knobs& build) const {
    std::vector<Answered> out;
    try {
      const auto subject = block_.build(m, build, threads_);
      for (const Knobs& query : methods_[m].info.query_knobs) {
        try {
          subject->run(0, query, threads_);
        } catch (const Unsupported&) {
          continue;
        }
        const auto answers = ShadowBlock::answers(*subject);
        out.push_back(
            {{build, query, *block_.check(m, *subject, 0, query).error}, {answers.begin(), answers.end()}});
      }
    } catch (const std::exception&) {  // its row says why
      return {};
    }
    return out;
  }
  Image panel(const Answered& a) const {
    return ray::stacked(shares(block_.image(), a.answers),
                        errors(block_.image(), a.answers, block_.truth(0).visibility));
  }
  Image truth_panel() const { return ray::stacked(shares(block_.image(), exact_), blank(block_.image())); }

 private:
  ShadowBlock& block_;
  const std::vector<Method>& methods_;
  int threads_;
  std::vector<float> exact_;
};

/// A method's configurations, and those of them that make a strip.
struct OfMethod {
  std::string method;
  std::vector<Answered> all;
  Strip strip;
};

std::optional<OfMethod> strip_of_method(const std::string& method, std::vector<Answered> all) {
  const std::vector<Configuration> plain(all.begin(), all.end());
  auto strip = strip_of(plain);
  if (!strip || strip->change < least_change) return std::nullopt;
  return OfMethod{method, std::move(all), std::move(*strip)};
}

/// What stays as it is along a strip.
std::string fixed_of(const Answered& a, const std::string& knob) {
  Knobs all = a.build;
  all.update(a.query), all.erase(knob);
  return all.empty() ? "" : "; all with " + format_knobs(all);
}
std::string knobs_of(const Answered& a) {
  Knobs all = a.build;
  all.update(a.query);
  return all.empty() ? "" : " (" + format_knobs(all) + ")";
}

}  // namespace

void draw_pictures(const std::vector<Method>& methods, ShadowBlock& block, const std::string& dataset,
                   int threads, const std::string& folder) {
  ray::Album album("shadow", dataset, folder);
  const Painter painter(block, methods, threads);
  std::vector<Image> panels{painter.truth_panel()};
  std::string names = "the truth";
  std::vector<std::string> labels{"truth"};
  std::vector<OfMethod> strips;
  const bool all_strips = std::ranges::find(with_all_strips, dataset) != std::end(with_all_strips);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const MethodInfo& info = methods[m].info;
    if (info.hard_cases_only || !block.offers(m)) continue;
    std::vector<Answered> all = painter.asked(m, info.build_knobs.front());
    if (all.empty()) continue;
    const Answered& best = *std::ranges::min_element(all, {}, &Answered::error);
    panels.push_back(painter.panel(best));
    names += fmt::format(", {}{} {:.3g}", info.name, knobs_of(best), best.error);
    labels.push_back(fmt::format("{} {:.3g}", info.name, best.error));
    if (info.source == Source::peer) continue;
    // Of the plain map, which is soon made, every resolution.
    const std::size_t builds = info.name == "shadow_map" ? info.build_knobs.size()
                               : all_strips ? std::min(info.build_knobs.size(), info.quick_builds)
                                            : 1;
    for (std::size_t b = 1; b < builds; ++b)
      for (Answered& a : painter.asked(m, info.build_knobs[b])) all.push_back(std::move(a));
    if (auto strip = strip_of_method(info.name, std::move(all))) strips.push_back(std::move(*strip));
  }
  std::ranges::sort(strips, std::greater(), [](const OfMethod& s) { return s.strip.change; });
  if (!all_strips && strips.size() > most_strips) strips.resize(most_strips);
  for (const OfMethod& s : strips) {
    const std::string& knob = s.strip.knob;
    std::vector<Image> strip;
    std::vector<std::string> steps, named;
    for (const std::size_t k : s.strip.steps) {
      strip.push_back(painter.panel(s.all[k]));
      steps.push_back(fmt::format("{} {:.3g}", value_at(s.all[k], knob).dump(), s.all[k].error));
      named.push_back(knob + " " + steps.back());
    }
    const auto count = static_cast<int>(strip.size());
    album.add(
        s.method + "_" + knob, ray::beside(strip, count),
        {.title = fmt::format("{} by {}", s.method, knob),
         .caption = fmt::format("From left to right {} and error: {}{}. Under each where it is too light, "
                                "orange, or too dark, blue.",
                                knob, fmt::join(steps, ", "), fixed_of(s.all[s.strip.steps.front()], knob)),
         .method = s.method,
         .kind = "strip",
         .columns = count,
         .panels = named});
  }
  album.add("methods", ray::beside(panels, columns),
            {.title = "The share of the light that is seen, by every method",
             .caption = fmt::format("Row after row, each as first built, with the knobs that err least then, "
                                    "and its error: {}. Under each where it is too light, "
                                    "orange, or too dark, blue, by the root of the error; dark blue is not "
                                    "asked about.",
                                    names),
             .method = "",
             .kind = "shadow",
             .columns = std::min(columns, static_cast<int>(panels.size())),
             .panels = labels});
}

}  // namespace treeline::bench::shadow
