#include "bench/region_average/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "bench/core/cells.hpp"
#include "bench/region_average/truth.hpp"
#include "datasets_gen/files/write.hpp"

namespace treeline::bench::region_average {
namespace {

namespace texture = shading::texture;

constexpr double full_red = 0.1;  // error, in the range of the texture
constexpr int gap = 4;            // between panels, in pixels

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

float eight_bits(double x) {
  return std::floor(static_cast<float>(std::clamp(x, 0.0, 1.0)) * 255 + 0.5f) / 255.0f;
}

/// Panels of one size side by side on white.
class Panels {
 public:
  Panels(int width, int height, int count)
      : width_(width), image_(count * width + (count - 1) * gap, height, 3, 1.0f) {}

  /// colour(x, y, c) of the next panel.
  template <class Colour>
  void add(const Colour& colour) {
    for (int y = 0; y < image_.height; ++y)
      for (int x = 0; x < width_; ++x)
        for (int c = 0; c < 3; ++c) image_(at_ + x, y, c) = eight_bits(colour(x, y, c));
    at_ += width_ + gap;
  }
  const Image& image() const { return image_; }

 private:
  int width_, at_ = 0;
  Image image_;
};

/// White where there is no error, orange where the answer is too bright, blue where it is too dark.
double error_colour(double error, int channel) {
  const double share = std::min(1.0, std::abs(error) / full_red);
  static constexpr double bright[3] = {0.84, 0.37, 0.0}, dark[3] = {0.0, 0.45, 0.7};
  return 1 + share * ((error > 0 ? bright[channel] : dark[channel]) - 1);
}

struct Shown {
  const char* method;
  Knobs knobs;
};
/// What tells most; those that a build lacks are left out.
const std::vector<Shown>& shown() {
  static const std::vector<Shown> all{{"nearest", Knobs::object()},          {"mip_square", {{"bias", 0}}},
                                      {"mip_square", {{"bias", -0.79}}},     {"mip_probes", {{"side", 4}}},
                                      {"mip_anisotropic", {{"probes", 16}}}, {"sat_uint32", Knobs::object()}};
  return all;
}

}  // namespace

void write_pictures(const std::vector<Method>& methods, const datasets::Dataset& dataset,
                    const std::string& folder) {
  const Image& image = dataset.image;
  const std::pair<const char*, Footprint> kinds[] = {
      {"square of 12 texels", texture::box_footprint({0, 0, 12, 12})},
      {"oblong of 24 x 4", texture::box_footprint({0, 0, 24, 4})},
      {"box of 24 x 4, turned", texture::rotated_box(0, 0, 12, 2, 0.6)}};
  int number = 0;
  for (const auto& [words, one] : kinds) {
    const auto asked = everywhere(image, one);
    const auto truth = true_means(image, asked, 1);
    const auto channels = static_cast<std::size_t>(image.channels);
    const auto value = [&](int x, int y, int c) {
      const std::size_t channel = image.channels >= 3 ? static_cast<std::size_t>(c) : 0;
      return (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
              static_cast<std::size_t>(x)) *
                 channels +
             channel;
    };
    for (const Shown& show : shown()) {
      const auto m = std::ranges::find_if(
          methods, [&](const Method& method) { return method.info.name == show.method; });
      if (m == methods.end()) continue;
      const auto averager = m->build({image, 1}, m->info.build_knobs.front());
      std::vector<float> means(truth.size());
      averager->means(asked, show.knobs, 1, means);
      double squares = 0;
      for (std::size_t i = 0; i < truth.size(); ++i)
        squares += (double(means[i]) - truth[i]) * (double(means[i]) - truth[i]);
      char figure[32];
      std::snprintf(figure, sizeof figure, "%.2g", std::sqrt(squares / double(truth.size())));
      Panels panels(image.width, image.height, 4);
      panels.add([&](int x, int y, int c) { return double(image.values[value(x, y, c)]); });
      panels.add([&](int x, int y, int c) { return truth[value(x, y, c)]; });
      panels.add([&](int x, int y, int c) { return double(means[value(x, y, c)]); });
      panels.add([&](int x, int y, int c) {
        return error_colour(double(means[value(x, y, 0)]) - truth[value(x, y, 0)], c);
      });
      datasets::Dataset picture;
      picture.kind = datasets::Kind::image, picture.image = panels.image();
      const std::string file = dataset.name + "_" + std::to_string(number++) + ".png";
      try {
        datasets::write(picture, std::filesystem::path(folder) / file, true);
      } catch (const datasets::FileError& e) {
        if (e.problem.find("built without") != std::string::npos) return;
        throw;
      }
      const std::string knobs = format_knobs(show.knobs);
      const Knobs entry{{"file", file},
                        {"title", dataset.name + ", " + words + ": " + show.method +
                                      (knobs == "-" ? "" : " (" + knobs + ")") + ", error " + figure +
                                      ". The texture, its true means, those told, and the difference: "
                                      "orange too bright, blue too dark, full colour at 0.1"},
                        {"dataset", dataset.name},
                        {"method", show.method},
                        {"kind", "filtered"}};
      std::ofstream index(std::filesystem::path(folder) / "pictures.jsonl", std::ios::app);
      index << entry.dump() << '\n' << std::flush;
      if (!index) throw std::runtime_error(folder + "/pictures.jsonl cannot be written");
    }
  }
}

}  // namespace treeline::bench::region_average
