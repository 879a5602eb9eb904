// Of 4, 8 or 16 things side by side: which are taken, and in order of which distance.
//
// Keys that are equal do not occur, so the order is the same on every instruction set. Where registers are
// wide enough a sorting network does it without a branch (Batcher 1968), else one after the other.
#pragma once

#include <array>
#include <bit>
#include <cstddef>

#include "accel/simd/lanes16.hpp"
#include "accel/simd/lanes8.hpp"

namespace treeline::accel::simd {

template <int N>
struct FloatsOf;
template <>
struct FloatsOf<4> {
  using Type = Floats4;
};
template <>
struct FloatsOf<8> {
  using Type = Floats8;
};
template <>
struct FloatsOf<16> {
  using Type = Floats16;
};
/// N floats side by side: 4, 8 or 16.
template <int N>
using Floats = typename FloatsOf<N>::Type;

#if TREELINE_SIMD == 256
namespace detail {
/// For each of 256 sets of lanes: their numbers, in order, a byte each.
inline constexpr std::array<std::uint64_t, 256> lanes_of = [] {
  std::array<std::uint64_t, 256> all{};
  for (std::uint32_t set = 0; set < 256; ++set)
    for (std::uint32_t lane = 0, at = 0; lane < 8; ++lane)
      if ((set >> lane & 1) != 0) all[set] |= std::uint64_t{lane} << (8 * at++);
  return all;
}();
}  // namespace detail
#endif

/// Writes those of N items whose bit is set, in order, and returns how many; room for all N is needed.
template <int N>
int store_chosen(std::uint32_t bits, const std::uint32_t* items, std::uint32_t* out) {
#if TREELINE_SIMD == 512
  if constexpr (N == 4)
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out),
                     _mm_maskz_compress_epi32(static_cast<__mmask8>(bits),
                                              _mm_loadu_si128(reinterpret_cast<const __m128i*>(items))));
  if constexpr (N == 8)
    _mm256_storeu_si256(
        reinterpret_cast<__m256i*>(out),
        _mm256_maskz_compress_epi32(static_cast<__mmask8>(bits),
                                    _mm256_loadu_si256(reinterpret_cast<const __m256i*>(items))));
  if constexpr (N == 16)
    _mm512_storeu_si512(out,
                        _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), _mm512_loadu_si512(items)));
  return std::popcount(bits);
#else
#if TREELINE_SIMD == 256
  if constexpr (N == 8) {
    const __m256i lanes =
        _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(detail::lanes_of[bits])));
    _mm256_storeu_si256(
        reinterpret_cast<__m256i*>(out),
        _mm256_permutevar8x32_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(items)), lanes));
    return std::popcount(bits);
  }
#endif
  int count = 0;
  for (; bits != 0; bits &= bits - 1) out[count++] = items[std::countr_zero(bits)];
  return count;
#endif
}

/// Sort keys of up to N things of which some are chosen: a distance, not negative, rounded down to make room
/// for the number of the lane, so that no two are equal. As floats they are lower bounds.
template <int N>
class Keys {
 public:
  Keys(const Floats<N>& distance, std::uint32_t chosen) {
    alignas(64) float x[N];
    distance.store(x);
    for (; chosen != 0; chosen &= chosen - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(chosen));
      const std::uint32_t key = (std::bit_cast<std::uint32_t>(x[lane] > 0 ? x[lane] : 0.0f) & ~mask) | lane;
      int i = count_++;
      for (; i > 0 && key_[i - 1] < key; --i) key_[i] = key_[i - 1];
      key_[i] = key;
    }
  }
  /// The lane of the least key.
  std::uint32_t nearest() const { return key_[count_ - 1] & mask; }
  /// Writes the keys, farthest first, and beside them what is theirs of `items`; N places may be written.
  void write_sorted(const std::uint32_t* items, std::uint32_t* keys, std::uint32_t* out) const {
    for (int i = 0; i < count_; ++i) keys[i] = key_[i], out[i] = items[key_[i] & mask];
  }

 private:
  static constexpr std::uint32_t mask = N - 1;
  std::uint32_t key_[N];
  int count_ = 0;
};

#if TREELINE_SIMD >= 256

