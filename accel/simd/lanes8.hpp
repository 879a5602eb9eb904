// Eight floats side by side, whatever the width of the machine's registers, and eight keys that sort
// themselves.
//
// Nothing here fuses or rounds twice, and keys that are equal do not occur, so kernels compute the same on
// every instruction set, bit for bit.
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

/// Writes the items whose bit is set, in order, and returns how many; room for all 8 is needed.
inline int store_set8(std::uint32_t bits, const std::uint32_t* items, std::uint32_t* out) {
#if TREELINE_SIMD == 512
  _mm256_storeu_si256(
      reinterpret_cast<__m256i*>(out),
      _mm256_maskz_compress_epi32(static_cast<__mmask8>(bits),
                                  _mm256_loadu_si256(reinterpret_cast<const __m256i*>(items))));
  return std::popcount(bits);
#else
  int count = 0;
  for (; bits != 0; bits &= bits - 1) out[count++] = items[std::countr_zero(bits)];
  return count;
#endif
}

/// Sort keys of up to eight things of which some are chosen: a distance, not negative, rounded down to make
/// room for the number of the lane, so that no two are equal. As floats they are lower bounds.
class Keys8 {
 public:
#if TREELINE_SIMD >= 256
  /// Of the lanes whose bit is set.
  Keys8(Floats8 distance, std::uint32_t chosen) {
    const __m256i lane = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    const __m256i bits = _mm256_castps_si256(_mm256_max_ps(distance.r, _mm256_setzero_ps()));
#if TREELINE_SIMD == 512
    // (bits & ~7) | lane, and all ones in the other lanes.
    const __m256i all = _mm256_set1_epi32(-1);
    r_ = _mm256_mask_ternarylogic_epi32(all, static_cast<__mmask8>(chosen), all, all, 0xff);
    r_ = _mm256_mask_or_epi32(r_, static_cast<__mmask8>(chosen),
                              _mm256_and_si256(bits, _mm256_set1_epi32(~7)), lane);
#else
    const __m256i masked = _mm256_or_si256(_mm256_and_si256(bits, _mm256_set1_epi32(~7)), lane);
    const __m256i picks = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const __m256i is_chosen =
        _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(chosen)), picks), picks);
    r_ = _mm256_blendv_epi8(_mm256_set1_epi32(-1), masked, is_chosen);
#endif
  }
  std::uint32_t nearest() const {
    __m128i q = _mm_min_epu32(_mm256_castsi256_si128(r_), _mm256_extracti128_si256(r_, 1));
    q = _mm_min_epu32(q, _mm_shuffle_epi32(q, 0b01001110));
    q = _mm_min_epu32(q, _mm_shuffle_epi32(q, 0b10110001));
    return static_cast<std::uint32_t>(_mm_cvtsi128_si32(q));
  }
  /// Writes the keys, farthest first, and beside them what is theirs of `items`; eight places are written.
  void write_sorted(const std::uint32_t* items, std::uint32_t* keys, std::uint32_t* out) const {
    // Bitonic (Batcher 1968), each merge opened by a reversal. Lanes that are not chosen are negative: last.
    __m256i x = r_;
    x = exchanged<0b10101010>(x, _mm256_shuffle_epi32(x, 0b10110001));
    x = exchanged<0b11001100>(x, _mm256_shuffle_epi32(x, 0b00011011));
    x = exchanged<0b10101010>(x, _mm256_shuffle_epi32(x, 0b10110001));
    x = exchanged<0b11110000>(x, _mm256_permutevar8x32_epi32(x, _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0)));
    x = exchanged<0b11001100>(x, _mm256_shuffle_epi32(x, 0b01001110));
    x = exchanged<0b10101010>(x, _mm256_shuffle_epi32(x, 0b10110001));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(keys), x);
    const __m256i all = _mm256_load_si256(reinterpret_cast<const __m256i*>(items));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_permutevar8x32_epi32(all, x));
  }

 private:
  /// The larger of each pair goes to the lane whose bit is clear.
  template <int low>
  static __m256i exchanged(__m256i x, __m256i partner) {
    return _mm256_blend_epi32(_mm256_max_epi32(x, partner), _mm256_min_epi32(x, partner), low);
  }
  __m256i r_;
#else
  Keys8(Floats8 distance, std::uint32_t chosen) {
    alignas(32) float x[8];
    distance.store(x);
    for (; chosen != 0; chosen &= chosen - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(chosen));
      const std::uint32_t key = (std::bit_cast<std::uint32_t>(x[lane] > 0 ? x[lane] : 0.0f) & ~7u) | lane;
      int i = count_++;
      for (; i > 0 && key_[i - 1] < key; --i) key_[i] = key_[i - 1];
      key_[i] = key;
    }
  }
  std::uint32_t nearest() const { return key_[count_ - 1]; }
  void write_sorted(const std::uint32_t* items, std::uint32_t* keys, std::uint32_t* out) const {
    for (int i = 0; i < count_; ++i) keys[i] = key_[i], out[i] = items[key_[i] & 7u];
  }

 private:
  std::uint32_t key_[8];
  int count_ = 0;
#endif
};

}  // namespace treeline::accel::simd
