// Ray against triangle without an error: whether they meet is decided exactly, t is the true one rounded
// once.
//
// Triangles are closed sets, hit from both sides, but not by rays in their plane. The three edge functions
// are signed volumes det(d, p, q) of the direction and two corners seen from the origin. Each is computed in
// double with a bound on its error (Shewchuk 1997, the filter of orient3d); where the bound leaves the sign
// open, as an expansion, exactly. t is the quotient of two determinants, n · (a - o) / n · d; where the bound
// on its error leaves the float that it rounds to open, both are expansions. Cost: about 150 operations, and
// some 100 µs in the rare open case. Known weakness: products of three coordinates must stay in the range of
// double, which those of floats do.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/intersect_triangle.hpp"

namespace treeline::geometry {

/// A sum of doubles kept without rounding: components that do not overlap, the smallest first.
class Expansion {
 public:
  void add(double x) {
    std::size_t kept = 0;
    for (const double part : parts_) {
      const Split s = two_sum(x, part);
      x = s.value;
      if (s.error != 0) parts_[kept++] = s.error;
    }
    parts_.resize(kept);
    if (x != 0) parts_.push_back(x);
  }
  int sign() const { return parts_.empty() ? 0 : parts_.back() > 0 ? 1 : -1; }
  std::span<const double> parts() const { return parts_; }
  /// The value rounded, and what that leaves, rounded.
  Split rounded_value() const {
    Split sum{0, 0};
    for (const double part : parts_) {
      const Split s = two_sum(part, sum.value);
      sum = {s.value, s.error + sum.error};
    }
    return two_sum(sum.value, sum.error);
  }

  friend Expansion operator*(const Expansion& a, const Expansion& b) {
    Expansion r;
    for (const double x : a.parts_)
      for (const double y : b.parts_) {
        const Split p = two_product(x, y);
        r.add(p.error), r.add(p.value);
      }
    return r;
  }
  friend Expansion operator-(Expansion a, const Expansion& b) {
    for (const double x : b.parts_) a.add(-x);
    return a;
  }
  friend Expansion operator+(Expansion a, const Expansion& b) {
    for (const double x : b.parts_) a.add(x);
    return a;
  }

 private:
  std::vector<double> parts_;
};

/// How a ray, all of it from its origin on, passes a triangle.
struct Crossing {
  enum class Kind : std::uint8_t {
    none,
    inward,   ///< through its inside, against the normal: the origin is in front
    outward,  ///< through its inside, along the normal: the origin is behind
    touch,    ///< through an edge or a corner, or the ray lies in the triangle's plane
    start     ///< the origin is a point of the triangle
  };
  Kind kind = Kind::none;
  double low = 0, high = 0;  ///< bounds on t; 0 for `start`, and for rays in the plane
};

class ExactRay {
 public:
  /// The origin is origin - centre.
  ExactRay(const Ray<float>& ray, const Vec<float, 3>& centre)
      : direction_(ray.direction), t_min_(double(ray.t_min)) {
    for (int k = 0; k < 3; ++k) {
      const Split s = two_sum(double(ray.origin[k]), -double(centre[k]));
      origin_[k] = s.value, rest_[k] = s.error;
      origin_is_exact_ = origin_is_exact_ && s.error == 0;
    }
  }

  /// The hit with t in [t_min, t_max], if there is one.
  std::optional<TriangleHit<float>> operator()(const Triangle<float>& triangle, float t_max) const {
    const Edges edge = edges(triangle);
    if (edge.negative == edge.positive) return {};  // on both sides; or all zero: in its plane
    float t;
    if (!time(triangle, double(t_max), t)) return {};
    const double sum = edge.value[0] + edge.value[1] + edge.value[2];
    return TriangleHit<float>{t, static_cast<float>(edge.value[1] / sum),
                              static_cast<float>(edge.value[2] / sum)};
  }

