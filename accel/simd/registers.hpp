// The vector registers of this instruction set, and the few operations that the kernels build on. What a
// kernel computes is the same on every one of them, bit for bit: no operation here rounds twice or fuses.
//
// The widest set that the compiler may use is taken; TREELINE_SIMD chooses a narrower one: 512 (AVX-512 with
// VL, BW and DQ), 256 (AVX2), 128 (SSE4.1), 0 (the compiler's generic vectors, for any machine).
#pragma once

#include <cstdint>
#include <cstring>

#ifndef TREELINE_SIMD
#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512BW__) && defined(__AVX512DQ__) && \
    defined(__BMI2__)
#define TREELINE_SIMD 512
#elif defined(__AVX2__)
#define TREELINE_SIMD 256
#elif defined(__SSE4_1__)
#define TREELINE_SIMD 128
#else
#define TREELINE_SIMD 0
#endif
#endif

#if TREELINE_SIMD > 0
#include <immintrin.h>
#endif

namespace treeline::accel::simd {

#if TREELINE_SIMD == 512
inline constexpr const char* instruction_set = "avx512";
#elif TREELINE_SIMD == 256
inline constexpr const char* instruction_set = "avx2";
#elif TREELINE_SIMD == 128
inline constexpr const char* instruction_set = "sse4";
#else
inline constexpr const char* instruction_set = "plain";
#endif

/// A value that the compiler knows nothing about, so that it cannot fuse the product it holds into a sum.
inline float opaque(float x) {
#if defined(__x86_64__)
  asm("" : "+x"(x));
#else
  asm("" : "+m"(x));
#endif
  return x;
}
inline double opaque(double x) {
#if defined(__x86_64__)
  asm("" : "+x"(x));
#else
  asm("" : "+m"(x));
#endif
  return x;
}
inline long double opaque(long double x) {
  asm("" : "+m"(x));
  return x;
}

// max(a, b) and min(a, b) return b where either is NaN, as the machine's do. bits(…) has one bit a lane.

#if TREELINE_SIMD == 512

using FloatReg = __m512;
using IntReg = __m512i;
using DoubleReg = __m512d;

// Some instructions are named with a mask of all lanes: GCC 12 warns that the plain ones' unused operand is
// not initialised. The code is the same.
inline constexpr __mmask16 all16 = 0xffff;
inline constexpr __mmask8 all8 = 0xff;

inline FloatReg load(const float* p) { return _mm512_loadu_ps(p); }
inline void store(float* p, FloatReg a) { _mm512_storeu_ps(p, a); }
inline FloatReg broadcast(float x) { return _mm512_set1_ps(x); }
inline FloatReg add(FloatReg a, FloatReg b) { return _mm512_add_ps(a, b); }
inline FloatReg sub(FloatReg a, FloatReg b) { return _mm512_sub_ps(a, b); }
inline FloatReg mul(FloatReg a, FloatReg b) {
  FloatReg r = _mm512_mul_ps(a, b);
  asm("" : "+v"(r));
  return r;
}
inline FloatReg max(FloatReg a, FloatReg b) { return _mm512_maskz_max_ps(all16, a, b); }
inline FloatReg min(FloatReg a, FloatReg b) { return _mm512_maskz_min_ps(all16, a, b); }
inline std::uint32_t bits_le(FloatReg a, FloatReg b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
inline IntReg as_ints(FloatReg a) { return _mm512_castps_si512(a); }
/// count + 1 in the lanes where a <= b.
inline IntReg counted_le(IntReg count, FloatReg a, FloatReg b) {
  return _mm512_mask_add_epi32(count, _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ), count, _mm512_set1_epi32(1));
}
/// a in the lanes where count > limit, else b.
inline FloatReg chosen(IntReg count, std::int32_t limit, FloatReg a, FloatReg b) {
  return _mm512_mask_blend_ps(_mm512_cmpgt_epi32_mask(count, _mm512_set1_epi32(limit)), b, a);
}

inline IntReg load(const std::int32_t* p) { return _mm512_loadu_si512(p); }
inline void store(std::int32_t* p, IntReg a) { _mm512_storeu_si512(p, a); }
inline IntReg broadcast(std::int32_t x) { return _mm512_set1_epi32(x); }
inline IntReg bit_and(IntReg a, IntReg b) { return _mm512_and_si512(a, b); }
inline IntReg bit_or(IntReg a, IntReg b) { return _mm512_or_si512(a, b); }
inline IntReg min(IntReg a, IntReg b) { return _mm512_maskz_min_epi32(all16, a, b); }
inline std::uint32_t bits_le(IntReg a, IntReg b) { return _mm512_cmple_epi32_mask(a, b); }
/// value where a == b, else a.
inline IntReg replaced(IntReg a, IntReg b, IntReg value) {
  return _mm512_mask_mov_epi32(a, _mm512_cmpeq_epi32_mask(a, b), value);
}
inline std::int32_t smallest(IntReg a) {
  const __m256i h = _mm256_min_epi32(_mm512_maskz_extracti64x4_epi64(all8, a, 0),
                                     _mm512_maskz_extracti64x4_epi64(all8, a, 1));
  __m128i q = _mm_min_epi32(_mm256_castsi256_si128(h), _mm256_extracti128_si256(h, 1));
  q = _mm_min_epi32(q, _mm_shuffle_epi32(q, 0b01001110));
  q = _mm_min_epi32(q, _mm_shuffle_epi32(q, 0b10110001));
  return _mm_cvtsi128_si32(q);
}

inline DoubleReg load(const double* p) { return _mm512_loadu_pd(p); }
inline void store(double* p, DoubleReg a) { _mm512_storeu_pd(p, a); }
inline DoubleReg broadcast(double x) { return _mm512_set1_pd(x); }
inline DoubleReg add(DoubleReg a, DoubleReg b) { return _mm512_add_pd(a, b); }
inline DoubleReg sub(DoubleReg a, DoubleReg b) { return _mm512_sub_pd(a, b); }
inline DoubleReg mul(DoubleReg a, DoubleReg b) {
  DoubleReg r = _mm512_mul_pd(a, b);
  asm("" : "+v"(r));
  return r;
}
inline std::uint32_t bits_le(DoubleReg a, DoubleReg b) { return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ); }
inline DoubleReg max(DoubleReg a, DoubleReg b) { return _mm512_maskz_max_pd(all8, a, b); }
inline DoubleReg min(DoubleReg a, DoubleReg b) { return _mm512_maskz_min_pd(all8, a, b); }
/// The lanes of b moved up by one, behind the last lane of a.
inline DoubleReg moved_up(DoubleReg a, DoubleReg b) {
  return _mm512_castsi512_pd(
      _mm512_maskz_alignr_epi64(all8, _mm512_castpd_si512(b), _mm512_castpd_si512(a), 7));
}
/// The same by two.
inline DoubleReg moved_up_two(DoubleReg a, DoubleReg b) {
  return _mm512_castsi512_pd(
      _mm512_maskz_alignr_epi64(all8, _mm512_castpd_si512(b), _mm512_castpd_si512(a), 6));
}
/// Lanes of a and b by turns: 0, 1, 4, 5, 8, 9, 12, 13 of both; the others.
inline IntReg unpacked_low(IntReg a, IntReg b) { return _mm512_maskz_unpacklo_epi32(all16, a, b); }
inline IntReg unpacked_high(IntReg a, IntReg b) { return _mm512_maskz_unpackhi_epi32(all16, a, b); }
inline double last_lane(DoubleReg a) {
  const __m128d q = _mm512_maskz_extractf64x2_pd(all8, a, 3);
  return _mm_cvtsd_f64(_mm_unpackhi_pd(q, q));
}
/// x where a < b, else y.
inline DoubleReg chosen_lt(DoubleReg a, DoubleReg b, DoubleReg x, DoubleReg y) {
  return _mm512_mask_blend_pd(_mm512_cmp_pd_mask(a, b, _CMP_LT_OQ), y, x);
}
inline double smallest(DoubleReg a) {
  const __m256d four =
      _mm256_min_pd(_mm512_maskz_extractf64x4_pd(all8, a, 0), _mm512_maskz_extractf64x4_pd(all8, a, 1));
  const __m128d two = _mm_min_pd(_mm256_castpd256_pd128(four), _mm256_extractf128_pd(four, 1));
  return _mm_cvtsd_f64(_mm_min_sd(two, _mm_unpackhi_pd(two, two)));
}

