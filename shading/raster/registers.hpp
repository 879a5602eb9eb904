// What the rasteriser needs of vector registers: as many 32-bit numbers as fit into one. All instruction sets
// give the same bits: integers are exact, and no product is fused into a sum.
#pragma once

#include <cstdint>
#include <cstring>

#include "accel/simd/lanes.hpp"

namespace treeline::shading::raster {

inline constexpr int lanes = accel::simd::register_bytes / 4;
inline constexpr std::uint32_t all_lanes = (1u << lanes) - 1;

typedef std::int32_t Ints __attribute__((vector_size(accel::simd::register_bytes)));
typedef std::uint32_t Words __attribute__((vector_size(accel::simd::register_bytes)));  // sums may wrap
typedef float Floats __attribute__((vector_size(accel::simd::register_bytes)));
typedef double Doubles __attribute__((vector_size(accel::simd::register_bytes)));
typedef std::int32_t HalfInts __attribute__((vector_size(accel::simd::register_bytes / 2)));
typedef float HalfFloats __attribute__((vector_size(accel::simd::register_bytes / 2)));

inline Ints ints(std::int32_t x) { return x - Ints{}; }
inline Floats floats(float x) { return x - Floats{}; }
inline Ints least(Ints a, Ints b) { return a < b ? a : b; }
inline Ints largest(Ints a, Ints b) { return a > b ? a : b; }
inline Floats least(Floats a, Floats b) { return a < b ? a : b; }
inline Floats largest(Floats a, Floats b) { return a > b ? a : b; }

/// A product that is rounded before it is used.
template <class V>
V times(V a, V b) {
  V r = a * b;
#if TREELINE_SIMD == 512
  asm("" : "+v"(r));
#elif defined(__x86_64__)
  asm("" : "+x"(r));
#else
  asm("" : "+m"(r));
#endif
  return r;
}
inline double times(double a, double b) { return accel::simd::opaque(a * b); }
inline float times(float a, float b) { return accel::simd::opaque(a * b); }

/// 0, 1, 2 …
inline Ints counting() {
  Ints r{};
  for (int i = 0; i < lanes; ++i) r[i] = i;
  return r;
}

/// One bit a lane, of those that are negative.
inline std::uint32_t negative(Ints a) {
#if TREELINE_SIMD == 512
  return _mm512_movepi32_mask((__m512i)a);
#elif TREELINE_SIMD == 256
  return static_cast<std::uint32_t>(_mm256_movemask_ps((__m256)a));
#elif TREELINE_SIMD == 128
  return static_cast<std::uint32_t>(_mm_movemask_ps((__m128)a));
#else
  std::uint32_t bits = 0;
  for (int i = 0; i < lanes; ++i) bits |= a[i] < 0 ? 1u << i : 0u;
  return bits;
#endif
}

/// base[index] of each lane.
inline Ints gathered(const std::int32_t* base, Ints index) {
#if TREELINE_SIMD == 512
  return (Ints)_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), __mmask16(0xffff), (__m512i)index, base,
                                           4);
#elif TREELINE_SIMD == 256
  return (Ints)_mm256_i32gather_epi32(base, (__m256i)index, 4);
#else
  Ints r{};
  for (int i = 0; i < lanes; ++i) r[i] = base[index[i]];
  return r;
#endif
}

/// The two halves of a register as doubles.
struct TwoDoubles {
  Doubles low, high;

  explicit TwoDoubles(Ints a) {
    HalfInts h[2];
    std::memcpy(h, &a, sizeof a);
    low = __builtin_convertvector(h[0], Doubles), high = __builtin_convertvector(h[1], Doubles);
  }
  explicit TwoDoubles(Floats a) {
    HalfFloats h[2];
    std::memcpy(h, &a, sizeof a);
    low = __builtin_convertvector(h[0], Doubles), high = __builtin_convertvector(h[1], Doubles);
  }
  TwoDoubles(Doubles a, Doubles b) : low(a), high(b) {}
  explicit operator Floats() const {
    const HalfFloats h[2] = {__builtin_convertvector(low, HalfFloats),
                             __builtin_convertvector(high, HalfFloats)};
    Floats r;
    std::memcpy(&r, h, sizeof r);
    return r;
  }
  friend TwoDoubles operator+(const TwoDoubles& a, const TwoDoubles& b) {
    return {a.low + b.low, a.high + b.high};
  }
  friend TwoDoubles operator-(const TwoDoubles& a, const TwoDoubles& b) {
    return {a.low - b.low, a.high - b.high};
  }
  friend TwoDoubles operator*(const TwoDoubles& a, const TwoDoubles& b) {
    return {times(a.low, b.low), times(a.high, b.high)};
  }
  /// 1/a, or 0 where a is 0.
  friend TwoDoubles inverse_or_zero(const TwoDoubles& a) {
    const Doubles one = 1 - Doubles{}, zero{};
    return {a.low == zero ? zero : one / a.low, a.high == zero ? zero : one / a.high};
  }
};

}  // namespace treeline::shading::raster
