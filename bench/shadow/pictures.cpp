#include "bench/shadow/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>

#include "bench/core/cells.hpp"
#include "bench/ray/png.hpp"
#include "bench/ray/work_picture.hpp"

namespace treeline::bench::shadow {
namespace {

using shading::Image;
using Colour = std::array<float, 3>;

constexpr int columns = 6;  // of panels
constexpr Colour not_asked{0.17f, 0.2f, 0.3f}, too_light{1.0f, 0.55f, 0.1f}, too_dark{0.25f, 0.6f, 1.0f};
constexpr float right = 0.1f;           // the grey of no error
constexpr double shown = 0.5;           // the power of errors that is: most are small
constexpr std::size_t least_steps = 3;  // of a strip
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
Image stacked(const Image& above, const Image& below) {
  Image image(above.width, above.height + below.height, 3);
  std::ranges::copy(above.values, image.values.begin());
  std::ranges::copy(below.values, image.values.begin() + std::ptrdiff_t(above.values.size()));
  return image;
}

/// What a configuration says of the image.
struct Answered {
  Knobs build, query;
  std::vector<float> answers;
  double error = 0;
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
        Answered a{
            build, query, {answers.begin(), answers.end()}, *block_.check(m, *subject, 0, query).error};
        out.push_back(std::move(a));
      }
    } catch (const std::exception&) {  // its row says why
      return {};
    }
    return out;
  }
  Image panel(const Answered& a) const {
    return stacked(shares(block_.image(), a.answers),
                   errors(block_.image(), a.answers, block_.truth(0).visibility));
  }
  Image truth_panel() const { return stacked(shares(block_.image(), exact_), blank(block_.image())); }

 private:
  ShadowBlock& block_;
  const std::vector<Method>& methods_;
  int threads_;
  std::vector<float> exact_;
};

/// A knob and the configurations that differ in nothing else, from its least to its most: the longest such
/// run.
std::pair<std::string, std::vector<const Answered*>> strip_of(const std::vector<Answered>& all) {
  std::pair<std::string, std::vector<const Answered*>> best;
  const auto try_knob = [&](const std::string& knob, Knobs Answered::*where) {
    std::map<std::string, std::vector<const Answered*>> runs;
    for (const Answered& a : all) {
      const Knobs& knobs = a.*where;
      if (!knobs.contains(knob) || !knobs.at(knob).is_number()) continue;
      Answered rest{a.build, a.query, {}, 0};
      (rest.*where).erase(knob);
      runs[rest.build.dump() + rest.query.dump()].push_back(&a);
    }
    for (auto& [rest, run] : runs) {
      if (run.size() <= best.second.size()) continue;
      std::ranges::sort(run, {},
                        [&](const Answered* a) { return (a->*where).at(knob).template get<double>(); });
      best = {knob, run};
    }
  };
  for (const Answered& a : all) {
    for (const auto& [knob, value] : a.query.items()) try_knob(knob, &Answered::query);
    for (const auto& [knob, value] : a.build.items()) try_knob(knob, &Answered::build);
  }
  return best;
}

/// The configurations of a method, and those of them that make a strip.
struct Strip {
  std::string method, knob;
  std::vector<Answered> all;
  std::vector<const Answered*> run;
  double change = 0;  // of the error, from the worst step to the best
};

std::optional<Strip> strip_of_method(const std::string& method, std::vector<Answered> all) {
  Strip s{method, {}, std::move(all), {}, 0};
  std::tie(s.knob, s.run) = strip_of(s.all);
  if (s.run.size() < least_steps) return std::nullopt;
  const auto [least, most] = std::ranges::minmax(s.run, {}, &Answered::error);
  s.change = most->error - least->error;
  return s.change >= least_change ? std::optional(std::move(s)) : std::nullopt;
}

/// As a part of a file's name: a light's description is made of more than that takes.
std::string for_file(std::string name) {
  constexpr std::string_view kept = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._+-,";
  for (char& c : name)
    if (kept.find(c) == kept.npos) c = '_';
  return name;
}

