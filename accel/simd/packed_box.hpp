// A box in space as eight floats, the low corner negated, so that one instruction of the machine grows it.
//
// Lanes 3 and 7 belong to the caller: in memory they carry what goes with the box (the number of a triangle,
// links of a node), in a register they hold what came with the last operand and mean nothing.
#pragma once

#include <bit>

#include "accel/simd/registers.hpp"
#include "geometry/box.hpp"

namespace treeline::accel::simd {

/// In memory; trivial, so that arrays of it need not be cleared.
struct alignas(TREELINE_SIMD >= 256 ? 32 : 16) BoxLanes {
  float v[8];

  std::uint32_t tag(int i) const { return std::bit_cast<std::uint32_t>(v[i ? 7 : 3]); }
  void set_tag(int i, std::uint32_t x) { v[i ? 7 : 3] = std::bit_cast<float>(x); }
  geometry::Box3f box() const { return {{-v[0], -v[1], -v[2]}, {v[4], v[5], v[6]}}; }
  float low(int axis) const { return -v[axis]; }
  float high(int axis) const { return v[4 + axis]; }
  /// Twice the centre.
  float sum(int axis) const { return v[4 + axis] - v[axis]; }
};

struct PackedBox {
  using Four = float __attribute__((vector_size(16)));

#if TREELINE_SIMD >= 256
  __m256 r;

  static PackedBox load(const BoxLanes& a) { return {_mm256_load_ps(a.v)}; }
  void store(BoxLanes& a) const { _mm256_store_ps(a.v, r); }
  static PackedBox of(Four negated_low, Four high) {
    return {_mm256_insertf128_ps(_mm256_castps128_ps256(negated_low), high, 1)};
  }
  static PackedBox empty() { return {_mm256_set1_ps(-std::numeric_limits<float>::infinity())}; }
  friend PackedBox merged(PackedBox a, PackedBox b) { return {_mm256_max_ps(a.r, b.r)}; }
  friend PackedBox intersection(PackedBox a, PackedBox b) { return {_mm256_min_ps(a.r, b.r)}; }
  /// The box of twice a box's centre.
  PackedBox centre() const {
    const __m256 other = _mm256_permute2f128_ps(r, r, 0x01);
    return {_mm256_sub_ps(r, other)};
  }
#else
  using Half = decltype(simd::broadcast(0.0f));
  Half low, high;

  static PackedBox load(const BoxLanes& a) { return {simd::load(a.v), simd::load(a.v + 4)}; }
  void store(BoxLanes& a) const { simd::store(a.v, low), simd::store(a.v + 4, high); }
  static PackedBox of(Four negated_low, Four high) { return {negated_low, high}; }
  static PackedBox empty() {
    const Half none = simd::broadcast(-std::numeric_limits<float>::infinity());
    return {none, none};
  }
  friend PackedBox merged(PackedBox a, PackedBox b) {
    return {simd::max(a.low, b.low), simd::max(a.high, b.high)};
  }
  friend PackedBox intersection(PackedBox a, PackedBox b) {
    return {simd::min(a.low, b.low), simd::min(a.high, b.high)};
  }
  PackedBox centre() const { return {simd::sub(low, high), simd::sub(high, low)}; }
#endif

  /// Half the area of the box times scale; not of an empty one.
  float half_area(float scale) const {
#if TREELINE_SIMD >= 128
#if TREELINE_SIMD >= 256
    const __m128 sum = _mm_add_ps(_mm256_castps256_ps128(r), _mm256_extractf128_ps(r, 1));
#else
    const __m128 sum = _mm_add_ps(low, high);
#endif
    // The last lane is cleared: as floats, what lies there may be slow to multiply.
    const __m128 e = _mm_mul_ps(_mm_blend_ps(sum, _mm_setzero_ps(), 8), _mm_set1_ps(scale));
    const __m128 p = _mm_mul_ps(e, _mm_shuffle_ps(e, e, _MM_SHUFFLE(3, 0, 2, 1)));
    const __m128 q = _mm_add_ps(p, _mm_movehl_ps(p, p));
    return _mm_cvtss_f32(_mm_add_ss(q, _mm_shuffle_ps(p, p, _MM_SHUFFLE(1, 1, 1, 1))));
#else
    BoxLanes a;
    store(a);
    const float x = (a.v[0] + a.v[4]) * scale, y = (a.v[1] + a.v[5]) * scale, z = (a.v[2] + a.v[6]) * scale;
    return x * y + z * x + y * z;
#endif
  }

  /// For each axis the cell of a grid, min((x - origin) scale, last), in which twice the centre lies.
  void bins_of_sum(const float* origin, const float* scale, std::int32_t last, std::int32_t* bin) const {
#if TREELINE_SIMD >= 256
    const __m128 sum = _mm_sub_ps(_mm256_extractf128_ps(r, 1), _mm256_castps256_ps128(r));
    store_bins(sum, origin, scale, last, bin);
#else
    store_bins(simd::sub(high, low), origin, scale, last, bin);
#endif
  }
  /// The cells of its corners.
  void bins(const float* origin, const float* scale, std::int32_t last, std::int32_t* of_low,
            std::int32_t* of_high) const {
#if TREELINE_SIMD >= 256
    store_bins(_mm_sub_ps(_mm_setzero_ps(), _mm256_castps256_ps128(r)), origin, scale, last, of_low);
    store_bins(_mm256_extractf128_ps(r, 1), origin, scale, last, of_high);
#else
    store_bins(simd::sub(simd::broadcast(0.0f), low), origin, scale, last, of_low);
    store_bins(high, origin, scale, last, of_high);
#endif
  }

  BoxLanes lanes() const {
    BoxLanes a;
    store(a);
    return a;
  }

 private:
#if TREELINE_SIMD >= 128
  static void store_bins(__m128 x, const float* origin, const float* scale, std::int32_t last,
                         std::int32_t* bin) {
    const __m128 from = _mm_blend_ps(_mm_sub_ps(x, _mm_loadu_ps(origin)), _mm_setzero_ps(), 8);  // as above
    const __m128 cell = _mm_mul_ps(from, _mm_loadu_ps(scale));
    const __m128i i = _mm_min_epi32(_mm_cvttps_epi32(cell), _mm_set1_epi32(last));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(bin), _mm_max_epi32(i, _mm_setzero_si128()));
  }
#else
  static void store_bins(Half x, const float* origin, const float* scale, std::int32_t last,
                         std::int32_t* bin) {
    for (int i = 0; i < 3; ++i) {
      const float cell = (x[i] - origin[i]) * scale[i];
      bin[i] = cell > 0 ? static_cast<std::int32_t>(std::min(cell, static_cast<float>(last))) : 0;
    }
  }
#endif
};

inline BoxLanes packed(const geometry::Box3f& b) {
  return {{-b.low[0], -b.low[1], -b.low[2], 0, b.high[0], b.high[1], b.high[2], 0}};
}

}  // namespace treeline::accel::simd
