// Sixteen doubles side by side, whatever the width of the machine's registers.
#pragma once

#include <bit>
#include <cstddef>

#include "accel/concepts.hpp"
#include "accel/simd/lanes16.hpp"

namespace treeline::accel::simd {

struct Doubles16 {
  static constexpr int regs = lanes / double_width;
  DoubleReg r[regs];

  static Doubles16 load(const double* p) {
    return each([&](int i) { return simd::load(p + i * double_width); });
  }
  static Doubles16 broadcast(double x) {
    return each([reg = simd::broadcast(x)](int) { return reg; });
  }
  void store(double* p) const {
    for (int i = 0; i < regs; ++i) simd::store(p + i * double_width, r[i]);
  }
  template <class F>
  static Doubles16 each(F f) {
    Doubles16 out;
    for (int i = 0; i < regs; ++i) out.r[i] = f(i);
    return out;
  }

  friend Doubles16 operator+(const Doubles16& a, const Doubles16& b) {
    return each([&](int i) { return simd::add(a.r[i], b.r[i]); });
  }
  friend Doubles16 operator-(const Doubles16& a, const Doubles16& b) {
    return each([&](int i) { return simd::sub(a.r[i], b.r[i]); });
  }
  /// Rounded by itself, never fused into a sum.
  friend Doubles16 operator*(const Doubles16& a, const Doubles16& b) {
    return each([&](int i) { return simd::mul(a.r[i], b.r[i]); });
  }
};

/// b where either is NaN.
inline Doubles16 max(const Doubles16& a, const Doubles16& b) {
  return Doubles16::each([&](int i) { return simd::max(a.r[i], b.r[i]); });
}
/// One bit a lane.
inline std::uint32_t bits_le(const Doubles16& a, const Doubles16& b) {
  std::uint32_t bits = 0;
  for (int i = 0; i < Doubles16::regs; ++i) bits |= bits_le(a.r[i], b.r[i]) << (i * double_width);
  return bits;
}

inline double smallest(const Doubles16& a) {
  DoubleReg m = a.r[0];
  for (int i = 1; i < Doubles16::regs; ++i) m = min(m, a.r[i]);
  return smallest(m);
}

/// Writes the neighbours whose bit is set, and returns how many.
inline std::size_t store_set(std::uint32_t bits, const Doubles16& distance2, const Id* ids,
                             Neighbor<double>* out) {
  alignas(64) double d[lanes];
  distance2.store(d);
  std::size_t count = 0;
  for (; bits != 0; bits &= bits - 1) {
    const int i = std::countr_zero(bits);
    out[count++] = {d[i], ids[i]};
  }
  return count;
}

}  // namespace treeline::accel::simd