std::string knobs_of(const Answered& a) {
  Knobs all = a.build;
  all.update(a.query);
  return all.empty() ? "" : " (" + format_knobs(all) + ")";
}

}  // namespace

void draw_pictures(const std::vector<Method>& methods, ShadowBlock& block, const std::string& dataset,
                   int threads, const std::string& folder) {
  const std::filesystem::path root(folder);
  std::filesystem::create_directories(root);
  // Drawn again, the pictures of this dataset take the place of the earlier ones.
  std::string lines;
  {
    std::ifstream in(root / "pictures.jsonl");
    for (std::string line; std::getline(in, line);)
      if (line.find("\"dataset\":\"" + dataset + "\"") == std::string::npos) lines += line + '\n';
  }
  const auto add = [&](const std::string& what, const Image& image, const std::string& title,
                       const std::string& caption, const std::string& method, const std::string& kind) {
    const std::string file = "shadow_" + for_file(dataset) + "_" + what + ".png";
    if (!ray::write_png((root / file).string(), image)) return;
    lines += nlohmann::ordered_json{{"task", "shadow"},   {"file", file},       {"title", title},
                                    {"caption", caption}, {"dataset", dataset}, {"method", method},
                                    {"kind", kind}}
                 .dump() +
             '\n';
  };

  const Painter painter(block, methods, threads);
  std::vector<Image> panels{painter.truth_panel()};
  std::string names = "the truth";
  std::vector<Strip> strips;
  const bool all_strips = std::ranges::find(with_all_strips, dataset) != std::end(with_all_strips);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const MethodInfo& info = methods[m].info;
    if (info.hard_cases_only || !block.offers(m)) continue;
    std::vector<Answered> all = painter.asked(m, info.build_knobs.front());
    if (all.empty()) continue;
    const Answered& best = *std::ranges::min_element(all, {}, &Answered::error);
    panels.push_back(painter.panel(best));
    names += fmt::format(", {}{} {:.3g}", info.name, knobs_of(best), best.error);
    if (info.source == Source::peer) continue;
    // Of the plain map, which is soon made, every resolution.
    const std::size_t builds = info.name == "shadow_map" ? info.build_knobs.size()
                               : all_strips ? std::min(info.build_knobs.size(), info.quick_builds)
                                            : 1;
    for (std::size_t b = 1; b < builds; ++b)
      for (Answered& a : painter.asked(m, info.build_knobs[b])) all.push_back(std::move(a));
    if (auto strip = strip_of_method(info.name, std::move(all))) strips.push_back(std::move(*strip));
  }
  std::ranges::sort(strips, std::greater(), &Strip::change);
  if (!all_strips && strips.size() > most_strips) strips.resize(most_strips);
  for (const Strip& s : strips) {
    std::vector<Image> strip;
    std::string steps;
    for (const Answered* a : s.run) {
      strip.push_back(painter.panel(*a));
      Knobs both = a->build;
      both.update(a->query);
      steps += fmt::format("{}{} {:.3g}", steps.empty() ? "" : ", ", both.at(s.knob).dump(), a->error);
    }
    add(s.method + "_" + s.knob, ray::beside(strip, static_cast<int>(strip.size())),
        fmt::format("{} by {}", s.method, s.knob),
        fmt::format("From left to right {} and error: {}. Under each where it is too light, orange, or too "
                    "dark, blue.",
                    s.knob, steps),
        s.method, "strip");
  }
  add("methods", ray::beside(panels, columns), "The share of the light that is seen, by every method",
      fmt::format("Row after row, each with its error: {}. Under each where it is too light, orange, or too "
                  "dark, blue, "
                  "by the root of the error; dark blue is not asked about.",
                  names),
      "", "shadow");
  std::ofstream index(root / "pictures.jsonl");
  index << lines;
  if (!index) throw std::runtime_error(folder + "/pictures.jsonl cannot be written");
}

}  // namespace treeline::bench::shadow
