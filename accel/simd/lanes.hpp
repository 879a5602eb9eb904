// Eight numbers side by side, float or double, on whatever registers there are: for kernels that are written
// once, over a number type, and run both on single numbers (geometry::Rounded) and on eight at a time.
//
// Every operation rounds as the same operation on single numbers does, and products are never fused into
// sums: eight lanes give the bits that eight single numbers give.
#pragma once

#include <algorithm>

#include "accel/simd/registers.hpp"

namespace treeline::accel::simd {

#if TREELINE_SIMD == 512
inline constexpr int register_bytes = 64;
#elif TREELINE_SIMD == 256
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif

template <class T>
struct Lanes {
  static constexpr int count = 8;
  static constexpr int bytes = std::min<int>(register_bytes, count * sizeof(T));
  static constexpr int width = bytes / static_cast<int>(sizeof(T));
  static constexpr int regs = count / width;
  typedef T Reg __attribute__((vector_size(bytes)));
  using Flags = decltype(Reg{} < Reg{});  // lanes of all ones or all zeros

  /// Yes or no in each lane.
  struct Mask {
    Flags m[regs];

    friend Mask operator|(Mask a, const Mask& b) {
      for (int i = 0; i < regs; ++i) a.m[i] |= b.m[i];
      return a;
    }
    friend Mask operator&(Mask a, const Mask& b) {
      for (int i = 0; i < regs; ++i) a.m[i] &= b.m[i];
      return a;
    }
    /// One bit a lane.
    std::uint32_t bits() const {
      std::uint32_t all = 0;
      for (int i = 0; i < regs; ++i) all |= bits_of(m[i]) << (i * width);
      return all;
    }
  };

  Reg r[regs];

  static Lanes load(const T* p) {
    Lanes a;
    std::memcpy(a.r, p, sizeof a.r);
    return a;
  }
  static Lanes broadcast(T x) {
    Lanes a;
    for (int i = 0; i < regs; ++i) a.r[i] = x - Reg{};
    return a;
  }

  friend Lanes operator+(Lanes a, const Lanes& b) {
    for (int i = 0; i < regs; ++i) a.r[i] += b.r[i];
    return a;
  }
  friend Lanes operator-(Lanes a, const Lanes& b) {
    for (int i = 0; i < regs; ++i) a.r[i] -= b.r[i];
    return a;
  }
  friend Lanes operator*(Lanes a, const Lanes& b) {
    for (int i = 0; i < regs; ++i) {
      a.r[i] *= b.r[i];
#if defined(__x86_64__)
      asm("" : "+x"(a.r[i]));
#else
      asm("" : "+m"(a.r[i]));
#endif
    }
    return a;
  }
  friend Lanes operator/(Lanes a, const Lanes& b) {
    for (int i = 0; i < regs; ++i) a.r[i] /= b.r[i];
    return a;
  }
  // Where either is NaN: no.
  friend Mask operator<(const Lanes& a, const Lanes& b) {
    Mask m;
    for (int i = 0; i < regs; ++i) m.m[i] = a.r[i] < b.r[i];
    return m;
  }
  friend Mask operator<=(const Lanes& a, const Lanes& b) {
    Mask m;
    for (int i = 0; i < regs; ++i) m.m[i] = a.r[i] <= b.r[i];
    return m;
  }
  // b where either is NaN.
  friend Lanes min(Lanes a, const Lanes& b) {
    for (int i = 0; i < regs; ++i) a.r[i] = a.r[i] < b.r[i] ? a.r[i] : b.r[i];
    return a;
  }
  friend Lanes max(Lanes a, const Lanes& b) {
    for (int i = 0; i < regs; ++i) a.r[i] = a.r[i] > b.r[i] ? a.r[i] : b.r[i];
    return a;
  }
  /// a where the mask says yes, else b.
  friend Lanes chosen(const Mask& m, Lanes a, const Lanes& b) {
    for (int i = 0; i < regs; ++i) a.r[i] = m.m[i] ? a.r[i] : b.r[i];
    return a;
  }
  void store(T* p) const { std::memcpy(p, r, sizeof r); }

 private:
  static std::uint32_t bits_of(const Flags& flags) {
#if TREELINE_SIMD > 0
    if constexpr (bytes == 16 && width == 4)
      return static_cast<std::uint32_t>(_mm_movemask_ps((__m128)flags));
    if constexpr (bytes == 16 && width == 2)
      return static_cast<std::uint32_t>(_mm_movemask_pd((__m128d)flags));
#endif
#if TREELINE_SIMD >= 256
    if constexpr (bytes == 32 && width == 8)
      return static_cast<std::uint32_t>(_mm256_movemask_ps((__m256)flags));
    if constexpr (bytes == 32 && width == 4)
      return static_cast<std::uint32_t>(_mm256_movemask_pd((__m256d)flags));
#endif
#if TREELINE_SIMD == 512
    if constexpr (bytes == 64 && width == 8) return _mm512_movepi64_mask((__m512i)flags);
#endif
    std::uint32_t bits = 0;
    for (int i = 0; i < width; ++i) bits |= flags[i] ? 1u << i : 0u;
    return bits;
  }
};

}  // namespace treeline::accel::simd
