// The leaf test without an error: no false hit, no false miss, t rounded once.
//
// Float sorts out what is certain: the sheared edge functions of wide_woop.hpp with a bound on their error.
// The few triangles that may be hit are decided in double, and in exact arithmetic where double is not enough
// (see exact_ray_triangle.hpp), by the ray as it was given: where that is scaled (triangle_scale.hpp), floats
// would lose digits of its smaller components, doubles do not. The bound: with Q the reach plus the largest
// coordinate, a sheared corner is off by at most D = 9 u Q (2 u Q to move it to the origin, 6 u Q to shear
// it, and second-order terms), an edge function of corners with coordinates of at most m by 4 D m + 2 D² and
// its own rounding 6 u m², m being at most 2 Q: 6 D (m + D) covers it. m is measured as computed, too small
// by up to D; where that matters, below 2 D, no edge function reaches the bound. Cost: a third more
// operations than the watertight test, and some 40 ns a triangle that may be hit. Known weakness: in a mesh
// that is scaled, coordinates below 2^-149 of the typical one vanish.
#pragma once

#include "accel/bvh/wide_woop.hpp"
#include "geometry/exact_ray_triangle.hpp"

namespace treeline::accel::wide {

/// A ray scaled to a tree's unit: t is the given one's times 2^shift.
struct ScaledRay : geometry::Ray<float> {
  geometry::Ray<float> given;
  geometry::Vec<float, 3> centre;  // in the user's space
  float factor;
  int shift;

  /// The same with no digit lost, for each coordinate is a float's times a power of two.
  geometry::Rayd exact() const {
    using geometry::Vec3d;
    const double unit = factor;
    const auto time = [&](float t) { return std::ldexp(double(t), shift); };
    return {Vec3d(given.origin) * unit, Vec3d(given.direction) * (unit * std::ldexp(1.0, -shift)),
            time(begin_of(given)), time(end_of(given))};
  }
};

template <int N>
class ExactTest {
 public:
  using Leaf = RayLeaf<N>;
  using Box = geometry::Box<float, 3>;

  ExactTest(const geometry::Ray<float>& ray, const geometry::Vec<float, 3>& centre, const Box& bounds,
            float reach)
      : ExactTest(ray, centre, bounds, reach,
                  {geometry::Ray<float>{ray.origin, ray.direction, begin_of(ray), end_of(ray)}, centre}) {}
  ExactTest(const ScaledRay& ray, const geometry::Vec<float, 3>& centre, const Box& bounds, float reach)
      : ExactTest(ray, centre, bounds, reach,
                  {ray.exact(), geometry::Vec3d(ray.centre) * double(ray.factor)}) {}

  [[gnu::always_inline]] std::uint32_t hits(const Leaf& leaf, float limit, float (&t)[N]) const {
    std::uint32_t bits = 0;
    for (std::uint32_t maybe = this->maybe(leaf); maybe != 0; maybe &= maybe - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(maybe));
      bits |= (is_hit(leaf, lane, limit, t[lane]) ? 1u : 0u) << lane;
    }
    return bits;
  }
  void weights(const Leaf& leaf, std::uint32_t lane, float& u, float& v) const {
    exact_.weights(triangle(leaf, lane), u, v);
  }
  /// The t of a hit, of the ray as it was given.
  float time(const Leaf& leaf, std::uint32_t lane, int shift) const {
    geometry::Rayd ray = exact_.ray();
    ray.direction = ray.direction * std::ldexp(1.0, shift);
    ray.t_min = std::ldexp(ray.t_min, -shift), ray.t_max = std::ldexp(ray.t_max, -shift);
    return *geometry::ExactRay(ray, exact_.centre()).time(triangle(leaf, lane));
  }

  /// One bit for each triangle that may be hit, at whatever t; those left out are missed for certain.
  [[gnu::always_inline]] std::uint32_t maybe(const Leaf& leaf) const { return sheared_.maybe(leaf, off_); }
  /// How the ray passes a triangle, exactly.
  [[gnu::noinline]] geometry::Crossing crossing(const Leaf& leaf, std::uint32_t lane) const {
    return exact_.crossing(triangle(leaf, lane));
  }

 private:
  ExactTest(const geometry::Ray<float>& ray, const geometry::Vec<float, 3>& centre, const Box& bounds,
            float reach, const geometry::ExactRay& exact)
      : sheared_(ray, centre, bounds, reach), exact_(exact) {
    float q = 0;
    for (int k = 0; k < 3; ++k) {
      const float origin = std::abs(ray.origin[k] - centre[k]);
      q = std::max(q, origin + 2 * std::max(std::abs(bounds.low[k]), std::abs(bounds.high[k])));
    }
    off_ = 10 * geometry::tolerance::unit_roundoff<float> * q + std::numeric_limits<float>::min();
  }
  static geometry::Triangle<float> triangle(const Leaf& leaf, std::uint32_t lane) {
    const auto corner = [&](int i) {
      return geometry::Vec<float, 3>{leaf.corner[i][0][lane], leaf.corner[i][1][lane],
                                     leaf.corner[i][2][lane]};
    };
    return {corner(0), corner(1), corner(2)};
  }
  [[gnu::noinline]] bool is_hit(const Leaf& leaf, std::uint32_t lane, float limit, float& t) const {
    // Against the ray's own end, not the nearest hit so far: what rounds to the same t ties.
    const auto hit = exact_.time(triangle(leaf, lane));
    if (!hit || *hit > limit) return false;
    t = *hit;
    return true;
  }

  WoopTest<N> sheared_;
  geometry::ExactRay exact_;
  float off_;
};

}  // namespace treeline::accel::wide
