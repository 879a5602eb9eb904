// What the batched surfaces need of vector registers: as many floats as fit into one, their roots and
// inverses, and arrays read and written by the register.
//
// Nothing here relies on the compiler's flags for floating point: roots and inverses are instructions, or
// Newton's steps from their estimates, and never calls to a library that sets errno. Instruction sets differ
// in their estimates and in what is fused, so answers differ in the last bits; errors are stated.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "accel/simd/lanes.hpp"

namespace treeline::shading::brdf::batch {

inline constexpr std::size_t lanes = accel::simd::register_bytes / sizeof(float);

typedef float Floats __attribute__((vector_size(accel::simd::register_bytes)));
typedef std::int32_t Ints __attribute__((vector_size(accel::simd::register_bytes)));

inline Floats floats(float x) { return x - Floats{}; }
inline Ints bits_of(Floats a) { return (Ints)a; }
inline Floats with_bits(Ints a) { return (Floats)a; }
// b where either is NaN.
inline Floats least(Floats a, Floats b) { return a < b ? a : b; }
inline Floats largest(Floats a, Floats b) { return a > b ? a : b; }
/// 0 where the mask says no.
inline Floats kept(Ints mask, Floats a) { return mask ? a : Floats{}; }

/// Of numbers that are not negative; error up to 1 unit in the last place, without instructions for it 3.
inline Floats root(Floats a);
/// 1/a for 2^-126 <= |a| <= 2^125; relative error up to 2e-7.
inline Floats inverse(Floats a);
/// 1/√a for 2^-126 <= a < 2^127; relative error up to 3e-7.
inline Floats inverse_root(Floats a);

namespace detail {
/// Newton's steps to 1/a and 1/√a, which square the relative error of y.
inline Floats closer_inverse(Floats a, Floats y) { return y + y * (1.0f - a * y); }
inline Floats closer_inverse_root(Floats a, Floats y) { return y + y * (0.5f - 0.5f * a * y * y); }
}  // namespace detail

#if TREELINE_SIMD == 512
// Named with a mask of all lanes: GCC 12 warns that the plain ones' unused operand is not initialised.
inline Floats root(Floats a) { return (Floats)_mm512_maskz_sqrt_ps(0xffff, (__m512)a); }
inline Floats inverse(Floats a) {
  return detail::closer_inverse(a, (Floats)_mm512_maskz_rcp14_ps(0xffff, (__m512)a));
}
inline Floats inverse_root(Floats a) {
  return detail::closer_inverse_root(a, (Floats)_mm512_maskz_rsqrt14_ps(0xffff, (__m512)a));
}
#elif TREELINE_SIMD == 256
inline Floats root(Floats a) { return (Floats)_mm256_sqrt_ps((__m256)a); }
inline Floats inverse(Floats a) { return detail::closer_inverse(a, (Floats)_mm256_rcp_ps((__m256)a)); }
inline Floats inverse_root(Floats a) {
  return detail::closer_inverse_root(a, (Floats)_mm256_rsqrt_ps((__m256)a));
}
#elif TREELINE_SIMD == 128
inline Floats root(Floats a) { return (Floats)_mm_sqrt_ps((__m128)a); }
inline Floats inverse(Floats a) { return detail::closer_inverse(a, (Floats)_mm_rcp_ps((__m128)a)); }
inline Floats inverse_root(Floats a) {
  return detail::closer_inverse_root(a, (Floats)_mm_rsqrt_ps((__m128)a));
}
#else
inline Floats inverse(Floats a) { return 1.0f / a; }
inline Floats inverse_root(Floats a) {
  // Half the negated exponent, from the bits: 3.4 % off (Lomont 2003), three steps from all digits.
  Floats y = with_bits(0x5f375a86 - (bits_of(a) >> 1));
  for (int step = 0; step < 3; ++step) y = detail::closer_inverse_root(a, y);
  return y;
}
inline Floats root(Floats a) { return a * inverse_root(a); }
#endif

/// values[index] by lane.
inline Floats gathered(const float* values, Ints index) {
#if TREELINE_SIMD == 512
  return (Floats)_mm512_mask_i32gather_ps(_mm512_setzero_ps(), 0xffff, (__m512i)index, values, 4);
#elif TREELINE_SIMD == 256
  return (Floats)_mm256_i32gather_ps(values, (__m256i)index, 4);
#else
  Floats a;
  for (std::size_t i = 0; i < lanes; ++i) a[i] = values[index[i]];
  return a;
#endif
}

/// Lanes that are entries `first` and following of arrays, as many as a register holds.
struct WholeRegister {
  std::size_t first;

  Floats load(const float* p) const {
    Floats a;
    std::memcpy(&a, p + first, sizeof a);
    return a;
  }
  void store(float* p, Floats a) const { std::memcpy(p + first, &a, sizeof a); }
};

/// The last entries of arrays, fewer than a register holds; zeros stand in for those that are missing.
struct PartOfRegister {
  std::size_t first, count;

  Floats load(const float* p) const {
    float x[lanes] = {};
    std::memcpy(x, p + first, count * sizeof(float));
    return WholeRegister{0}.load(x);
  }
  void store(float* p, Floats a) const { std::memcpy(p + first, &a, count * sizeof(float)); }
};

/// body(at) for all of n entries, a register at a time; `at` loads and stores.
template <class Body>
void for_registers(std::size_t n, Body body) {
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes) body(WholeRegister{i});
  if (i < n) body(PartOfRegister{i, n - i});
}

}  // namespace treeline::shading::brdf::batch
