// The sign of a polynomial in floating-point numbers, decided exactly: in twice double's digits with a bound
// on the error, else in whole numbers.
//
// Method: the polynomial is written once, over any type of number. BoundedDouble evaluates it in pairs of
// doubles and keeps a bound on the absolute error beside the value (running error analysis, Higham 2002,
// section 3.3), underflow included, so that no predicate needs a bound of its own. Sums and products of plain
// doubles have none, so that many a zero is found to be one. Dyadic decides what that leaves open. Sources:
// Dekker 1971; Joldes, Muller and Popescu 2017 for the errors of the sum (3 u²) and the product (5 u²) of
// pairs. Cost: about 40 operations a product or sum in pairs; the filter in front, in plain double, belongs
// to each predicate.
#pragma once

#include "geometry/exact/dyadic.hpp"
#include "geometry/predicates.hpp"

namespace treeline::geometry {

class BoundedDouble {
 public:
  BoundedDouble() = default;
  explicit BoundedDouble(double x) : high_(x) {}

  /// The sign, or open if the error leaves it so.
  static constexpr int open = 2;
  int certain_sign() const {
    // Where anything overflowed, one of the three is infinite or NaN and the comparison false.
    if (std::abs(high_) - std::abs(low_) > error_) return high_ > 0 ? 1 : -1;
    return high_ == 0 && low_ == 0 && error_ == 0 ? 0 : open;
  }
  double value() const { return high_; }
  double rest() const { return low_; }
  double error() const { return error_; }

  BoundedDouble operator-() const { return {-high_, -low_, error_}; }
  friend BoundedDouble operator+(const BoundedDouble& a, const BoundedDouble& b) {
    const Split s = two_sum(a.high_, b.high_), t = two_sum(a.low_, b.low_);
    const Split v = ordered_sum(s.value, s.error + t.value);
    const Split z = ordered_sum(v.value, t.error + v.error);
    // Two plain numbers add without an error.
    const double own = a.low_ == 0 && b.low_ == 0 ? 0 : sum_error * std::abs(z.value);
    return {z.value, z.error, (a.error_ + b.error_ + own) * up};
  }
  friend BoundedDouble operator-(const BoundedDouble& a, const BoundedDouble& b) { return a + -b; }
  friend BoundedDouble operator*(const BoundedDouble& a, const BoundedDouble& b) {
    const Split p = two_product(a.high_, b.high_);
    const Split z = ordered_sum(p.value, p.error + (a.high_ * b.low_ + a.low_ * b.high_));
    if (is_plain(a) && a.high_ == 0) return a;
    if (is_plain(b) && b.high_ == 0) return b;
    if (is_plain(a) && is_plain(b) && std::abs(p.value) > smallest_exact) return {p.value, p.error, 0};
    const double m = size(a), n = size(b);
    return {
        z.value, z.error,
        (m * b.error_ + n * a.error_ + a.error_ * b.error_ + product_error * std::abs(z.value) + smallest) *
            up};
  }
  BoundedDouble& operator+=(const BoundedDouble& b) { return *this = *this + b; }

 private:
  static constexpr double u = 0x1p-53;
  // Those of the sources rounded up, relative to the rounded result.
  static constexpr double sum_error = 4 * u * u, product_error = 8 * u * u;
  /// What a product may lose to underflow: four results of at most half the smallest number each.
  static constexpr double smallest = 2 * std::numeric_limits<double>::denorm_min();
  static constexpr double smallest_exact = 0x1p-960;  // a plain product above keeps all its digits
  static constexpr double up = 1 + 16 * u;            // for the roundings of the bound itself

  BoundedDouble(double high, double low, double error) : high_(high), low_(low), error_(error) {}
  static bool is_plain(const BoundedDouble& a) { return a.low_ == 0 && a.error_ == 0; }
  static double size(const BoundedDouble& a) { return std::abs(a.high_) * (1 + 2 * u); }
  static Split ordered_sum(double a, double b) {  // |a| ≥ |b|, or a = 0
    const double s = a + b;
    return {s, b - (s - a)};
  }

  double high_ = 0, low_ = 0, error_ = 0;
};

/// The sign of polynomial.operator()<Number>(), which must return a Number and use +, - and * on numbers made
/// from finite floats or doubles alone.
template <class Polynomial>
[[gnu::noinline, gnu::cold]] int exact_sign(const Polynomial& polynomial) {
  const int sign = polynomial.template operator()<BoundedDouble>().certain_sign();
  if (sign != BoundedDouble::open) return sign;
  return polynomial.template operator()<Dyadic>().sign();
}

/// A triple product of differences whose largest along each axis are these keeps its digits: errors of
/// underflow (2^-1074 a product, times at most 2^330) stay below u² times the product of the three, and
/// nothing overflows.
inline bool keeps_digits(double x, double y, double z) {
  return (x * y * z > 0x1p-600) & (x + y + z < 0x1p330);
}

}  // namespace treeline::geometry
