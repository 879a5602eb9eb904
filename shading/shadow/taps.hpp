// Where in a filter samples are taken: fixed patterns over the unit disc and the square [-1, 1]², and what
// turns them from one receiver to the next.
//
// The disc's spiral puts sample i at radius sqrt((i + 1/2) / n), a golden angle further each (Vogel 1979).
// Poisson samples are Mitchell's best candidates (1991). The square's are the first n of the R2 sequence
// (Roberts 2018), which adds powers of the reciprocal of the plastic number.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "geometry/random.hpp"
#include "shading/shadow/method.hpp"

namespace treeline::shading::shadow {

enum class TapPattern {
  spiral,   ///< disc
  poisson,  ///< disc
  square    ///< of half side 1
};

struct Tap {
  float x, y;
};

/// n of them; the same each time. Throws InvalidScene for n outside [1, 4096].
inline std::vector<Tap> taps(TapPattern pattern, int n) {
  detail::check_knob("taps", n, 1, 4096);
  std::vector<Tap> r;
  r.reserve(std::size_t(n));
  geometry::Pcg32 random(7);
  for (int i = 0; i < n; ++i) {
    if (pattern == TapPattern::square) {
      constexpr double a = 0.7548776662466927, b = 0.5698402909980532;
      const double x = 0.5 + a * i, y = 0.5 + b * i;
      r.push_back({float(2 * (x - std::floor(x)) - 1), float(2 * (y - std::floor(y)) - 1)});
    } else if (pattern == TapPattern::spiral) {
      const double radius = std::sqrt((i + 0.5) / n), angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
      r.push_back({float(radius * std::cos(angle)), float(radius * std::sin(angle))});
    } else {
      Tap best{};
      float farthest = -1;
      for (int candidate = 0; candidate < 10 * (i + 1) && candidate < 500; ++candidate) {
        const double radius = std::sqrt(random.uniform(0.0, 1.0)),
                     angle = random.uniform(0.0, 2 * std::numbers::pi);
        const Tap c{float(radius * std::cos(angle)), float(radius * std::sin(angle))};
        float nearest = 4;
        for (const Tap& t : r)
          nearest = std::min(nearest, (t.x - c.x) * (t.x - c.x) + (t.y - c.y) * (t.y - c.y));
        if (nearest > farthest) farthest = nearest, best = c;
      }
      r.push_back(best);
    }
  }
  return r;
}

namespace detail {

/// Bits that differ between neighbouring receivers and are the same each time.
inline std::uint32_t receiver_hash(float x, float y) {
  std::uint32_t h =
      std::bit_cast<std::uint32_t>(x) * 0x9e3779b1u ^ std::bit_cast<std::uint32_t>(y) * 0x85ebca77u;
  h ^= h >> 15, h *= 0x2c1b3c6du, h ^= h >> 12, h *= 0x297a2d39u, h ^= h >> 15;
  return h;
}

/// Turns a pattern, each receiver by its own angle (disc) or by a shift around the borders (square). As 64
/// fixed turns, to save the sines.
class Turn {
 public:
  Turn(bool disc, bool wanted, std::uint32_t hash) : disc_(disc) {
    if (!wanted) return;
    if (disc) {
      const Tap& t = table()[hash & 63];
      c_ = t.x, s_ = t.y;
    } else {
      x_ = float(hash & 0xffff) * 0x1p-16f, y_ = float(hash >> 16) * 0x1p-16f;
    }
  }
  Tap operator()(Tap t) const {
    if (disc_) return {c_ * t.x - s_ * t.y, s_ * t.x + c_ * t.y};
    const float x = t.x + 2 * x_, y = t.y + 2 * y_;
    return {x > 1 ? x - 2 : x, y > 1 ? y - 2 : y};
  }

 private:
  static const Tap* table() {
    static const std::vector<Tap> turns = [] {
      std::vector<Tap> r;
      for (int i = 0; i < 64; ++i)
        r.push_back({float(std::cos(i * std::numbers::pi / 32)), float(std::sin(i * std::numbers::pi / 32))});
      return r;
    }();
    return turns.data();
  }
  bool disc_;
  float c_ = 1, s_ = 0, x_ = 0, y_ = 0;
};

}  // namespace detail
}  // namespace treeline::shading::shadow
