#include "bench/light_transport/pictures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/core/cells.hpp"
#include "bench/light_transport/judge.hpp"
#include "bench/light_transport/tracer.hpp"
#include "bench/ray/album.hpp"
#include "bench/ray/work_picture.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::light_transport {
namespace {

using geometry::Vec3d;
using shading::Image;
using Colour = std::array<float, 3>;

constexpr Colour too_bright{1.0f, 0.55f, 0.1f}, too_dark{0.25f, 0.6f, 1.0f};
constexpr float right = 0.1f;        // the grey of no error
constexpr double full_colour = 0.5;  // relative error
constexpr int converged_samples = 128, alone_samples = 64, strip_samples[] = {1, 4, 16, 64};
constexpr double white_quantile = 0.99;
/// The room that gets a strip; a strip of noise is large.
constexpr const char* with_strip = "cornell_box";

struct Shown {
  const char* method;
  Knobs knobs;
};
/// Each by what it lacks; those that a build or a room lacks are left out.
const std::vector<Shown>& shown() {
  static const std::vector<Shown> all{{"whitted", {{"samples", 16}, {"bounces", 5}, {"shadow_rays", 4}}},
                                      {"textbook_literal", {{"samples", 16}, {"slip", "emitters"}}},
                                      {"path_bsdf", {{"samples", 16}}},
                                      {"next_event_cosine", {{"samples", 16}}},
                                      {"mis", {{"samples", 16}}},
                                      {"mis", {{"samples", 16}, {"points", "sobol"}}}};
  return all;
}

std::vector<Vec3d> means(const Film& film) {
  std::vector<Vec3d> out;
  for (std::size_t p = 0; p < film.size(); ++p) out.push_back(film.mean(p));
  return out;
}

float srgb(float x) { return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f; }

Image errors(const Film& film, const std::vector<Vec3d>& truth) {
  Image image(film.width(), film.height(), 3);
  double mean = 0;
  for (const Vec3d& t : truth) mean += (t[0] + t[1] + t[2]) / 3 / double(truth.size());
  for (std::size_t p = 0; p < film.size(); ++p) {
    const Vec3d d = film.mean(p) - truth[p], t = truth[p];
    const double off = (d[0] + d[1] + d[2]) / 3, is = (t[0] + t[1] + t[2]) / 3;
    const double relative = std::abs(off) / std::sqrt(is * is + dark * dark * mean * mean);
    const Colour& full = off > 0 ? too_bright : too_dark;
    const auto share = static_cast<float>(std::min(1.0, relative / full_colour));
    for (std::size_t c = 0; c < 3; ++c) image.values[3 * p + c] = right + share * (full[c] - right);
  }
  return image;
}

double error_of(const Film& film, const std::vector<Vec3d>& truth) {
  std::vector<Vec3d> off = means(film);
  for (std::size_t p = 0; p < off.size(); ++p) off[p] = off[p] - truth[p];
  return relative_rms(off, truth);
}

}  // namespace

void resize(shading::Camera& camera, int pixels) {
  const double shape = double(camera.width) / double(camera.height);
  camera.height = std::max(1, int(std::lround(std::sqrt(pixels / shape))));
  camera.width = std::max(1, int(std::lround(camera.height * shape)));
}

Image displayed(const Image& radiance, float exposure) {
  Image image = radiance;
  for (float& x : image.values) x = srgb(std::clamp(x * exposure, 0.0f, 1.0f));
  return image;
}

float exposure_of(const Image& radiance) {
  std::vector<float> grey;
  for (std::size_t i = 0; i + 2 < radiance.values.size(); i += 3)
    grey.push_back((radiance.values[i] + radiance.values[i + 1] + radiance.values[i + 2]) / 3);
  if (grey.empty()) return 1;
  const auto at = [&](double share) {
    const auto k = static_cast<std::ptrdiff_t>(share * double(grey.size() - 1));
    std::ranges::nth_element(grey, grey.begin() + k);
    return grey[static_cast<std::size_t>(k)];
  };
  // Lamps may be a hundred times as bright as what they light: then the middle is what counts.
  const float white = std::min(at(white_quantile), 6 * at(0.5));
  return white > 0 ? 1 / white : 1;
}

void draw_pictures(const std::vector<Method>& methods, LitScene room, const std::string& dataset,
                   std::uint64_t seed, int pixels, int threads, const std::string& folder) {
  ray::Album album("light_transport", dataset, folder);
  const auto converged = [&](int samples) {
    const auto tracer = mis_tracer(room, geometry::hash_u64(seed, 7), samples);
    Film film = tracer->film();
    tracer->add(film, samples, threads);
    return film;
  };
  resize(room.camera, 4 * pixels);
  const Film alone = converged(alone_samples);
  const float exposure = exposure_of(alone.image());
  album.add("converged", displayed(alone.image(), exposure),
            {.title = "Converged",
             .caption = fmt::format("By mis with {} scrambled Sobol points a pixel; {} x {} pixels.",
                                    alone_samples, alone.width(), alone.height()),
             .method = "",
             .kind = "converged"});

  resize(room.camera, pixels);
  const Film film = converged(converged_samples);
  const std::vector<Vec3d> truth = means(film);
  Image blank(film.width(), film.height(), 3);
  std::ranges::fill(blank.values, right);
  std::vector<Image> panels{ray::stacked(displayed(film.image(), exposure), blank)}, strip;
  std::string names = fmt::format("converged ({} samples)", converged_samples);
  std::vector<std::string> labels{"converged"}, steps, named;
  const auto panel = [&](const Film& f) {
    return ray::stacked(displayed(f.image(), exposure), errors(f, truth));
  };
  const auto find = [&](const std::string& name) {
    return std::ranges::find_if(methods, [&](const Method& m) { return m.info.name == name; });
  };
  const auto render = [&](const Method& m, const Knobs& knobs) {
    Traced traced;
    return m.build({room, threads, seed}, m.info.build_knobs.front())
        ->render({film.width(), film.height(), {}}, knobs, threads, traced);
  };
  for (const Shown& s : shown()) {
    const auto m = find(s.method);
    if (m == methods.end()) continue;
    const Film f = render(*m, s.knobs);
    panels.push_back(panel(f));
    names += fmt::format(", {} ({}) {:.3g}", s.method, format_knobs(s.knobs), error_of(f, truth));
    labels.push_back(fmt::format("{} {:.3g}", s.method, error_of(f, truth)));
  }
  const std::string key =
      "Under each where it is too bright, orange, or too dark, blue, full colour at half of "
      "the radiance.";
  album.add(
      "methods", ray::beside(panels, static_cast<int>(panels.size())),
      {.title = "Noisy, converged, and the error",
       .caption = fmt::format("From left to right, each with its relative RMS error: {}. {}", names, key),
       .method = "",
       .kind = "light",
       .columns = static_cast<int>(panels.size()),
       .panels = labels});
  if (const auto mis = find("mis"); mis != methods.end() && dataset == with_strip) {
    for (const int samples : strip_samples) {
      const Film f = render(*mis, {{"samples", samples}});
      strip.push_back(panel(f));
      steps.push_back(fmt::format("{} {:.3g}", samples, error_of(f, truth)));
      named.push_back("samples " + steps.back());
    }
    album.add(
        "mis_samples", ray::beside(strip, static_cast<int>(strip.size())),
        {.title = "mis by samples",
         .caption = fmt::format("From left to right samples and error: {}. {}", fmt::join(steps, ", "), key),
         .method = "mis",
         .kind = "strip",
         .columns = static_cast<int>(strip.size()),
         .panels = named});
  }
}

}  // namespace treeline::bench::light_transport
