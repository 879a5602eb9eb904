// Whole numbers of 256 bits: what the exact planes of a solid multiply up to.
//
// Two's complement; results that do not fit are the caller's fault, and the bounds in exact_space.hpp say
// that none are. Cost: a product of two 128-bit numbers about 5 ns.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace treeline::accel::solid {

__extension__ typedef __int128 Int128;
__extension__ typedef unsigned __int128 Unsigned128;

class Int256 {
 public:
  Int256() = default;
  explicit Int256(Int128 x) {
    const auto fill = static_cast<std::uint64_t>(x < 0 ? -1 : 0);
    limb_ = {static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(x >> 64), fill, fill};
  }

  bool is_negative() const { return static_cast<std::int64_t>(limb_[3]) < 0; }
  int sign() const {
    if (is_negative()) return -1;
    return (limb_[0] | limb_[1] | limb_[2] | limb_[3]) != 0 ? 1 : 0;
  }
  Int256 operator-() const { return Int256() - *this; }
  friend Int256 operator+(Int256 a, const Int256& b) {
    Unsigned128 carry = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      carry += Unsigned128(a.limb_[i]) + b.limb_[i];
      a.limb_[i] = static_cast<std::uint64_t>(carry), carry >>= 64;
    }
    return a;
  }
  friend Int256 operator-(Int256 a, const Int256& b) {
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Unsigned128 d = Unsigned128(a.limb_[i]) - b.limb_[i] - borrow;
      a.limb_[i] = static_cast<std::uint64_t>(d), borrow = static_cast<std::uint64_t>(d >> 64) & 1;
    }
    return a;
  }
  friend Int256 operator*(const Int256& a, Int128 b) {
    const Int256 x = a.is_negative() ? -a : a;
    const Unsigned128 size =
        b < 0 ? Unsigned128(0) - static_cast<Unsigned128>(b) : static_cast<Unsigned128>(b);
    const std::uint64_t y[2] = {static_cast<std::uint64_t>(size), static_cast<std::uint64_t>(size >> 64)};
    Int256 r;
    for (std::size_t j = 0; j < 2; ++j) {
      if (y[j] == 0) continue;
      Unsigned128 carry = 0;
      for (std::size_t i = 0; i + j < 4; ++i) {
        carry += Unsigned128(x.limb_[i]) * y[j] + r.limb_[i + j];
        r.limb_[i + j] = static_cast<std::uint64_t>(carry), carry >>= 64;
      }
    }
    return a.is_negative() != (b < 0) ? -r : r;
  }

  /// With a relative error below 2^-52.
  double rounded() const {
    const Int256 x = is_negative() ? -*this : *this;
    std::size_t n = 3;
    while (n > 0 && x.limb_[n] == 0) --n;
    double r = static_cast<double>(x.limb_[n]);
    if (n > 0) {
      const int room = std::countl_zero(x.limb_[n]);
      const std::uint64_t top = room > 0 ? x.limb_[n] << room | x.limb_[n - 1] >> (64 - room) : x.limb_[n];
      r = std::ldexp(static_cast<double>(top), 64 * static_cast<int>(n) - room);
    }
    return is_negative() ? -r : r;
  }

 private:
  std::array<std::uint64_t, 4> limb_{};
};

}  // namespace treeline::accel::solid
