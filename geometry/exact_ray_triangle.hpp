// Ray against the triangles of a tree's leaves without an error: whether they meet is decided exactly, t is
// the true one rounded once.
//
// Triangles are closed sets, hit from both sides, but not by rays in their plane. The three edge functions
// are signed volumes det(d, p, q) of the direction and two corners seen from the origin; t is the quotient of
// two such, n · (a - o) / n · d. Each is computed in double with a bound on its error (Shewchuk 1997, the
// filter of orient3d); where a bound leaves a sign, or the float that t rounds to, open,
// exact/ray_triangle.hpp decides. The filter is as that one, but prepared once a ray, with a bound relative
// to the terms as they are, so that it holds however different the direction's components are. Cost: about
// 150 operations (30 ns); 1 to 1.5 µs where the filter leaves something open, as for rays at a corner and
// hits at t = 0. Known weakness: coordinates must be those of floats, times powers of two that all share, so
// that products of three stay in double's range.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "geometry/exact/ray_triangle.hpp"
#include "geometry/intersect_triangle.hpp"

namespace treeline::geometry {

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
  /// Triangles are asked for as they are, moved by -centre; the sums must be numbers of double.
  ExactRay(const Rayd& ray, const Vec3d& centre) : ray_(ray), centre_(centre) {}
  /// Of floats, as a ray is given.
  ExactRay(const Ray<float>& ray, const Vec<float, 3>& centre)
      : ExactRay({Vec3d(ray.origin), Vec3d(ray.direction), double(ray.t_min), double(ray.t_max)},
                 Vec3d(centre)) {}

  const Rayd& ray() const { return ray_; }
  const Vec3d& centre() const { return centre_; }

  /// The t of the hit in [t_min, t_max], if there is one.
  std::optional<float> time(const Triangle<float>& triangle) const {
    const Triangle3d t = whole(triangle);
    const Vec3d a = t.a - ray_.origin, b = t.b - ray_.origin, c = t.c - ray_.origin;
    const Bounded edge[3] = {edge_of(c, b), edge_of(a, c), edge_of(b, a)};
    bool negative = false, positive = false, certain = true;
    for (const Bounded& e : edge) {
      negative |= e.value<-e.error(), positive |= e.value> e.error();
      certain &= e.is_certain();
    }
    if (negative && positive) return {};
    if (!certain) return exact_time(t);
    const Vec3d ab = t.b - t.a, ac = t.c - t.a;
    const Bounded above = volume(a, ab, ac), below = volume(ray_.direction, ab, ac);
    const double quotient = above.value / below.value;
    const double share =
        above.error() / std::abs(above.value) + below.error() / std::abs(below.value) + 4 * unit;
    const double error = std::abs(quotient) * share * 1.01;
    if (share < 0x1p-20) {
      const float low = static_cast<float>(quotient - error), high = static_cast<float>(quotient + error);
      const auto clear_of = [&](double limit) { return !(std::abs(quotient - limit) <= error); };
      if (low == high && clear_of(ray_.t_min) && clear_of(ray_.t_max)) {
        if (ray_.t_min <= quotient && quotient <= ray_.t_max) return low;
        return {};
      }
    }
    return exact_time(t);
  }

