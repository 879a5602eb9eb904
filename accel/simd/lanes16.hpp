// Sixteen floats or ints side by side, whatever the width of the machine's registers.
#pragma once

#include <bit>
#include <cstddef>

#include "accel/simd/registers.hpp"

namespace treeline::accel::simd {

inline constexpr int lanes = 16;

struct Floats16 {
  static constexpr int regs = lanes / float_width;
  FloatReg r[regs];

  static Floats16 load(const float* p) {
    return each([&](int i) { return simd::load(p + i * float_width); });
  }
  static Floats16 broadcast(float x) {
    return each([reg = simd::broadcast(x)](int) { return reg; });
  }
  void store(float* p) const {
    for (int i = 0; i < regs; ++i) simd::store(p + i * float_width, r[i]);
  }
  template <class F>
  static Floats16 each(F f) {
    Floats16 out;
    for (int i = 0; i < regs; ++i) out.r[i] = f(i);
    return out;
  }

  friend Floats16 operator+(const Floats16& a, const Floats16& b) {
    return each([&](int i) { return simd::add(a.r[i], b.r[i]); });
  }
  friend Floats16 operator-(const Floats16& a, const Floats16& b) {
    return each([&](int i) { return simd::sub(a.r[i], b.r[i]); });
  }
  /// Rounded by itself, never fused into a sum.
  friend Floats16 operator*(const Floats16& a, const Floats16& b) {
    return each([&](int i) { return simd::mul(a.r[i], b.r[i]); });
  }
};

/// b where either is NaN.
inline Floats16 max(const Floats16& a, const Floats16& b) {
  return Floats16::each([&](int i) { return simd::max(a.r[i], b.r[i]); });
}
inline Floats16 min(const Floats16& a, const Floats16& b) {
  return Floats16::each([&](int i) { return simd::min(a.r[i], b.r[i]); });
}
/// One bit a lane.
inline std::uint32_t bits_le(const Floats16& a, const Floats16& b) {
  std::uint32_t bits = 0;
  for (int i = 0; i < Floats16::regs; ++i) bits |= bits_le(a.r[i], b.r[i]) << (i * float_width);
  return bits;
}

struct Ints16 {
  static constexpr int regs = lanes / float_width;
  IntReg r[regs];

  static Ints16 load(const std::int32_t* p) {
    return each([&](int i) { return simd::load(p + i * float_width); });
  }
  static Ints16 broadcast(std::int32_t x) {
    return each([reg = simd::broadcast(x)](int) { return reg; });
  }
  void store(std::int32_t* p) const {
    for (int i = 0; i < regs; ++i) simd::store(p + i * float_width, r[i]);
  }
  template <class F>
  static Ints16 each(F f) {
    Ints16 out;
    for (int i = 0; i < regs; ++i) out.r[i] = f(i);
    return out;
  }
};

inline Ints16 as_ints(const Floats16& a) {
  return Ints16::each([&](int i) { return simd::as_ints(a.r[i]); });
}
/// count + 1 in the lanes where a <= b.
inline Ints16 counted_le(const Ints16& count, const Floats16& a, const Floats16& b) {
  return Ints16::each([&](int i) { return simd::counted_le(count.r[i], a.r[i], b.r[i]); });
}
/// a in the lanes where count > limit, else b.
inline Floats16 chosen(const Ints16& count, std::int32_t limit, const Floats16& a, const Floats16& b) {
  return Floats16::each([&](int i) { return simd::chosen(count.r[i], limit, a.r[i], b.r[i]); });
}
inline std::uint32_t bits_le(const Ints16& a, const Ints16& b) {
  std::uint32_t bits = 0;
  for (int i = 0; i < Ints16::regs; ++i) bits |= bits_le(a.r[i], b.r[i]) << (i * float_width);
  return bits;
}
inline float smallest(const Floats16& a) {
  alignas(64) float x[lanes];
  a.store(x);
  for (int half = lanes / 2; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) x[i] = x[i + half] < x[i] ? x[i + half] : x[i];
  return x[0];
}
inline std::int32_t smallest(const Ints16& a) {
  IntReg m = a.r[0];
  for (int i = 1; i < Ints16::regs; ++i) m = simd::min(m, a.r[i]);
  return simd::smallest(m);
}
/// value in the lanes that equal x.
inline Ints16 replaced(const Ints16& a, std::int32_t x, std::int32_t value) {
  const IntReg xs = simd::broadcast(x), values = simd::broadcast(value);
  return Ints16::each([&](int i) { return simd::replaced(a.r[i], xs, values); });
}

alignas(64) inline constexpr std::int32_t lane_numbers[lanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                                 8, 9, 10, 11, 12, 13, 14, 15};
inline constexpr std::int32_t lane_mask = lanes - 1;

/// Non-negative floats as ints of the same order, with the lane's number in place of the last four bits:
/// rounded down, so a lower bound stays one, and all different.
inline Ints16 tagged(const Floats16& a) {
  const Ints16 number = Ints16::load(lane_numbers);
  const IntReg keep = simd::broadcast(~lane_mask);
  return Ints16::each(
      [&](int i) { return simd::bit_or(simd::bit_and(simd::as_ints(a.r[i]), keep), number.r[i]); });
}

/// Writes the ids whose bit is set, in order, and returns how many; room for all 16 is needed.
inline std::size_t store_set(std::uint32_t bits, const std::uint32_t* ids, std::uint32_t* out) {
#if TREELINE_SIMD == 512
  _mm512_storeu_si512(out,
                      _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), _mm512_loadu_si512(ids)));
  return static_cast<std::size_t>(std::popcount(bits));
#else
  std::size_t count = 0;
  for (; bits != 0; bits &= bits - 1) out[count++] = ids[std::countr_zero(bits)];
  return count;
#endif
}

}  // namespace treeline::accel::simd
