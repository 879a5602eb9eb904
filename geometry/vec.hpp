// Small fixed-size vectors: D numbers of type T, by value, with the arithmetic that geometry needs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace treeline::geometry {

template <class T, int D>
struct Vec {
  using Scalar = T;
  static constexpr int dimension = D;

  T v[D]{};

  constexpr T& operator[](int i) { return v[i]; }
  constexpr const T& operator[](int i) const { return v[i]; }

  constexpr bool operator==(const Vec&) const = default;

  /// Converts component by component (rounds when narrowing).
  template <class U>
  constexpr explicit operator Vec<U, D>() const {
    Vec<U, D> r;
    for (int i = 0; i < D; ++i) r[i] = static_cast<U>(v[i]);
    return r;
  }

  static constexpr Vec filled(T value) {
    Vec r;
    for (int i = 0; i < D; ++i) r[i] = value;
    return r;
  }
};

using Vec2f = Vec<float, 2>;
using Vec2d = Vec<double, 2>;
using Vec3f = Vec<float, 3>;
using Vec3d = Vec<double, 3>;

template <class T, int D>
constexpr Vec<T, D> operator+(const Vec<T, D>& a, const Vec<T, D>& b) {
  Vec<T, D> r;
  for (int i = 0; i < D; ++i) r[i] = a[i] + b[i];
  return r;
}
template <class T, int D>
constexpr Vec<T, D> operator-(const Vec<T, D>& a, const Vec<T, D>& b) {
  Vec<T, D> r;
  for (int i = 0; i < D; ++i) r[i] = a[i] - b[i];
  return r;
}
template <class T, int D>
constexpr Vec<T, D> operator-(const Vec<T, D>& a) {
  Vec<T, D> r;
  for (int i = 0; i < D; ++i) r[i] = -a[i];
  return r;
}
template <class T, int D>
constexpr Vec<T, D> operator*(const Vec<T, D>& a, T s) {
  Vec<T, D> r;
  for (int i = 0; i < D; ++i) r[i] = a[i] * s;
  return r;
}
template <class T, int D>
constexpr Vec<T, D> operator*(T s, const Vec<T, D>& a) {
  return a * s;
}
template <class T, int D>
constexpr Vec<T, D> operator/(const Vec<T, D>& a, T s) {
  Vec<T, D> r;
  for (int i = 0; i < D; ++i) r[i] = a[i] / s;
  return r;
}
template <class T, int D>
constexpr Vec<T, D>& operator+=(Vec<T, D>& a, const Vec<T, D>& b) {
  return a = a + b;
}
template <class T, int D>
constexpr Vec<T, D>& operator-=(Vec<T, D>& a, const Vec<T, D>& b) {
  return a = a - b;
}

template <class T, int D>
constexpr T dot(const Vec<T, D>& a, const Vec<T, D>& b) {
  T s = a[0] * b[0];
  for (int i = 1; i < D; ++i) s += a[i] * b[i];
  return s;
}
template <class T>
constexpr Vec<T, 3> cross(const Vec<T, 3>& a, const Vec<T, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T, int D>
constexpr T length2(const Vec<T, D>& a) {
  return dot(a, a);
}
template <class T, int D>
T length(const Vec<T, D>& a) {
  return std::sqrt(dot(a, a));
}
template <class T, int D>
constexpr T distance2(const Vec<T, D>& a, const Vec<T, D>& b) {
  return length2(a - b);
}
template <class T, int D>
T distance(const Vec<T, D>& a, const Vec<T, D>& b) {
  return length(a - b);
}
/// Unit vector along a; a must not be zero.
template <class T, int D>
Vec<T, D> normalized(const Vec<T, D>& a) {
  return a / length(a);
}
template <class T, int D>
constexpr Vec<T, D> min(const Vec<T, D>& a, const Vec<T, D>& b) {
  Vec<T, D> r;
  for (int i = 0; i < D; ++i) r[i] = std::min(a[i], b[i]);
  return r;
}
template <class T, int D>
constexpr Vec<T, D> max(const Vec<T, D>& a, const Vec<T, D>& b) {
  Vec<T, D> r;
  for (int i = 0; i < D; ++i) r[i] = std::max(a[i], b[i]);
  return r;
}
/// True if no component is NaN or infinite.
template <class T, int D>
bool is_finite(const Vec<T, D>& a) {
  for (int i = 0; i < D; ++i)
    if (!std::isfinite(a[i])) return false;
  return true;
}
/// Index of the component of largest magnitude.
template <class T, int D>
int largest_axis(const Vec<T, D>& a) {
  int best = 0;
  for (int i = 1; i < D; ++i)
    if (std::abs(a[i]) > std::abs(a[best])) best = i;
  return best;
}

}  // namespace treeline::geometry
