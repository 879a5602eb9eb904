// Eight floats side by side, whatever the width of the machine's registers.
//
// Nothing here fuses or rounds twice, so kernels compute the same on every instruction set, bit for bit.
#pragma once

#include <bit>
#include <cstddef>

#include "accel/simd/lanes4.hpp"

namespace treeline::accel::simd {

#if TREELINE_SIMD >= 256

struct Floats8 {
  __m256 r;

  static Floats8 load(const float* p) { return {_mm256_load_ps(p)}; }
  static Floats8 broadcast(float x) { return {_mm256_set1_ps(x)}; }
  static Floats8 of(const std::uint8_t* p) {
    return {_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p))))};
  }
  static Floats8 of(const std::uint16_t* p) {
    return {_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))))};
  }
  void store(float* p) const { _mm256_store_ps(p, r); }
  Floats4 low() const { return {_mm256_castps256_ps128(r)}; }
  Floats4 high() const { return {_mm256_extractf128_ps(r, 1)}; }
  static Floats8 joined(Floats4 low, Floats4 high) { return {_mm256_set_m128(high.r, low.r)}; }

  friend Floats8 operator+(Floats8 a, Floats8 b) { return {_mm256_add_ps(a.r, b.r)}; }
  friend Floats8 operator-(Floats8 a, Floats8 b) { return {_mm256_sub_ps(a.r, b.r)}; }
  /// Rounded by itself, never fused into a sum.
  friend Floats8 operator*(Floats8 a, Floats8 b) {
    __m256 r = _mm256_mul_ps(a.r, b.r);
#if TREELINE_SIMD == 512
    asm("" : "+v"(r));
#else
    asm("" : "+x"(r));
#endif
    return {r};
  }
  friend Floats8 operator/(Floats8 a, Floats8 b) { return {_mm256_div_ps(a.r, b.r)}; }
};

/// b where either is NaN.
inline Floats8 max(Floats8 a, Floats8 b) { return {_mm256_max_ps(a.r, b.r)}; }
inline Floats8 min(Floats8 a, Floats8 b) { return {_mm256_min_ps(a.r, b.r)}; }
inline Floats8 absolute(Floats8 a) {
  return {_mm256_castsi256_ps(_mm256_and_si256(_mm256_castps_si256(a.r), _mm256_set1_epi32(0x7fffffff)))};
}
/// One bit a lane; no bit where either is NaN.
#if TREELINE_SIMD == 512
inline std::uint32_t bits_le(Floats8 a, Floats8 b) { return _mm256_cmp_ps_mask(a.r, b.r, _CMP_LE_OQ); }
inline std::uint32_t bits_lt(Floats8 a, Floats8 b) { return _mm256_cmp_ps_mask(a.r, b.r, _CMP_LT_OQ); }
#else
inline std::uint32_t bits_le(Floats8 a, Floats8 b) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(a.r, b.r, _CMP_LE_OQ)));
}
inline std::uint32_t bits_lt(Floats8 a, Floats8 b) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(a.r, b.r, _CMP_LT_OQ)));
}
#endif

#else

struct Floats8 {
  FloatReg r[2];

  static Floats8 load(const float* p) { return {{simd::load(p), simd::load(p + 4)}}; }
  static Floats8 broadcast(float x) { return {{simd::broadcast(x), simd::broadcast(x)}}; }
  template <class Count>
  static Floats8 of(const Count* p) {
    alignas(32) float x[8];
    for (int i = 0; i < 8; ++i) x[i] = p[i];
    return load(x);
  }
  void store(float* p) const { simd::store(p, r[0]), simd::store(p + 4, r[1]); }
  Floats4 low() const { return {r[0]}; }
  Floats4 high() const { return {r[1]}; }
  static Floats8 joined(Floats4 low, Floats4 high) { return {{low.r, high.r}}; }

  friend Floats8 operator+(Floats8 a, Floats8 b) { return {{add(a.r[0], b.r[0]), add(a.r[1], b.r[1])}}; }
  friend Floats8 operator-(Floats8 a, Floats8 b) { return {{sub(a.r[0], b.r[0]), sub(a.r[1], b.r[1])}}; }
  friend Floats8 operator*(Floats8 a, Floats8 b) { return {{mul(a.r[0], b.r[0]), mul(a.r[1], b.r[1])}}; }
  friend Floats8 operator/(Floats8 a, Floats8 b) { return {{a.r[0] / b.r[0], a.r[1] / b.r[1]}}; }
};

inline Floats8 max(Floats8 a, Floats8 b) { return {{max(a.r[0], b.r[0]), max(a.r[1], b.r[1])}}; }
inline Floats8 min(Floats8 a, Floats8 b) { return {{min(a.r[0], b.r[0]), min(a.r[1], b.r[1])}}; }
inline Floats8 absolute(Floats8 a) {
  alignas(32) float x[8];
  a.store(x);
  for (float& f : x) f = f < 0 ? -f : f;
  return Floats8::load(x);
}
inline std::uint32_t bits_le(Floats8 a, Floats8 b) {
  return bits_le(a.r[0], b.r[0]) | bits_le(a.r[1], b.r[1]) << 4;
}
inline std::uint32_t bits_lt(Floats8 a, Floats8 b) {
  alignas(32) float x[8], y[8];
  a.store(x), b.store(y);
  std::uint32_t bits = 0;
  for (int i = 0; i < 8; ++i) bits |= (x[i] < y[i] ? 1u : 0u) << i;
  return bits;
}

#endif

/// Of numbers that are not NaN.
inline float smallest(Floats8 a) { return smallest(min(a.low(), a.high())); }

}  // namespace treeline::accel::simd
