// Where in a filter samples are taken: fixed patterns over the unit disc and the square [-1, 1]², and what
// turns them from one receiver to the next.
//
// The disc's spiral puts sample i at radius sqrt((i + 1/2) / n), a golden angle further each (Vogel 1979).
// Poisson samples are Mitchell's best candidates (1991). The square's are the first n of the R2 sequence
// (Roberts 2018), which adds powers of the reciprocal of the plastic number.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "geometry/random.hpp"
#include "shading/shadow/bias.hpp"

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

/// How a receiver's pattern lies in the map: turned by an angle of its own (disc) or shifted around the
/// borders (square), then stretched along two axes. 64 fixed angles save the sines.
struct TapFrame {
  float shift_x = 0, shift_y = 0;        ///< in [0, 2)
  float xx = 1, xy = 0, yx = 0, yy = 1;  ///< map = (xx xy; yx yy) · pattern

  /// `u` and `v`: where the pattern's axes lie in the map.
  TapFrame(bool disc, bool turned, std::uint32_t hash, const Tap& u, const Tap& v) {
    Tap c{1, 0};
    if (turned && disc) c = angles()[hash & 63];
    if (turned && !disc) shift_x = float(hash & 0xffff) * 0x1p-15f, shift_y = float(hash >> 16) * 0x1p-15f;
    xx = u.x * c.x + v.x * c.y, xy = v.x * c.x - u.x * c.y;
    yx = u.y * c.x + v.y * c.y, yy = v.y * c.x - u.y * c.y;
  }
  Tap operator()(const Tap& t) const {
    float x = t.x + shift_x, y = t.y + shift_y;
    x = x > 1 ? x - 2 : x, y = y > 1 ? y - 2 : y;
    return {xx * x + xy * y, yx * x + yy * y};
  }

 private:
  static const Tap* angles() {
    static const std::vector<Tap> turns = [] {
      std::vector<Tap> r;
      for (int i = 0; i < 64; ++i)
        r.push_back({float(std::cos(i * std::numbers::pi / 32)), float(std::sin(i * std::numbers::pi / 32))});
      return r;
    }();
    return turns.data();
  }
};

/// What taps found: how many of them shadow the point, and the sum of their depths.
struct Found {
  int blockers = 0;
  float depths = 0;
};

/// Compares all taps, 16 at a time, so that compilers make registers of them; the order of the sum is the
/// same on every machine. There is light outside the map.
inline Found compare_taps(const DepthMap& map, const MapPoint& m, const std::vector<Tap>& set,
                          const TapFrame& frame) {
  constexpr std::size_t lanes = 16;
  const float width = float(map.width), height = float(map.height), mx = float(m.x), my = float(m.y);
  const float* depths = map.first.data();
  int blockers[lanes]{};
  float sums[lanes]{};
  for (std::size_t begin = 0; begin < set.size(); begin += lanes) {
    float tx[lanes], ty[lanes];
    for (std::size_t k = 0; k < lanes; ++k) {
      const Tap& t = set[std::min(begin + k, set.size() - 1)];
      tx[k] = t.x, ty[k] = t.y;
    }
    const int here = int(set.size() - begin);
    for (std::size_t k = 0; k < lanes; ++k) {
      const Tap q = frame({tx[k], ty[k]});
      const float fx = std::floor(m.fx + q.x), fy = std::floor(m.fy + q.y), x = mx + fx, y = my + fy;
      const bool counts = (x >= 0) & (y >= 0) & (x < width) & (y < height) & (int(k) < here);
      const int column = int(std::min(std::max(x, 0.0f), width - 1));
      const int row = int(std::min(std::max(y, 0.0f), height - 1));
      const float z = depths[row * map.width + column];
      const bool blocks = counts & !m.lit(z, fx + 0.5f - m.fx, fy + 0.5f - m.fy);
      blockers[k] += blocks;
      sums[k] += blocks ? z : 0.0f;
    }
  }
  Found r;
  for (std::size_t k = 0; k < lanes; ++k) r.blockers += blockers[k], r.depths += sums[k];
  return r;
}

}  // namespace detail
}  // namespace treeline::shading::shadow
