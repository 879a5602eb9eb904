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

#if TREELINE_SIMD == 512
inline Ints unpacked_low(Ints a, Ints b) {
  return (Ints)_mm512_maskz_unpacklo_epi32(0xffff, (__m512i)a, (__m512i)b);
}
inline Ints unpacked_high(Ints a, Ints b) {
  return (Ints)_mm512_maskz_unpackhi_epi32(0xffff, (__m512i)a, (__m512i)b);
}
inline Ints unpacked_low2(Ints a, Ints b) {
  return (Ints)_mm512_maskz_unpacklo_epi64(0xff, (__m512i)a, (__m512i)b);
}
inline Ints unpacked_high2(Ints a, Ints b) {
  return (Ints)_mm512_maskz_unpackhi_epi64(0xff, (__m512i)a, (__m512i)b);
}
inline Ints from_quarters(__m128i a, __m128i b, __m128i c, __m128i d) {
  const __m512i low = _mm512_maskz_inserti32x4(0xffff, _mm512_castsi128_si512(a), b, 1);
  return (Ints)_mm512_maskz_inserti32x4(0xffff, _mm512_maskz_inserti32x4(0xffff, low, c, 2), d, 3);
}
#elif TREELINE_SIMD == 256
inline Ints unpacked_low(Ints a, Ints b) { return (Ints)_mm256_unpacklo_epi32((__m256i)a, (__m256i)b); }
inline Ints unpacked_high(Ints a, Ints b) { return (Ints)_mm256_unpackhi_epi32((__m256i)a, (__m256i)b); }
inline Ints unpacked_low2(Ints a, Ints b) { return (Ints)_mm256_unpacklo_epi64((__m256i)a, (__m256i)b); }
inline Ints unpacked_high2(Ints a, Ints b) { return (Ints)_mm256_unpackhi_epi64((__m256i)a, (__m256i)b); }
#elif TREELINE_SIMD == 128
inline Ints unpacked_low(Ints a, Ints b) { return (Ints)_mm_unpacklo_epi32((__m128i)a, (__m128i)b); }
inline Ints unpacked_high(Ints a, Ints b) { return (Ints)_mm_unpackhi_epi32((__m128i)a, (__m128i)b); }
inline Ints unpacked_low2(Ints a, Ints b) { return (Ints)_mm_unpacklo_epi64((__m128i)a, (__m128i)b); }
inline Ints unpacked_high2(Ints a, Ints b) { return (Ints)_mm_unpackhi_epi64((__m128i)a, (__m128i)b); }
#endif

/// Records of four numbers, one a lane, as four registers: out[k] holds the k-th number of each.
inline void load_records(const std::int32_t* const (&record)[lanes], Ints (&out)[4]) {
#if TREELINE_SIMD == 0
  for (int i = 0; i < lanes; ++i)
    for (int k = 0; k < 4; ++k) out[k][i] = record[i][k];
#else
  // Records j, j + 4, j + 8 … in the j-th register; then each quarter is a matrix of 4 × 4 to be transposed.
  Ints row[4];
  for (int j = 0; j < 4; ++j) {
    const auto part = [&](int k) {
      return _mm_loadu_si128(reinterpret_cast<const __m128i*>(record[4 * k + j]));
    };
#if TREELINE_SIMD == 512
    row[j] = from_quarters(part(0), part(1), part(2), part(3));
#elif TREELINE_SIMD == 256
    row[j] = (Ints)_mm256_inserti128_si256(_mm256_castsi128_si256(part(0)), part(1), 1);
#else
    row[j] = (Ints)part(0);
#endif
  }
  const Ints low01 = unpacked_low(row[0], row[1]), low23 = unpacked_low(row[2], row[3]),
             high01 = unpacked_high(row[0], row[1]), high23 = unpacked_high(row[2], row[3]);
  out[0] = unpacked_low2(low01, low23), out[1] = unpacked_high2(low01, low23);
  out[2] = unpacked_low2(high01, high23), out[3] = unpacked_high2(high01, high23);
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