#elif TREELINE_SIMD == 256

using FloatReg = __m256;
using IntReg = __m256i;
using DoubleReg = __m256d;

inline FloatReg load(const float* p) { return _mm256_loadu_ps(p); }
inline void store(float* p, FloatReg a) { _mm256_storeu_ps(p, a); }
inline FloatReg broadcast(float x) { return _mm256_set1_ps(x); }
inline FloatReg add(FloatReg a, FloatReg b) { return _mm256_add_ps(a, b); }
inline FloatReg sub(FloatReg a, FloatReg b) { return _mm256_sub_ps(a, b); }
inline FloatReg mul(FloatReg a, FloatReg b) {
  FloatReg r = _mm256_mul_ps(a, b);
  asm("" : "+x"(r));
  return r;
}
inline FloatReg max(FloatReg a, FloatReg b) { return _mm256_max_ps(a, b); }
inline FloatReg min(FloatReg a, FloatReg b) { return _mm256_min_ps(a, b); }
inline std::uint32_t bits_le(FloatReg a, FloatReg b) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
}
inline IntReg as_ints(FloatReg a) { return _mm256_castps_si256(a); }
inline IntReg counted_le(IntReg count, FloatReg a, FloatReg b) {
  return _mm256_sub_epi32(count, _mm256_castps_si256(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
}
inline FloatReg chosen(IntReg count, std::int32_t limit, FloatReg a, FloatReg b) {
  return _mm256_blendv_ps(b, a, _mm256_castsi256_ps(_mm256_cmpgt_epi32(count, _mm256_set1_epi32(limit))));
}

inline IntReg load(const std::int32_t* p) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)); }
inline void store(std::int32_t* p, IntReg a) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a); }
inline IntReg broadcast(std::int32_t x) { return _mm256_set1_epi32(x); }
inline IntReg bit_and(IntReg a, IntReg b) { return _mm256_and_si256(a, b); }
inline IntReg bit_or(IntReg a, IntReg b) { return _mm256_or_si256(a, b); }
inline IntReg min(IntReg a, IntReg b) { return _mm256_min_epi32(a, b); }
inline std::uint32_t bits_le(IntReg a, IntReg b) {
  const __m256i above = _mm256_cmpgt_epi32(a, b);
  return ~static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(above))) & 0xffu;
}
inline IntReg replaced(IntReg a, IntReg b, IntReg value) {
  return _mm256_blendv_epi8(a, value, _mm256_cmpeq_epi32(a, b));
}
inline std::int32_t smallest(IntReg a) {
  __m128i q = _mm_min_epi32(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1));
  q = _mm_min_epi32(q, _mm_shuffle_epi32(q, 0b01001110));
  q = _mm_min_epi32(q, _mm_shuffle_epi32(q, 0b10110001));
  return _mm_cvtsi128_si32(q);
}

