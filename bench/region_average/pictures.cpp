#include "bench/region_average/pictures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "bench/core/cells.hpp"
#include "bench/core/strip.hpp"
#include "bench/ray/album.hpp"
#include "bench/ray/work_picture.hpp"
#include "bench/region_average/truth.hpp"

namespace treeline::bench::region_average {
namespace {

namespace texture = shading::texture;

constexpr int columns = 7;               // of panels
constexpr double full_colour = 0.1;      // error, in the range of the texture
constexpr double least_change = 0.0005;  // of a strip's error, or its knob does not matter

/// At every pixel of the texture.
std::vector<Footprint> everywhere(const Image& image, const Footprint& one) {
  std::vector<Footprint> r;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      r.push_back(one);
      r.back().x = x + 0.5, r.back().y = y + 0.5;
    }
  return r;
}

/// White where there is no error, orange where the answer is too bright, blue where it is too dark.
float error_colour(double error, int channel) {
  const double share = std::min(1.0, std::abs(error) / full_colour);
  static constexpr double bright[3] = {0.84, 0.37, 0.0}, dark[3] = {0.0, 0.45, 0.7};
  return static_cast<float>(1 + share * ((error > 0 ? bright[channel] : dark[channel]) - 1));
}

struct Answered : Configuration {
  std::vector<float> means;
};

/// One texture under one footprint.
class Painter {
 public:
  Painter(const Image& image, const Footprint& one)
      : image_(image), asked_(everywhere(image, one)), truth_(true_means(image, asked_, 1)) {}

  /// By a method's first build; empty where it takes no such footprint.
  std::vector<Answered> asked(const Method& method) const {
    std::vector<Answered> out;
    const Knobs& build = method.info.build_knobs.front();
    try {
      const auto averager = method.build({image_, 1}, build);
      for (const Knobs& query : method.info.query_knobs) {
        Answered a{{build, query}, std::vector<float>(truth_.size())};
        averager->means(asked_, query, 1, a.means);
        double squares = 0;
        for (std::size_t i = 0; i < truth_.size(); ++i)
          squares += (double(a.means[i]) - truth_[i]) * (double(a.means[i]) - truth_[i]);
        a.error = std::sqrt(squares / double(truth_.size()));
        out.push_back(std::move(a));
      }
    } catch (const std::exception&) {  // its row says why
      return {};
    }
    return out;
  }
  Image texture_over_truth() const {
    return ray::stacked(drawn([&](std::size_t i) { return image_.values[i]; }),
                        drawn([&](std::size_t i) { return static_cast<float>(truth_[i]); }));
  }
  Image panel(const Answered& a) const {
    Image errors(image_.width, image_.height, 3);
    for (int y = 0; y < image_.height; ++y)
      for (int x = 0; x < image_.width; ++x)
        for (int c = 0; c < 3; ++c) {
          const std::size_t i = image_.index(x, y);  // the first channel tells
          errors(x, y, c) = error_colour(double(a.means[i]) - truth_[i], c);
        }
    return ray::stacked(drawn([&](std::size_t i) { return a.means[i]; }), errors);
  }

 private:
  template <class Value>
  Image drawn(const Value& value) const {
    Image out(image_.width, image_.height, 3);
    for (int y = 0; y < image_.height; ++y)
      for (int x = 0; x < image_.width; ++x)
        for (int c = 0; c < 3; ++c)
          out(x, y, c) = std::clamp(value(image_.index(x, y, image_.channels >= 3 ? c : 0)), 0.0f, 1.0f);
    return out;
  }

  const Image& image_;
  std::vector<Footprint> asked_;
  std::vector<double> truth_;
};

constexpr const char* key =
    "Under each the difference of the first channel: orange too bright, blue too dark, "
    "full colour at 0.1, white where there is none.";

/// A method's strip under the footprint that its knob matters most to.
struct Shown {
  double change = least_change;
  ray::Words words;
  std::string file;
  std::vector<Image> panels;
};

void take_strip(const Painter& painter, const std::string& name, const std::vector<Answered>& all,
                const std::string& words, Shown& shown) {
  const auto strip = strip_of(std::vector<Configuration>(all.begin(), all.end()), 2);
  if (!strip || strip->change < shown.change) return;
  shown = {.change = strip->change, .words = {}, .file = name + "_" + strip->knob, .panels = {}};
  std::vector<std::string> steps, labels;
  for (const std::size_t k : strip->steps) {
    shown.panels.push_back(painter.panel(all[k]));
    steps.push_back(fmt::format("{} {:.2g}", value_at(all[k], strip->knob).dump(), all[k].error));
    labels.push_back(strip->knob + " " + steps.back());
  }
  shown.words = {.title = fmt::format("{} by {}, {}", name, strip->knob, words),
                 .caption = fmt::format("From left to right {} and RMS error: {}. {}", strip->knob,
                                        fmt::join(steps, ", "), key),
                 .method = name,
                 .kind = "strip",
                 .columns = static_cast<int>(shown.panels.size()),
                 .panels = labels};
}

}  // namespace

void write_pictures(const std::vector<Method>& methods, const datasets::Dataset& dataset,
                    const std::string& folder) {
  struct Kind {
    const char *words, *file;
    Footprint one;
  };
  const Kind kinds[] = {{"squares of 12 texels", "square", texture::box_footprint({0, 0, 12, 12})},
                        {"oblongs of 24 x 4", "oblong", texture::box_footprint({0, 0, 24, 4})},
                        {"boxes of 24 x 4, turned", "turned", texture::rotated_box(0, 0, 12, 2, 0.6)}};
  ray::Album album("region_average", dataset.name, folder);
  std::vector<Shown> strips(methods.size());
  for (const auto& [words, file, one] : kinds) {
    const Painter painter(dataset.image, one);
    std::vector<Image> panels{painter.texture_over_truth()};
    std::vector<std::string> labels{"texture, truth"}, names;
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const Method& method = methods[m];
      const std::string& name = method.info.name;
      const std::vector<Answered> all = painter.asked(method);
      if (all.empty()) continue;
      const Answered& best = *std::ranges::min_element(all, {}, &Answered::error);
      panels.push_back(painter.panel(best));
      const std::string knobs = format_knobs(best.query);
      names.push_back(fmt::format("{}{} {:.2g}", name, knobs == "-" ? "" : " (" + knobs + ")", best.error));
      labels.push_back(fmt::format("{} {:.2g}", name, best.error));
      if (method.info.source == Source::ours) take_strip(painter, name, all, words, strips[m]);
    }
    album.add(
        file, ray::beside(panels, columns),
        {.title = fmt::format("Means of {} by every method", words),
         .caption = fmt::format("First the texture over its true means, then by method and RMS error, each "
                                "with the knobs that err least: {}. {}",
                                fmt::join(names, ", "), key),
         .method = "",
         .kind = "filtered",
         .columns = std::min(columns, static_cast<int>(panels.size())),
         .panels = labels});
  }
  for (const Shown& strip : strips)
    if (!strip.panels.empty())
      album.add(strip.file, ray::beside(strip.panels, strip.words.columns), strip.words);
}

}  // namespace treeline::bench::region_average