namespace detail {
inline std::uint32_t least(__m128i q) {
  q = _mm_min_epu32(q, _mm_shuffle_epi32(q, 0b01001110));
  q = _mm_min_epu32(q, _mm_shuffle_epi32(q, 0b10110001));
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(q));
}
/// The larger of each pair goes to the lane whose bit is clear.
template <int low>
__m256i exchanged(__m256i x, __m256i partner) {
  return _mm256_blend_epi32(_mm256_max_epi32(x, partner), _mm256_min_epi32(x, partner), low);
}
template <int low>
__m128i exchanged(__m128i x, __m128i partner) {
  return _mm_blend_epi32(_mm_max_epi32(x, partner), _mm_min_epi32(x, partner), low);
}
/// Bitonic, each merge opened by a reversal; the largest first. Lanes of all ones are negative: last.
inline __m256i sorted(__m256i x) {
  x = exchanged<0b10101010>(x, _mm256_shuffle_epi32(x, 0b10110001));
  x = exchanged<0b11001100>(x, _mm256_shuffle_epi32(x, 0b00011011));
  x = exchanged<0b10101010>(x, _mm256_shuffle_epi32(x, 0b10110001));
  x = exchanged<0b11110000>(x, _mm256_permutevar8x32_epi32(x, _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0)));
  x = exchanged<0b11001100>(x, _mm256_shuffle_epi32(x, 0b01001110));
  return exchanged<0b10101010>(x, _mm256_shuffle_epi32(x, 0b10110001));
}
inline __m128i sorted(__m128i x) {
  x = exchanged<0b1010>(x, _mm_shuffle_epi32(x, 0b10110001));
  x = exchanged<0b1100>(x, _mm_shuffle_epi32(x, 0b00011011));
  return exchanged<0b1010>(x, _mm_shuffle_epi32(x, 0b10110001));
}
}  // namespace detail

template <>
class Keys<4> {
 public:
  Keys(const Floats4& distance, std::uint32_t chosen) {
    const __m128i bits = _mm_castps_si128(_mm_max_ps(distance.r, _mm_setzero_ps()));
    const __m128i keys = _mm_or_si128(_mm_and_si128(bits, _mm_set1_epi32(~3)), _mm_setr_epi32(0, 1, 2, 3));
    const __m128i picks = _mm_setr_epi32(1, 2, 4, 8);
    const __m128i is_chosen =
        _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(static_cast<int>(chosen)), picks), picks);
    r_ = _mm_blendv_epi8(_mm_set1_epi32(-1), keys, is_chosen);
  }
  std::uint32_t nearest() const { return detail::least(r_) & 3u; }
  void write_sorted(const std::uint32_t* items, std::uint32_t* keys, std::uint32_t* out) const {
    const __m128i x = detail::sorted(r_);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(keys), x);
    const __m128 all = _mm_load_ps(reinterpret_cast<const float*>(items));
    _mm_storeu_ps(reinterpret_cast<float*>(out), _mm_permutevar_ps(all, x));
  }

 private:
  __m128i r_;
};

template <>
class Keys<8> {
 public:
  Keys(const Floats8& distance, std::uint32_t chosen) {
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
    return detail::least(_mm_min_epu32(_mm256_castsi256_si128(r_), _mm256_extracti128_si256(r_, 1))) & 7u;
  }
  void write_sorted(const std::uint32_t* items, std::uint32_t* keys, std::uint32_t* out) const {
    const __m256i x = detail::sorted(r_);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(keys), x);
    const __m256i all = _mm256_load_si256(reinterpret_cast<const __m256i*>(items));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_permutevar8x32_epi32(all, x));
  }

 private:
  __m256i r_;
};

#endif

#if TREELINE_SIMD == 512

/// As a rule at most eight of sixteen are chosen: those are moved together and sorted as eight.
template <>
class Keys<16> {
 public:
  Keys(const Floats16& distance, std::uint32_t chosen) : count_(std::popcount(chosen)) {
    const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const __m512i bits = _mm512_castps_si512(max(distance.r[0], _mm512_setzero_ps()));
    const __m512i keys = _mm512_or_si512(_mm512_and_si512(bits, _mm512_set1_epi32(~15)), lane);
    r_ = _mm512_mask_compress_epi32(_mm512_set1_epi32(-1), static_cast<__mmask16>(chosen), keys);
  }
  std::uint32_t nearest() const {
    const __m256i h = _mm256_min_epu32(low_half(r_), _mm512_maskz_extracti64x4_epi64(all8, r_, 1));
    return detail::least(_mm_min_epu32(_mm256_castsi256_si128(h), _mm256_extracti128_si256(h, 1))) & 15u;
  }
  void write_sorted(const std::uint32_t* items, std::uint32_t* keys, std::uint32_t* out) const {
    if (count_ > 8) return write_many(items, keys, out);
    const __m256i x = detail::sorted(low_half(r_));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(keys), x);
    const __m512i all = _mm512_loadu_si512(items);
    _mm256_storeu_si256(
        reinterpret_cast<__m256i*>(out),
        low_half(_mm512_maskz_permutexvar_epi32(all16, _mm512_maskz_broadcast_i64x4(all8, x), all)));
  }

 private:
  static __m256i low_half(__m512i x) { return _mm512_maskz_extracti64x4_epi64(all8, x, 0); }
  void write_many(const std::uint32_t* items, std::uint32_t* keys, std::uint32_t* out) const {
    alignas(64) std::uint32_t key[16];
    _mm512_store_si512(key, r_);
    for (int i = 0; i < count_; ++i) {
      int j = i;
      for (; j > 0 && keys[j - 1] < key[i]; --j) keys[j] = keys[j - 1];
      keys[j] = key[i];
    }
    for (int i = 0; i < count_; ++i) out[i] = items[keys[i] & 15u];
  }

  __m512i r_;
  int count_;
};

#endif

}  // namespace treeline::accel::simd