inline DoubleReg load(const double* p) { return _mm256_loadu_pd(p); }
inline void store(double* p, DoubleReg a) { _mm256_storeu_pd(p, a); }
inline DoubleReg broadcast(double x) { return _mm256_set1_pd(x); }
inline DoubleReg add(DoubleReg a, DoubleReg b) { return _mm256_add_pd(a, b); }
inline DoubleReg sub(DoubleReg a, DoubleReg b) { return _mm256_sub_pd(a, b); }
inline DoubleReg mul(DoubleReg a, DoubleReg b) {
  DoubleReg r = _mm256_mul_pd(a, b);
  asm("" : "+x"(r));
  return r;
}
inline std::uint32_t bits_le(DoubleReg a, DoubleReg b) {
  return static_cast<std::uint32_t>(_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LE_OQ)));
}
inline DoubleReg max(DoubleReg a, DoubleReg b) { return _mm256_max_pd(a, b); }
inline DoubleReg min(DoubleReg a, DoubleReg b) { return _mm256_min_pd(a, b); }
inline DoubleReg moved_up(DoubleReg a, DoubleReg b) {
  return _mm256_shuffle_pd(_mm256_permute2f128_pd(a, b, 0x21), b, 0b0101);
}
inline DoubleReg moved_up_two(DoubleReg a, DoubleReg b) { return _mm256_permute2f128_pd(a, b, 0x21); }
inline double last_lane(DoubleReg a) {
  const __m128d q = _mm256_extractf128_pd(a, 1);
  return _mm_cvtsd_f64(_mm_unpackhi_pd(q, q));
}
inline DoubleReg chosen_lt(DoubleReg a, DoubleReg b, DoubleReg x, DoubleReg y) {
  return _mm256_blendv_pd(y, x, _mm256_cmp_pd(a, b, _CMP_LT_OQ));
}
inline double smallest(DoubleReg a) {
  const __m128d two = _mm_min_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd(a, 1));
  return _mm_cvtsd_f64(_mm_min_sd(two, _mm_unpackhi_pd(two, two)));
}

#elif TREELINE_SIMD == 128

using FloatReg = __m128;
using IntReg = __m128i;
using DoubleReg = __m128d;

