// Sobol points with Owen scrambling: well-spread samples, independent between seeds.
//
// Sources: Joe and Kuo 2008 (direction numbers, first 16 dimensions of new-joe-kuo-6.21201); Owen 1995
// (nested uniform scrambling); Laine and Karras 2011 and Burley 2020 (scrambling by a hash in which bits
// affect only lower bits), with the constants of Vegdahl 2021; Burley 2020 (padding beyond the table). Every
// aligned power-of-two run of points of dimensions 0 and 1 is a (0, m, 2)-net, scrambled or not. Cost: one
// exclusive-or per set bit of the index, and the hash. Known weakness: beyond 16 dimensions, blocks of 16 are
// decorrelated from each other by shuffling the index, so pairs across blocks are spread like independent
// samples.
#pragma once

#include <array>
#include <cstdint>

#include "geometry/random.hpp"

namespace treeline::geometry {

inline constexpr int sobol_dimensions = 16;

namespace detail {
struct SobolPolynomial {
  int degree;
  std::uint32_t coefficients;            // a: inner coefficients of the primitive polynomial
  std::array<std::uint32_t, 6> initial;  // m_1 … m_degree
};
inline constexpr std::array<SobolPolynomial, sobol_dimensions - 1> sobol_polynomials{{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
}};

using SobolMatrix = std::array<std::uint32_t, 32>;

constexpr std::array<SobolMatrix, sobol_dimensions> make_sobol_matrices() {
  std::array<SobolMatrix, sobol_dimensions> all{};
  for (int i = 0; i < 32; ++i) all[0][i] = 1u << (31 - i);
  for (int d = 1; d < sobol_dimensions; ++d) {
    const SobolPolynomial& p = sobol_polynomials[d - 1];
    SobolMatrix& v = all[d];
    for (int i = 0; i < p.degree; ++i) v[i] = p.initial[i] << (31 - i);
    for (int i = p.degree; i < 32; ++i) {
      v[i] = v[i - p.degree] ^ (v[i - p.degree] >> p.degree);
      for (int k = 1; k < p.degree; ++k)
        if (p.coefficients >> (p.degree - 1 - k) & 1) v[i] ^= v[i - k];
    }
  }
  return all;
}
inline constexpr auto sobol_matrices = make_sobol_matrices();

constexpr std::uint32_t reversed_bits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}
}  // namespace detail

/// Bits of the index-th Sobol point in one of the first 16 dimensions, most significant bit = one half.
constexpr std::uint32_t sobol_bits(std::uint32_t index, int dimension) {
  std::uint32_t x = 0;
  for (int i = 0; index; ++i, index >>= 1)
    if (index & 1) x ^= detail::sobol_matrices[dimension][i];
  return x;
}

/// Owen scrambling: flips each bit by a hash of the bits above it.
constexpr std::uint32_t owen_scrambled(std::uint32_t x, std::uint32_t seed) {
  x = detail::reversed_bits(x);
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return detail::reversed_bits(x);
}

/// The index-th point of the scrambled sequence called seed, in any dimension ≥ 0; in [0, 1).
template <class T = double>
constexpr T sobol_owen(std::uint32_t index, int dimension, std::uint64_t seed) {
  const int block = dimension / sobol_dimensions;
  if (block > 0) {  // aligned power-of-two runs trade places, at every level
    const auto shuffle = static_cast<std::uint32_t>(hash_u64(seed, 0x100000000ull + block));
    index = owen_scrambled(index, shuffle);
  }
  const auto scramble = static_cast<std::uint32_t>(hash_u64(seed, dimension));
  const std::uint32_t bits = owen_scrambled(sobol_bits(index, dimension % sobol_dimensions), scramble);
  return unit_interval<T>(std::uint64_t{bits} << 32);
}

}  // namespace treeline::geometry
