// Random numbers: a small sequential generator, and a hash that gives the i-th number of a stream directly.
//
// Sources: O'Neill 2014, PCG-XSH-RR 64/32; Steele, Lea and Flood 2014, SplitMix64 (its finaliser as the
// hash). The same seed gives the same numbers on every machine. The hash needs no state, so work split over
// any number of threads draws the same numbers. Not for cryptography.
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace treeline::geometry {

/// Bits to a number in [0, 1), evenly spaced: never 1, which float(uniform<double>()) could round to.
template <class T = double>
constexpr T unit_interval(std::uint64_t bits) {
  if constexpr (std::is_same_v<T, float>)
    return static_cast<float>(bits >> 40) * 0x1p-24f;
  else
    return static_cast<T>(bits >> 11) * T(0x1p-53);
}

class Pcg32 {
 public:
  explicit constexpr Pcg32(std::uint64_t seed = 0, std::uint64_t stream = 0) : increment_((stream << 1) | 1) {
    next();
    state_ += seed;
    next();
  }

  constexpr std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ull + increment_;
    const auto mixed = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto turn = static_cast<std::uint32_t>(old >> 59);
    return (mixed >> turn) | (mixed << ((32 - turn) & 31));
  }
  constexpr std::uint64_t next64() {
    const std::uint64_t high = next();
    return high << 32 | next();
  }
  /// In [0, 1). Ask for uniform<float>() where a float is wanted: a double just below 1 would round to 1.
  template <class T = double>
  constexpr T uniform() {
    return unit_interval<T>(next64());
  }
  template <std::floating_point T>
  constexpr T uniform(T low, T high) {
    return low + (high - low) * uniform<T>();
  }
  /// In [0, n), without bias; n > 0 (Lemire 2019).
  constexpr std::uint32_t below(std::uint32_t n) {
    std::uint64_t m = std::uint64_t{next()} * n;
    if (static_cast<std::uint32_t>(m) < n) {
      const std::uint32_t threshold = (0u - n) % n;
      while (static_cast<std::uint32_t>(m) < threshold) m = std::uint64_t{next()} * n;
    }
    return static_cast<std::uint32_t>(m >> 32);
  }

  // A standard uniform random bit generator, for std::shuffle and the like.
  using result_type = std::uint32_t;
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return 0xffffffffu; }
  constexpr result_type operator()() { return next(); }

 private:
  std::uint64_t state_ = 0, increment_;
};

constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// The index-th 64-bit number of the stream called seed.
constexpr std::uint64_t hash_u64(std::uint64_t seed, std::uint64_t index) {
  constexpr std::uint64_t golden = 0x9e3779b97f4a7c15ull;  // 2^64 / golden ratio
  return mix_bits(mix_bits(seed + golden) + (index + 1) * golden);
}

/// The index-th number in [0, 1) of the stream called seed.
template <class T = double>
constexpr T uniform_at(std::uint64_t seed, std::uint64_t index) {
  return unit_interval<T>(hash_u64(seed, index));
}

}  // namespace treeline::geometry