inline FloatReg load(const float* p) { return _mm_loadu_ps(p); }
inline void store(float* p, FloatReg a) { _mm_storeu_ps(p, a); }
inline FloatReg broadcast(float x) { return _mm_set1_ps(x); }
inline FloatReg add(FloatReg a, FloatReg b) { return _mm_add_ps(a, b); }
inline FloatReg sub(FloatReg a, FloatReg b) { return _mm_sub_ps(a, b); }
inline FloatReg mul(FloatReg a, FloatReg b) {
  FloatReg r = _mm_mul_ps(a, b);
  asm("" : "+x"(r));
  return r;
}
inline FloatReg max(FloatReg a, FloatReg b) { return _mm_max_ps(a, b); }
inline FloatReg min(FloatReg a, FloatReg b) { return _mm_min_ps(a, b); }
inline std::uint32_t bits_le(FloatReg a, FloatReg b) {
  return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmple_ps(a, b)));
}
inline IntReg as_ints(FloatReg a) { return _mm_castps_si128(a); }
inline IntReg counted_le(IntReg count, FloatReg a, FloatReg b) {
  return _mm_sub_epi32(count, _mm_castps_si128(_mm_cmple_ps(a, b)));
}
inline FloatReg chosen(IntReg count, std::int32_t limit, FloatReg a, FloatReg b) {
  return _mm_blendv_ps(b, a, _mm_castsi128_ps(_mm_cmpgt_epi32(count, _mm_set1_epi32(limit))));
}

inline IntReg load(const std::int32_t* p) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p)); }
inline void store(std::int32_t* p, IntReg a) { _mm_storeu_si128(reinterpret_cast<__m128i*>(p), a); }
inline IntReg broadcast(std::int32_t x) { return _mm_set1_epi32(x); }
inline IntReg bit_and(IntReg a, IntReg b) { return _mm_and_si128(a, b); }
inline IntReg bit_or(IntReg a, IntReg b) { return _mm_or_si128(a, b); }
inline IntReg min(IntReg a, IntReg b) { return _mm_min_epi32(a, b); }
inline std::uint32_t bits_le(IntReg a, IntReg b) {
  return ~static_cast<std::uint32_t>(_mm_movemask_ps(_mm_castsi128_ps(_mm_cmpgt_epi32(a, b)))) & 0xfu;
}
inline IntReg replaced(IntReg a, IntReg b, IntReg value) {
  return _mm_blendv_epi8(a, value, _mm_cmpeq_epi32(a, b));
}
inline std::int32_t smallest(IntReg q) {
  q = _mm_min_epi32(q, _mm_shuffle_epi32(q, 0b01001110));
  q = _mm_min_epi32(q, _mm_shuffle_epi32(q, 0b10110001));
  return _mm_cvtsi128_si32(q);
}

inline DoubleReg load(const double* p) { return _mm_loadu_pd(p); }
inline void store(double* p, DoubleReg a) { _mm_storeu_pd(p, a); }
inline DoubleReg broadcast(double x) { return _mm_set1_pd(x); }
inline DoubleReg add(DoubleReg a, DoubleReg b) { return _mm_add_pd(a, b); }
inline DoubleReg sub(DoubleReg a, DoubleReg b) { return _mm_sub_pd(a, b); }
inline DoubleReg mul(DoubleReg a, DoubleReg b) {
  DoubleReg r = _mm_mul_pd(a, b);
  asm("" : "+x"(r));
  return r;
}
inline std::uint32_t bits_le(DoubleReg a, DoubleReg b) {
  return static_cast<std::uint32_t>(_mm_movemask_pd(_mm_cmple_pd(a, b)));
}
inline DoubleReg max(DoubleReg a, DoubleReg b) { return _mm_max_pd(a, b); }
inline DoubleReg min(DoubleReg a, DoubleReg b) { return _mm_min_pd(a, b); }
inline DoubleReg moved_up(DoubleReg a, DoubleReg b) { return _mm_shuffle_pd(a, b, 0b01); }
inline DoubleReg moved_up_two(DoubleReg a, DoubleReg) { return a; }
inline double last_lane(DoubleReg a) { return _mm_cvtsd_f64(_mm_unpackhi_pd(a, a)); }
inline DoubleReg chosen_lt(DoubleReg a, DoubleReg b, DoubleReg x, DoubleReg y) {
  return _mm_blendv_pd(y, x, _mm_cmplt_pd(a, b));
}
inline double smallest(DoubleReg a) { return _mm_cvtsd_f64(_mm_min_sd(a, _mm_unpackhi_pd(a, a))); }

#else

using FloatReg = float __attribute__((vector_size(16)));
using IntReg = std::int32_t __attribute__((vector_size(16)));
using DoubleReg = double __attribute__((vector_size(16)));