  /// How the ray passes the triangle, whatever its t_min and t_max. Cost: as of a hit.
  Crossing crossing(const Triangle<float>& triangle) const {
    using Kind = Crossing::Kind;
    const Edges edge = edges(triangle);
    if (edge.negative && edge.positive) return {};
    if (!edge.negative && !edge.positive) return {Kind::touch};
    const Quotient t = quotient(triangle);
    int height = t.above.value > 0 ? 1 : -1;  // of the first corner above the origin, along the normal
    if (!origin_is_exact_ || !t.above.is_certain()) height = exact_height(triangle);
    if (height == 0) return {Kind::start};
    const int along = edge.negative ? 1 : -1;  // direction and normal
    if (height != along) return {};            // behind the origin
    Crossing r{edge.zero ? Kind::touch : along > 0 ? Kind::outward : Kind::inward};
    if (origin_is_exact_ && t.share < 0x1p-20) {
      r.low = t.value - t.error, r.high = t.value + t.error;
    } else {
      float rounded;
      exact_time(triangle, infinity, rounded);
      r.low = double(std::nextafter(rounded, 0.0f));
      r.high = double(std::nextafter(rounded, std::numeric_limits<float>::infinity()));
    }
    return r;
  }

 private:
  static constexpr double unit = 0x1p-53;
  struct Edges {
    double value[3];
    bool negative = false, positive = false, zero = false;
  };
  /// The edge functions and their signs.
  Edges edges(const Triangle<float>& triangle) const {
    const Vec3d a = Vec3d(triangle.a) - origin_, b = Vec3d(triangle.b) - origin_,
                c = Vec3d(triangle.c) - origin_;
    const Bounded edge[3] = {edge_of(c, b), edge_of(a, c), edge_of(b, a)};
    Edges r;
    for (int i = 0; i < 3; ++i) {
      r.value[i] = edge[i].value;
      int sign = edge[i].value > 0 ? 1 : -1;
      if (!origin_is_exact_ || !edge[i].is_certain()) {
        const Vec<float, 3>* const corner[3] = {&triangle.a, &triangle.b, &triangle.c};
        const Expansion exact = exact_edge(*corner[(i + 2) % 3], *corner[(i + 1) % 3]);
        sign = exact.sign();
        r.value[i] = exact.rounded_value().value;
      }
      r.negative = r.negative || sign < 0, r.positive = r.positive || sign > 0, r.zero = r.zero || sign == 0;
    }
    return r;
  }
  static constexpr double filter = 16 * unit;  // twice what Shewchuk finds for orient3d

  struct Bounded {
    double value, magnitude;  // the sum of the absolute terms
    double error() const { return filter * magnitude; }
    bool is_certain() const { return std::abs(value) > error(); }
  };
  /// x · (p × q)
  static Bounded volume(const Vec3d& x, const Vec3d& p, const Vec3d& q) {
    Bounded r{0, 0};
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const double m = rounded(p[i] * q[j]), n = rounded(p[j] * q[i]);
      r.value += rounded(x[k] * (m - n));
      r.magnitude += rounded(std::abs(x[k]) * (std::abs(m) + std::abs(n)));
    }
    return r;
  }
  Bounded edge_of(const Vec3d& p, const Vec3d& q) const { return volume(direction_, p, q); }

  struct Quotient {
    Bounded above;
    double value, share, error;  // error: of the value, if its share of it is small and the origin exact
  };
  /// t in double.
  Quotient quotient(const Triangle<float>& triangle) const {
    const Vec3d a = Vec3d(triangle.a) - origin_;
    const Vec3d ab = Vec3d(triangle.b) - Vec3d(triangle.a), ac = Vec3d(triangle.c) - Vec3d(triangle.a);
    const Bounded above = volume(a, ab, ac), below = volume(direction_, ab, ac);
    const double quotient = above.value / below.value;
    const double share =
        above.error() / std::abs(above.value) + below.error() / std::abs(below.value) + 4 * unit;
    return {above, quotient, share, std::abs(quotient) * share * 1.01};
  }
  /// False if t lies outside [t_min, t_max].
  bool time(const Triangle<float>& triangle, double t_max, float& t) const {
    const auto [above, quotient, share, error] = this->quotient(triangle);
    if (origin_is_exact_ && share < 0x1p-20) {
      const float low = static_cast<float>(quotient - error), high = static_cast<float>(quotient + error);
      const auto clear_of = [&, value = quotient, bound = error](double limit) {
        return !(std::abs(value - limit) <= bound);
      };
      if (low == high && clear_of(t_min_) && clear_of(t_max)) {
        t = low;
        return t_min_ <= quotient && quotient <= t_max;
      }
    }
    return exact_time(triangle, t_max, t);
  }

