// Points in the unit square for sampling, of five kinds under one interface; each kind is randomised by a
// seed, so that the spread between seeds tells an average's error.
//
// Problem: how fast the average of a function over N points comes to its integral depends on how well they
// are spread. Root mean square errors fall as N^-1/2 for independent points; across edges about as N^-3/4 for
// all others here; for smooth functions as N^-1, for R2 as log N / N, for Sobol nets as N^-3/2. Sources:
// Halton 1960, scrambled by Owen 1995; Roberts 2018 (R2, the plastic number) with a random shift (Cranley and
// Patterson 1976); Joe and Kuo 2008 with Owen's scrambling (sobol.hpp). Every point on its own is uniform, so
// averages are without bias. Cost a point: 1 to 4 ns; Halton (which takes memory) and Sobol 14. Known
// weakness: two dimensions only; stratified and Halton sets are of a size chosen beforehand; a net's worth
// shows at powers of two.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "geometry/sobol.hpp"
#include "geometry/vec.hpp"

namespace treeline::geometry {

enum class PointSet {
  random,      ///< independent
  stratified,  ///< one at random in each of N cells of the same area, in rows
  halton,      ///< radical inverses to bases 2 and 3, digits scrambled
  r2,          ///< additive recurrence by powers of the plastic number, shifted at random
  sobol_owen,  ///< a scrambled net
};
inline constexpr std::array<PointSet, 5> point_sets{PointSet::random, PointSet::stratified, PointSet::halton,
                                                    PointSet::r2, PointSet::sobol_owen};

constexpr const char* name_of(PointSet set) {
  constexpr std::array<const char*, 5> names{"random", "stratified", "halton", "r2", "sobol_owen"};
  return names[static_cast<std::size_t>(set)];
}

namespace detail {

/// Rounds towards zero: never to 1, as a cast to float could.
template <class T>
constexpr T below_one(double x) {
  return std::min(static_cast<T>(x), T(1) - std::numeric_limits<T>::epsilon() / T(2));
}

/// The first points of the van der Corput sequence to base 3 under Owen's scrambling: put(i, x) for each of
/// n. Digits are permuted by what those before them are, so points that begin alike share that work: about
/// two hashes a point. Points differ within as many digits as n has; what follows is independent, so drawn at
/// once.
template <class Put>
void scrambled_base_3(std::uint32_t n, std::uint64_t seed, const Put& put) {
  constexpr std::array<std::array<std::uint8_t, 3>, 6> permutations{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  struct Prefix {
    std::uint64_t key, value;  // names its digits; their number after scrambling
  };
  std::vector<Prefix> prefixes(n);
  if (n > 0) prefixes[0] = {seed, 0};
  std::uint64_t size = 1;
  for (; size < n; size *= 3)
    for (const std::uint64_t digit : {2u, 1u, 0u})  // in place: 0 overwrites what the others come from
      for (std::uint64_t i = 0; i < size && i + digit * size < n; ++i) {
        const Prefix p = prefixes[i];
        prefixes[i + digit * size] = {mix_bits(p.key + (digit + 1) * 0x9e3779b97f4a7c15ull),
                                      p.value * 3 + permutations[(p.key >> 32) % 6][digit]};
      }
  for (std::uint32_t i = 0; i < n; ++i)
    put(i, (static_cast<double>(prefixes[i].value) + unit_interval<double>(prefixes[i].key)) /
               static_cast<double>(size));
}

}  // namespace detail

/// As many points of the set as `out` has places, in [0, 1)²; the same for the same seed and number. For less
/// than 2^32 points.
template <class T>
void fill_points(PointSet set, std::uint64_t seed, std::span<Vec<T, 2>> out) {
  const auto n = static_cast<std::uint32_t>(out.size());
  switch (set) {
    case PointSet::random:
      for (std::uint64_t i = 0; i < n; ++i)
        out[i] = {uniform_at<T>(seed, 2 * i), uniform_at<T>(seed, 2 * i + 1)};
      break;
    case PointSet::stratified: {
      // Rows of columns; some rows have one column more, and are higher for it.
      const auto rows = static_cast<std::uint32_t>(std::max(1.0, std::round(std::sqrt(double(n)))));
      std::uint32_t i = 0;
      for (std::uint32_t row = 0; row < rows; ++row) {
        const std::uint32_t first = i, columns = n / rows + (row < n % rows ? 1 : 0);
        for (; i < first + columns; ++i) {
          const double u = uniform_at(seed, std::uint64_t{2} * i),
                       v = uniform_at(seed, std::uint64_t{2} * i + 1);
          out[i] = {detail::below_one<T>((i - first + u) / columns),
                    detail::below_one<T>((first + columns * v) / n)};
        }
      }
      break;
    }
    case PointSet::halton: {
      const auto scramble = static_cast<std::uint32_t>(hash_u64(seed, 0));
      detail::scrambled_base_3(n, hash_u64(seed, 1), [&](std::uint32_t i, double y) {
        out[i] = {unit_interval<T>(std::uint64_t{owen_scrambled(detail::reversed_bits(i), scramble)} << 32),
                  detail::below_one<T>(y)};
      });
      break;
    }
    case PointSet::r2: {
      // In units of 2^-64, where wrapping around is exact: 1 / g and 1 / g², g³ = g + 1.
      std::uint64_t x = hash_u64(seed, 0), y = hash_u64(seed, 1);
      for (std::uint32_t i = 0; i < n; ++i, x += 0xc13fa9a902a6328full, y += 0x91e10da5c79e7b1dull)
        out[i] = {unit_interval<T>(x), unit_interval<T>(y)};
      break;
    }
    case PointSet::sobol_owen: {
      const auto x = static_cast<std::uint32_t>(hash_u64(seed, 0)),
                 y = static_cast<std::uint32_t>(hash_u64(seed, 1));
      std::array<std::uint32_t, 32> changes = detail::sobol_matrices[1];  // by as many trailing ones in i
      for (std::size_t k = 1; k < 32; ++k) changes[k] ^= changes[k - 1];
      std::uint32_t bits = 0;
      for (std::uint32_t i = 0; i < n;
           bits ^= changes[static_cast<std::size_t>(std::countr_one(i)) % 32], ++i)
        out[i] = {unit_interval<T>(std::uint64_t{owen_scrambled(detail::reversed_bits(i), x)} << 32),
                  unit_interval<T>(std::uint64_t{owen_scrambled(bits, y)} << 32)};
      break;
    }
  }
}

}  // namespace treeline::geometry
