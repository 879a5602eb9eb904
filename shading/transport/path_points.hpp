// The numbers in [0, 1) that decide the course of a path: pair after pair, each found by itself.
//
// Problem: paths are traced by any number of threads in any order, and must be the same ones. Method: a
// number is a hash of seed, pixel, sample and place in the path (geometry/random.hpp); nothing is kept
// between two calls. Sobol-Owen: for each place in the path, the samples of a set are a net of two dimensions
// of its own, in an order of its own (Burley 2020, padding with shuffled and scrambled pairs): well spread in
// each pair, independent between pairs. Cost: one hash a pair, with Sobol points two and four bit reversals
// more. Known weakness: pairs of different bounces together are no better spread than at random.
#pragma once

#include <bit>
#include <cstdint>

#include "geometry/random.hpp"
#include "geometry/sobol.hpp"
#include "shading/transport/options.hpp"

namespace treeline::shading::transport {

struct Pair {
  float u, v;
};

/// Of one path.
struct PathKey {
  std::uint64_t hash;   // of seed, pixel and sample; of Sobol points, the set in place of the sample
  std::uint32_t index;  // of the sample in its set
};

class PathPoints {
 public:
  PathPoints(Points points, int set, std::uint64_t seed)
      : points_(points), set_(static_cast<std::uint32_t>(set)), mask_(std::bit_ceil(set_) - 1), seed_(seed) {}

  PathKey key(std::uint64_t pixel, std::uint64_t sample) const {
    const std::uint64_t stream = geometry::hash_u64(seed_, pixel);
    if (points_ == Points::random) return {geometry::hash_u64(stream, sample), 0};
    return {geometry::hash_u64(stream, sample / set_), static_cast<std::uint32_t>(sample % set_)};
  }
  /// The numbers at a place in the path.
  Pair pair(const PathKey& key, std::uint32_t place) const {
    const std::uint64_t bits = bits_at(key, place);
    if (points_ == Points::random) return {unit(bits >> 32), unit(bits & 0xffffffffu)};
    const std::uint32_t i = shuffled(key, bits);
    const std::uint64_t scrambles = geometry::mix_bits(bits + golden);
    return {unit(geometry::owen_scrambled(geometry::sobol_bits(i, 0), static_cast<std::uint32_t>(scrambles))),
            unit(geometry::owen_scrambled(geometry::sobol_bits(i, 1),
                                          static_cast<std::uint32_t>(scrambles >> 32)))};
  }
  /// One number, in more digits than a float's.
  double number(const PathKey& key, std::uint32_t place) const {
    const std::uint64_t bits = bits_at(key, place);
    if (points_ == Points::random) return geometry::unit_interval<double>(bits);
    const std::uint32_t i = shuffled(key, bits);
    return geometry::owen_scrambled(geometry::sobol_bits(i, 0), static_cast<std::uint32_t>(bits >> 32)) *
           0x1p-32;
  }

 private:
  static constexpr std::uint64_t golden = 0x9e3779b97f4a7c15ull;

  static std::uint64_t bits_at(const PathKey& key, std::uint32_t place) {
    return geometry::mix_bits(key.hash + (std::uint64_t{place} + 1) * golden);
  }
  static float unit(std::uint64_t bits32) { return static_cast<float>(bits32 >> 8) * 0x1p-24f; }
  /// Aligned runs of a power of two keep together, so that each is a net.
  std::uint32_t shuffled(const PathKey& key, std::uint64_t bits) const {
    return geometry::owen_scrambled(key.index, static_cast<std::uint32_t>(bits)) & mask_;
  }

  Points points_;
  std::uint32_t set_, mask_;
  std::uint64_t seed_;
};

}  // namespace treeline::shading::transport
