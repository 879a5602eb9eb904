// What tracers may be told: how directions are drawn, how emitters are reached, when a path ends; and the
// counts of rays that they give.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "shading/material.hpp"

namespace treeline::shading::transport {

/// A scene that light cannot be carried through; says what is wrong with it and where.
struct InvalidScene : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};
/// An option out of range; names it.
struct InvalidOptions : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// How the next direction is drawn: evenly over the hemisphere, by its cosine, or as the surface reflects.
/// Mirrors and glass have but their own.
enum class Directions { uniform, cosine, bsdf };

/// How emitters are reached. `none`: a path that meets one by chance counts it. `next_event`: a point of them
/// is drawn at every surface, and one that is met by chance counts only where no point could have been drawn
/// for it (seen directly, or in mirrors and glass). `mis`: both, weighted by the power heuristic with
/// exponent 2 (Veach and Guibas 1995). The background is always met by chance.
enum class Lights { none, next_event, mis };

/// Numbers that decide: independent ones, or nets of scrambled Sobol points (path_points.hpp).
enum class Points { random, sobol_owen };

/// Probability, in (0, 1], that a path goes on from its hit number `bounce` (0 is what the camera sees);
/// `throughput` is what the rest of the path would be multiplied by, this surface included. Any rule leaves
/// the mean as it is; the variance may be infinite under a rule that ends paths sooner than their light
/// fades. Not asked at glass. Called by many threads at once.
using Survival = std::function<float(int bounce, const Rgb& throughput)>;

/// The same probability at every hit from `from_bounce` on. Throws InvalidOptions unless it is in (0, 1].
inline Survival survive_with(float probability, int from_bounce = 0) {
  if (!(probability > 0 && probability <= 1))
    throw InvalidOptions("the probability to survive is " + std::to_string(probability) +
                         "; it must be in (0, 1]");
  return [=](int bounce, const Rgb&) { return bounce < from_bounce ? 1.0f : probability; };
}

/// The largest channel of the throughput, within [least, most]: paths that carry little end early. `most`
/// below 1 ends paths among surfaces that lose nothing. Throws InvalidOptions unless
/// 0 < least <= most <= 1.
inline Survival survive_by_throughput(int from_bounce = 3, float least = 0.05f, float most = 0.95f) {
  if (!(least > 0 && least <= most && most <= 1))
    throw InvalidOptions("the probabilities to survive are from " + std::to_string(least) + " to " +
                         std::to_string(most) + "; they must be in (0, 1] and in order");
  return [=](int bounce, const Rgb& w) {
    return bounce < from_bounce ? 1.0f : std::clamp(std::max({w[0], w[1], w[2]}), least, most);
  };
}

struct PathOptions {
  Directions directions = Directions::bsdf;
  Lights lights = Lights::mis;
  Points points = Points::random;
  /// 0: what is seen emits; 1: light that was reflected once; and so on. Less than all is too dark, by what
  /// the rest would have brought.
  int max_bounces = 64;
  Survival survival = survive_by_throughput();  ///< empty: paths end at max_bounces only
  /// Of Sobol points: how many samples of a pixel share a net. Sets are independent of each other, and the
  /// film's estimate of its error rests on how they differ.
  int set = 16;
  std::uint64_t seed = 0;
};

struct RayCounts {
  std::uint64_t paths = 0, rays = 0, shadow_rays = 0;
};

/// Of the literal pseudo-code (textbook.hpp).
struct TextbookOptions {
  float survival = 0.8f;                ///< P, in (0, 1]
  bool roulette_first = false;          ///< before the light's part, which P does not divide
  bool hemisphere_half_pi = false;      ///< directions are taken to have the density 2 / π, not 1 / (2 π)
  bool drop_reflected_emitters = true;  ///< as written; false: an emitter that is met reflects, and emits not
  bool emission_seen = false;           ///< as written; true: what the camera sees emits
  int max_bounces = 64;
  std::uint64_t seed = 0;
};

/// Of Whitted's ray tracing (whitted.hpp).
struct WhittedOptions {
  int max_bounces = 5;  ///< mirrors and glass that are followed after each other
  int shadow_rays = 4;  ///< at an end
  Rgb ambient{};        ///< radiance that diffuse surfaces are taken to get from everywhere; W / (m² sr)
  std::uint64_t seed = 0;
};

/// Rays that left the hits number k of their paths.
struct BounceCounts {
  std::uint64_t reflected = 0, refracted = 0, shadow = 0;
};
struct WhittedCounts {
  std::uint64_t primary = 0;
  std::vector<BounceCounts> bounces;  ///< [0]: from what the camera sees
};

/// Throws InvalidOptions.
inline void check_options(const PathOptions& options) {
  if (options.max_bounces < 0)
    throw InvalidOptions("max_bounces is " + std::to_string(options.max_bounces) +
                         "; it must not be negative");
  if (options.set < 1 || options.set > 1 << 20)
    throw InvalidOptions("set is " + std::to_string(options.set) + "; it must be from 1 to 2^20");
}
inline void check_options(const TextbookOptions& options) {
  if (!(options.survival > 0 && options.survival <= 1))
    throw InvalidOptions("survival is " + std::to_string(options.survival) + "; it must be in (0, 1]");
  if (options.max_bounces < 0)
    throw InvalidOptions("max_bounces is " + std::to_string(options.max_bounces) +
                         "; it must not be negative");
}
inline void check_options(const WhittedOptions& options) {
  if (options.max_bounces < 0 || options.max_bounces > 20)
    throw InvalidOptions("max_bounces is " + std::to_string(options.max_bounces) +
                         "; it must be from 0 to 20");
  if (options.shadow_rays < 0 || options.shadow_rays > 1024)
    throw InvalidOptions("shadow_rays is " + std::to_string(options.shadow_rays) +
                         "; it must be from 0 to 1024");
}

}  // namespace treeline::shading::transport
