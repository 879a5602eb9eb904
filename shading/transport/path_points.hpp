// The numbers in [0, 1) that decide the course of a path: pair after pair, each found by itself.
//
// Problem: paths are traced by any number of threads in any order, and must be the same ones. Method: a
// number is a hash of seed, pixel, sample and place in the path (geometry/random.hpp); nothing is kept
// between two calls. Sobol-Owen: for each place in the path, the samples of a set are a net of two dimensions
// of its own, in an order of its own (Burley 2020, padding with shuffled and scrambled pairs): well spread in
// each pair, independent between pairs. Cost: one hash a pair, with Sobol points two and three scrambles
// more; the loops over many paths are such as compilers turn into vector instructions. Known weakness: pairs
// of different bounces together are no better spread than at random.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

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
      : sobol_(points == Points::sobol_owen), set_(static_cast<std::uint32_t>(set)), seed_(seed) {
    mask_ = std::bit_ceil(set_) - 1;
    if (!sobol_) return;
    for (std::uint32_t i = 0; i <= mask_; ++i)
      first_.push_back(geometry::sobol_bits(i, 0)), second_.push_back(geometry::sobol_bits(i, 1));
  }

  PathKey key(std::uint64_t pixel, std::uint64_t sample) const {
    const std::uint64_t stream = geometry::hash_u64(seed_, pixel);
    if (!sobol_) return {geometry::hash_u64(stream, sample), 0};
    return {geometry::hash_u64(stream, sample / set_), static_cast<std::uint32_t>(sample % set_)};
  }
  /// The numbers at a place in the path.
  Pair pair(const PathKey& key, std::uint32_t place) const {
    Pair p;
    pairs(1, &key.hash, &key.index, place, &p.u, &p.v);
    return p;
  }
  /// One number, in more digits than a float's.
  double number(const PathKey& key, std::uint32_t place) const {
    double x;
    numbers(1, &key.hash, &key.index, place, &x);
    return x;
  }

  /// The same for n paths.
  void pairs(std::size_t n, const std::uint64_t* hash, const std::uint32_t* index, std::uint32_t place,
             float* __restrict u, float* __restrict v) const {
    const std::uint64_t step = (std::uint64_t{place} + 1) * golden;
    if (!sobol_) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::uint64_t bits = geometry::mix_bits(hash[i] + step);
        u[i] = unit(static_cast<std::uint32_t>(bits >> 32)), v[i] = unit(static_cast<std::uint32_t>(bits));
      }
      return;
    }
    const std::uint32_t *first = first_.data(), *second = second_.data(), mask = mask_;
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint64_t bits = geometry::mix_bits(hash[i] + step),
                          scrambles = geometry::mix_bits(bits + golden);
      const std::uint32_t at = shuffled(index[i], bits, mask);
      u[i] = unit(geometry::owen_scrambled(first[at], static_cast<std::uint32_t>(scrambles >> 32)));
      v[i] = unit(geometry::owen_scrambled(second[at], static_cast<std::uint32_t>(scrambles)));
    }
  }
  void numbers(std::size_t n, const std::uint64_t* hash, const std::uint32_t* index, std::uint32_t place,
               double* __restrict x) const {
    const std::uint64_t step = (std::uint64_t{place} + 1) * golden;
    if (!sobol_) {
      for (std::size_t i = 0; i < n; ++i)
        x[i] = geometry::unit_interval<double>(geometry::mix_bits(hash[i] + step));
      return;
    }
    const std::uint32_t *first = first_.data(), mask = mask_;
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint64_t bits = geometry::mix_bits(hash[i] + step);
      const std::uint32_t at = shuffled(index[i], bits, mask);
      x[i] = geometry::owen_scrambled(first[at], static_cast<std::uint32_t>(bits >> 32)) * 0x1p-32;
    }
  }

 private:
  static constexpr std::uint64_t golden = 0x9e3779b97f4a7c15ull;

  static float unit(std::uint32_t bits) {
    return static_cast<float>(static_cast<std::int32_t>(bits >> 8)) * 0x1p-24f;
  }
  /// Aligned runs of a power of two keep together, so that each is a net.
  static std::uint32_t shuffled(std::uint32_t index, std::uint64_t bits, std::uint32_t mask) {
    return geometry::owen_scrambled(index, static_cast<std::uint32_t>(bits)) & mask;
  }

  bool sobol_;
  std::uint32_t set_, mask_;
  std::uint64_t seed_;
  std::vector<std::uint32_t> first_, second_;  // the first two Sobol dimensions
};

}  // namespace treeline::shading::transport