  // ---- exactly ----------------------------------------------------------------------------------------

  using Vector = std::array<Expansion, 3>;
  Vector from_origin(const Vec<float, 3>& p) const {
    Vector r;
    for (int k = 0; k < 3; ++k) {
      auto& x = r[static_cast<std::size_t>(k)];
      x.add(double(p[k])), x.add(-origin_[k]), x.add(-rest_[k]);
    }
    return r;
  }
  static Vector difference(const Vec<float, 3>& p, const Vec<float, 3>& q) {
    Vector r;
    for (int k = 0; k < 3; ++k)
      r[static_cast<std::size_t>(k)].add(double(p[k])), r[static_cast<std::size_t>(k)].add(-double(q[k]));
    return r;
  }
  static Expansion volume(const Vector& x, const Vector& p, const Vector& q) {
    Expansion sum;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      sum = sum + x[k] * (p[i] * q[j] - p[j] * q[i]);
    }
    return sum;
  }
  Vector direction() const {
    Vector r;
    for (int k = 0; k < 3; ++k) r[static_cast<std::size_t>(k)].add(direction_[k]);
    return r;
  }
  [[gnu::noinline, gnu::cold]] Expansion exact_edge(const Vec<float, 3>& p, const Vec<float, 3>& q) const {
    return volume(direction(), from_origin(p), from_origin(q));
  }
  [[gnu::noinline, gnu::cold]] int exact_height(const Triangle<float>& triangle) const {
    return volume(from_origin(triangle.a), difference(triangle.b, triangle.a),
                  difference(triangle.c, triangle.a))
        .sign();
  }
  [[gnu::noinline, gnu::cold]] bool exact_time(const Triangle<float>& triangle, double t_max,
                                               float& t) const {
    const Vector ab = difference(triangle.b, triangle.a), ac = difference(triangle.c, triangle.a);
    const Expansion above = volume(from_origin(triangle.a), ab, ac), below = volume(direction(), ab, ac);
    const auto against = [&](double limit) {  // the sign of t - limit
      if (std::isinf(limit)) return limit > 0 ? -1 : 1;
      Expansion l;
      l.add(limit);
      return (above - below * l).sign() * below.sign();
    };
    if (against(t_min_) < 0 || against(t_max) > 0) return false;
    // The quotient to twice the digits of double, rounded to float by hand where those end halfway.
    const Split n = above.rounded_value(), d = below.rounded_value();
    const double q = n.value / d.value;
    const double rest = (std::fma(-q, d.value, n.value) + n.error - q * d.error) / d.value;
    t = static_cast<float>(q);
    const float next = std::nextafter(t, static_cast<float>(q + rest > double(t) ? infinity : -infinity));
    const double half = 0.5 * (double(t) + double(next));
    if (q == half) {  // on which side of it, exactly: the rest has no more than twice double's digits
      Expansion h;
      h.add(half);
      const int past = (above - below * h).sign() * below.sign();
      if (past != 0) t = static_cast<float>(std::nextafter(q, past > 0 ? infinity : -infinity));
    }
    return true;
  }
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  Vec3d origin_, rest_, direction_;
  double t_min_;
  bool origin_is_exact_ = true;
};

/// The policy of trees that use it: hits are decided exactly.
struct Exact {};

}  // namespace treeline::geometry
