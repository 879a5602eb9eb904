// Four floats side by side: a point, or a corner of a box, with a lane to spare.
#pragma once

#include <cstdint>

#include "accel/simd/registers.hpp"

namespace treeline::accel::simd {

#if TREELINE_SIMD > 0
struct Floats4 {
  __m128 r;

  static Floats4 load(const float* p) { return {_mm_loadu_ps(p)}; }
  static Floats4 broadcast(float x) { return {_mm_set1_ps(x)}; }
  void store(float* p) const { _mm_storeu_ps(p, r); }
  friend Floats4 operator+(Floats4 a, Floats4 b) { return {_mm_add_ps(a.r, b.r)}; }
  friend Floats4 operator-(Floats4 a, Floats4 b) { return {_mm_sub_ps(a.r, b.r)}; }
  friend Floats4 operator*(Floats4 a, Floats4 b) {
    __m128 r = _mm_mul_ps(a.r, b.r);
    asm("" : "+x"(r));
    return {r};
  }
  /// Towards zero.
  void store_truncated(std::int32_t* p) const {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(p), _mm_cvttps_epi32(r));
  }
  /// Lanes 1, 2, 0, 3.
  Floats4 rotated() const { return {_mm_shuffle_ps(r, r, _MM_SHUFFLE(3, 0, 2, 1))}; }
  float sum_of_three() const {
    return _mm_cvtss_f32(_mm_add_ss(_mm_add_ss(r, _mm_movehdup_ps(r)), _mm_movehl_ps(r, r)));
  }
};
/// b where either is NaN.
inline Floats4 min(Floats4 a, Floats4 b) { return {_mm_min_ps(a.r, b.r)}; }
inline Floats4 max(Floats4 a, Floats4 b) { return {_mm_max_ps(a.r, b.r)}; }
inline Floats4 operator/(Floats4 a, Floats4 b) { return {_mm_div_ps(a.r, b.r)}; }
inline Floats4 absolute(Floats4 a) { return {_mm_and_ps(a.r, _mm_castsi128_ps(_mm_set1_epi32(0x7fffffff)))}; }
/// One bit a lane: whether its sign is negative.
inline std::uint32_t sign_bits(Floats4 a) { return static_cast<std::uint32_t>(_mm_movemask_ps(a.r)); }
/// a where m is negative, else b.
inline Floats4 where_negative(Floats4 m, Floats4 a, Floats4 b) { return {_mm_blendv_ps(b.r, a.r, m.r)}; }
/// One bit a lane; no bit where either is NaN.
inline std::uint32_t bits_le(Floats4 a, Floats4 b) {
  return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmple_ps(a.r, b.r)));
}
inline std::uint32_t bits_lt(Floats4 a, Floats4 b) {
  return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmplt_ps(a.r, b.r)));
}
/// Of numbers that are not NaN.
inline float smallest(Floats4 a) {
  const __m128 two = _mm_min_ps(a.r, _mm_movehl_ps(a.r, a.r));
  return _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps(two, two, 1)));
}
#else
struct Floats4 {
  FloatReg r;

  static Floats4 load(const float* p) { return {simd::load(p)}; }
  static Floats4 broadcast(float x) { return {simd::broadcast(x)}; }
  void store(float* p) const { simd::store(p, r); }
  friend Floats4 operator+(Floats4 a, Floats4 b) { return {a.r + b.r}; }
  friend Floats4 operator-(Floats4 a, Floats4 b) { return {a.r - b.r}; }
  friend Floats4 operator*(Floats4 a, Floats4 b) { return {mul(a.r, b.r)}; }
  void store_truncated(std::int32_t* p) const {
    for (int i = 0; i < 4; ++i) p[i] = static_cast<std::int32_t>(r[i]);
  }
  Floats4 rotated() const { return {FloatReg{r[1], r[2], r[0], r[3]}}; }
  float sum_of_three() const { return r[0] + r[1] + r[2]; }
};
inline Floats4 min(Floats4 a, Floats4 b) { return {min(a.r, b.r)}; }
inline Floats4 max(Floats4 a, Floats4 b) { return {max(a.r, b.r)}; }
inline Floats4 operator/(Floats4 a, Floats4 b) { return {a.r / b.r}; }
inline Floats4 absolute(Floats4 a) {
  return {reinterpret_cast<FloatReg>(as_ints(a.r) & broadcast(std::int32_t{0x7fffffff}))};
}
inline std::uint32_t sign_bits(Floats4 a) { return bits_set(as_ints(a.r) >> 31); }
inline Floats4 where_negative(Floats4 m, Floats4 a, Floats4 b) {
  return {as_ints(m.r) < broadcast(std::int32_t{0}) ? a.r : b.r};
}
inline std::uint32_t bits_le(Floats4 a, Floats4 b) { return bits_le(a.r, b.r); }
inline std::uint32_t bits_lt(Floats4 a, Floats4 b) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 4; ++i) bits |= (a.r[i] < b.r[i] ? 1u : 0u) << i;
  return bits;
}
inline float smallest(Floats4 a) {
  const float x = a.r[0] < a.r[2] ? a.r[0] : a.r[2], y = a.r[1] < a.r[3] ? a.r[1] : a.r[3];
  return x < y ? x : y;
}
#endif

}  // namespace treeline::accel::simd
