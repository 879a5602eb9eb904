// Whole numbers times powers of two, of any size: sums and products of floating-point numbers without an
// error.
//
// Problem: every finite float or double is a whole number times a power of two, so signs of polynomials in
// them are decidable; but expansions of doubles (Shewchuk 1997) lose terms where products leave the range of
// double, and a library of rationals is more than a header for users should ask for. Method: 64-bit limbs,
// whose first stands for a power of 2^64, and a sign; no division, as no predicate needs one. Cost: some 20
// ns an operation for coordinates of similar size, mostly the allocation. Known weakness: schoolbook
// products; numbers that mix 1e-300 and 1e300 take 40 limbs each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace treeline::geometry {

class Dyadic {
 public:
  Dyadic() = default;
  /// x must be finite.
  explicit Dyadic(double x) : negative_(std::signbit(x)) {
    if (x == 0) return;
    int e;
    const auto digits = static_cast<std::uint64_t>(std::ldexp(std::frexp(std::abs(x), &e), 53));
    e -= 53;
    low_ = e >= 0 ? e / 64 : -((63 - e) / 64);
    const int shift = e - 64 * low_;
    limbs_ = {digits << shift, shift > 0 ? digits >> (64 - shift) : 0};
    trim();
  }

  int sign() const { return limbs_.empty() ? 0 : negative_ ? -1 : 1; }

  Dyadic operator-() const {
    Dyadic r = *this;
    r.negative_ = !negative_;
    return r;
  }
  friend Dyadic operator+(const Dyadic& a, const Dyadic& b) { return sum(a, b, b.negative_); }
  friend Dyadic operator-(const Dyadic& a, const Dyadic& b) { return sum(a, b, !b.negative_); }
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    Dyadic r;
    if (a.limbs_.empty() || b.limbs_.empty()) return r;
    r.limbs_.assign(a.limbs_.size() + b.limbs_.size(), 0);
    for (std::size_t i = 0; i < a.limbs_.size(); ++i) {
      Wide carry = 0;
      for (std::size_t j = 0; j < b.limbs_.size(); ++j) {
        carry += Wide(a.limbs_[i]) * b.limbs_[j] + r.limbs_[i + j];
        r.limbs_[i + j] = static_cast<std::uint64_t>(carry), carry >>= 64;
      }
      r.limbs_[i + b.limbs_.size()] = static_cast<std::uint64_t>(carry);
    }
    r.low_ = a.low_ + b.low_;
    r.negative_ = a.negative_ != b.negative_;
    r.trim();
    return r;
  }
  Dyadic& operator+=(const Dyadic& b) { return *this = *this + b; }

  /// The value as digits · 2^exponent with |digits| in [2^62, 2^64], truncated; 0 for 0.
  struct Scaled {
    double digits = 0;
    int exponent = 0;
  };
  Scaled scaled() const {
    if (limbs_.empty()) return {};
    const std::size_t n = limbs_.size();
    const int room = __builtin_clzll(limbs_[n - 1]);
    std::uint64_t top = limbs_[n - 1] << room;
    if (room > 0 && n > 1) top |= limbs_[n - 2] >> (64 - room);
    const double digits = static_cast<double>(top);
    return {negative_ ? -digits : digits, 64 * (low_ + static_cast<int>(n) - 1) - room};
  }

 private:
  __extension__ typedef unsigned __int128 Wide;

  std::uint64_t limb(int position) const {
    const int i = position - low_;
    return 0 <= i && i < static_cast<int>(limbs_.size()) ? limbs_[static_cast<std::size_t>(i)] : 0;
  }
  int high() const { return low_ + static_cast<int>(limbs_.size()); }

  void trim() {
    while (!limbs_.empty() && limbs_.back() == 0) limbs_.pop_back();
    const auto first = std::find_if(limbs_.begin(), limbs_.end(), [](std::uint64_t x) { return x != 0; });
    low_ += static_cast<int>(first - limbs_.begin());
    limbs_.erase(limbs_.begin(), first);
    if (limbs_.empty()) low_ = 0, negative_ = false;
  }
  static bool is_smaller(const Dyadic& a, const Dyadic& b) {  // in magnitude
    for (int i = std::max(a.high(), b.high()); i-- > std::min(a.low_, b.low_);)
      if (a.limb(i) != b.limb(i)) return a.limb(i) < b.limb(i);
    return false;
  }
  /// a + b, where b counts with the sign given.
  static Dyadic sum(const Dyadic& a, const Dyadic& b, bool b_negative) {
    if (b.limbs_.empty()) return a;
    Dyadic r;
    if (a.limbs_.empty()) {
      r = b, r.negative_ = b_negative;
      return r;
    }
    const bool subtract = a.negative_ != b_negative, swap = subtract && is_smaller(a, b);
    const Dyadic &x = swap ? b : a, &y = swap ? a : b;
    r.negative_ = swap ? b_negative : a.negative_;
    r.low_ = std::min(a.low_, b.low_);
    const int high = std::max(a.high(), b.high());
    r.limbs_.reserve(static_cast<std::size_t>(high - r.low_) + 1);
    std::uint64_t carry = 0;
    for (int i = r.low_; i < high; ++i) {
      const std::uint64_t p = x.limb(i), q = y.limb(i);
      const std::uint64_t s = subtract ? p - q - carry : p + q + carry;
      carry = subtract ? (p < q || (p == q && carry != 0)) : (s < p || (s == p && carry != 0));
      r.limbs_.push_back(s);
    }
    if (carry != 0) r.limbs_.push_back(carry);
    r.trim();
    return r;
  }

  std::vector<std::uint64_t> limbs_;  // the lowest first; neither end is 0
  int low_ = 0;                       // the lowest stands for 2^(64 low_)
  bool negative_ = false;
};

/// a / b for b other than 0, rounded once, to the nearest, ties to even.
template <class T>
T rounded_quotient(const Dyadic& a, const Dyadic& b) {
  if (a.sign() == 0) return 0;
  const auto n = a.scaled(), d = b.scaled();
  // Off by at most a few units in the last place; the loop puts that right. A quotient that is too large for
  // T is tried as the largest, and one that is too small as a denormal.
  constexpr T largest = std::numeric_limits<T>::max();
  const double q = std::ldexp(n.digits / d.digits, n.exponent - d.exponent);
  T r = std::abs(q) < double(largest) ? static_cast<T>(q)
                                      : std::copysign(largest, static_cast<T>(std::copysign(1.0, q)));
  const Dyadic half(0.5);
  for (;;) {
    const int above = (a - b * Dyadic(double(r))).sign() * b.sign();  // the sign of the true quotient - r
    if (above == 0) return r;
    const T next = std::nextafter(
        r, above > 0 ? std::numeric_limits<T>::infinity() : -std::numeric_limits<T>::infinity());
    if (std::isinf(next)) return r;
    const int past = (a - b * (half * (Dyadic(double(r)) + Dyadic(double(next))))).sign() * b.sign() * above;
    if (past < 0) return r;
    if (past == 0) {  // halfway between the two: the last digit of one of them is even
      const T unit = std::abs(next - r);
      return std::fmod(r / unit, T(2)) == 0 ? r : next;
    }
    r = next;
  }
}

}  // namespace treeline::geometry