template <class Reg, class T>
Reg load_generic(const T* p) {
  Reg r;
  std::memcpy(&r, p, sizeof r);
  return r;
}
inline std::uint32_t bits_set(IntReg m) {
  return (m[0] ? 1u : 0u) | (m[1] ? 2u : 0u) | (m[2] ? 4u : 0u) | (m[3] ? 8u : 0u);
}

inline FloatReg load(const float* p) { return load_generic<FloatReg>(p); }
inline void store(float* p, FloatReg a) { std::memcpy(p, &a, sizeof a); }
inline FloatReg broadcast(float x) { return FloatReg{x, x, x, x}; }
inline FloatReg add(FloatReg a, FloatReg b) { return a + b; }
inline FloatReg sub(FloatReg a, FloatReg b) { return a - b; }
inline FloatReg mul(FloatReg a, FloatReg b) {
  FloatReg r = a * b;
#if defined(__x86_64__)
  asm("" : "+x"(r));
#else
  asm("" : "+m"(r));
#endif
  return r;
}
inline FloatReg max(FloatReg a, FloatReg b) { return a > b ? a : b; }
inline FloatReg min(FloatReg a, FloatReg b) { return a < b ? a : b; }
inline std::uint32_t bits_le(FloatReg a, FloatReg b) { return bits_set(a <= b); }
inline IntReg as_ints(FloatReg a) { return reinterpret_cast<IntReg>(a); }
inline IntReg counted_le(IntReg count, FloatReg a, FloatReg b) { return count - (a <= b); }
inline FloatReg chosen(IntReg count, std::int32_t limit, FloatReg a, FloatReg b) {
  return count > IntReg{limit, limit, limit, limit} ? a : b;
}

inline IntReg load(const std::int32_t* p) { return load_generic<IntReg>(p); }
inline void store(std::int32_t* p, IntReg a) { std::memcpy(p, &a, sizeof a); }
inline IntReg broadcast(std::int32_t x) { return IntReg{x, x, x, x}; }
inline IntReg bit_and(IntReg a, IntReg b) { return a & b; }
inline IntReg bit_or(IntReg a, IntReg b) { return a | b; }
inline IntReg min(IntReg a, IntReg b) { return a < b ? a : b; }
inline std::uint32_t bits_le(IntReg a, IntReg b) { return bits_set(a <= b); }
inline IntReg replaced(IntReg a, IntReg b, IntReg value) { return a == b ? value : a; }
inline std::int32_t smallest(IntReg a) {
  const std::int32_t x = a[0] < a[1] ? a[0] : a[1], y = a[2] < a[3] ? a[2] : a[3];
  return x < y ? x : y;
}

inline DoubleReg load(const double* p) { return load_generic<DoubleReg>(p); }
inline void store(double* p, DoubleReg a) { std::memcpy(p, &a, sizeof a); }
inline DoubleReg broadcast(double x) { return DoubleReg{x, x}; }
inline DoubleReg add(DoubleReg a, DoubleReg b) { return a + b; }
inline DoubleReg sub(DoubleReg a, DoubleReg b) { return a - b; }
inline DoubleReg mul(DoubleReg a, DoubleReg b) {
  DoubleReg r = a * b;
#if defined(__x86_64__)
  asm("" : "+x"(r));
#else
  asm("" : "+m"(r));
#endif
  return r;
}
inline std::uint32_t bits_le(DoubleReg a, DoubleReg b) {
  return (a[0] <= b[0] ? 1u : 0u) | (a[1] <= b[1] ? 2u : 0u);
}
inline DoubleReg max(DoubleReg a, DoubleReg b) { return a > b ? a : b; }
inline DoubleReg min(DoubleReg a, DoubleReg b) { return a < b ? a : b; }
inline DoubleReg moved_up(DoubleReg a, DoubleReg b) { return DoubleReg{a[1], b[0]}; }
inline DoubleReg moved_up_two(DoubleReg a, DoubleReg) { return a; }
inline double last_lane(DoubleReg a) { return a[1]; }
inline DoubleReg chosen_lt(DoubleReg a, DoubleReg b, DoubleReg x, DoubleReg y) { return a < b ? x : y; }
inline double smallest(DoubleReg a) { return a[0] < a[1] ? a[0] : a[1]; }

#endif

/// Lanes of a register.
inline constexpr int float_width = static_cast<int>(sizeof(FloatReg) / sizeof(float));
inline constexpr int double_width = static_cast<int>(sizeof(DoubleReg) / sizeof(double));

}  // namespace treeline::accel::simd