  /// How the ray passes the triangle, whatever its t_min and t_max. Cost: as of a hit.
  Crossing crossing(const Triangle<float>& triangle) const {
    using Kind = Crossing::Kind;
    const Triangle3d t = whole(triangle);
    const Vec3d a = t.a - ray_.origin, b = t.b - ray_.origin, c = t.c - ray_.origin;
    const Bounded edge[3] = {edge_of(c, b), edge_of(a, c), edge_of(b, a)};
    const Vec3d* const corner[3] = {&t.a, &t.b, &t.c};
    bool negative = false, positive = false, zero = false;
    for (int i = 0; i < 3; ++i) {
      int sign = edge[i].value > 0 ? 1 : -1;
      if (!edge[i].is_certain()) sign = -exact_edge_sign(*corner[(i + 1) % 3], *corner[(i + 2) % 3]);
      negative |= sign<0, positive |= sign> 0, zero |= sign == 0;
    }
    if (negative && positive) return {};
    if (!negative && !positive) return {Kind::touch};
    const Vec3d ab = t.b - t.a, ac = t.c - t.a;
    const Bounded above = volume(a, ab, ac), below = volume(ray_.direction, ab, ac);
    int height = above.value > 0 ? 1 : -1;  // of the first corner above the origin, along the normal
    if (!above.is_certain()) height = exact_height(t);
    if (height == 0) return {Kind::start};
    const int along = negative ? 1 : -1;  // direction and normal
    if (height != along) return {};       // behind the origin
    Crossing r{zero ? Kind::touch : along > 0 ? Kind::outward : Kind::inward};
    const double quotient = above.value / below.value;
    const double share =
        above.error() / std::abs(above.value) + below.error() / std::abs(below.value) + 4 * unit;
    if (share < 0x1p-20) {
      const double error = std::abs(quotient) * share * 1.01;
      r.low = quotient - error, r.high = quotient + error;
    } else {
      const float rounded = exact_quotient(t);
      r.low = double(std::nextafter(rounded, 0.0f));
      r.high = double(std::nextafter(rounded, std::numeric_limits<float>::infinity()));
    }
    return r;
  }

  /// Weights of the second and third corner of a triangle that is hit: the true ones, off by at most their
  /// last place.
  void weights(const Triangle<float>& triangle, float& u, float& v) const {
    const Triangle3d t = whole(triangle);
    // Of the sides rather than of corners seen from the origin: of a small triangle far off, products of two
    // corners would lose the square of the digits. (Rays from afar at 1e6 triangles: 1.8 µs so, 0.65 now.)
    const Vec3d a = t.a - ray_.origin, ab = t.b - t.a, ac = t.c - t.a;
    const Bounded all = edge_of(ac, ab), second = edge_of(a, ac), third = edge_of(ab, a);
    const auto is_fine = [](const Bounded& x) { return x.error() < 0x1p-26 * std::abs(x.value); };
    if (is_fine(all) && is_fine(second) && is_fine(third)) {
      u = static_cast<float>(second.value / all.value), v = static_cast<float>(third.value / all.value);
    } else {
      exact_weights(t, u, v);
    }
  }

 private:
  static constexpr double unit = 0x1p-53;
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
  Bounded edge_of(const Vec3d& p, const Vec3d& q) const { return volume(ray_.direction, p, q); }

  /// Where the user has it: a float again, as far as float goes, so the sums are exact.
  Triangle3d whole(const Triangle<float>& t) const {
    return {Vec3d(t.a) + centre_, Vec3d(t.b) + centre_, Vec3d(t.c) + centre_};
  }
  [[gnu::noinline, gnu::cold]] int exact_edge_sign(const Vec3d& p, const Vec3d& q) const {
    return exact_sign(detail::EdgeFunction{ray_.origin, ray_.direction, p, q});
  }
  [[gnu::noinline, gnu::cold]] int exact_height(const Triangle3d& t) const {
    return exact_sign(detail::RayTime{ray_, t, 0});
  }
  [[gnu::noinline, gnu::cold]] float exact_quotient(const Triangle3d& t) const {
    Dyadic above, below;
    detail::RayTime{ray_, t, 0}.quotient(above, below);
    return rounded_quotient<float>(above, below);
  }
  [[gnu::noinline, gnu::cold]] std::optional<float> exact_time(const Triangle3d& t) const {
    return exact_hit<float>(ray_, t);
  }
  [[gnu::noinline, gnu::cold]] void exact_weights(const Triangle3d& t, float& u, float& v) const {
    Dyadic edge[3], sum;
    const Vec3d* const corner[3] = {&t.a, &t.b, &t.c};
    for (int i = 0; i < 3; ++i) {
      const detail::EdgeFunction e{ray_.origin, ray_.direction, *corner[(i + 1) % 3], *corner[(i + 2) % 3]};
      sum += edge[i] = e.operator()<Dyadic>();
    }
    u = rounded_quotient<float>(edge[1], sum), v = rounded_quotient<float>(edge[2], sum);
  }

  Rayd ray_;
  Vec3d centre_;
};

/// The policy of trees that use it: hits are decided exactly.
struct Exact {};

}  // namespace treeline::geometry
