// Ray against box: where a ray is inside a box, never too short.
//
// Problem: a slab test decides which boxes a traversal skips, so one wrong "no" loses a surface. Zero
// direction components make 0 * inf = NaN, denormal ones overflow 1/d, rounding shortens the interval, and a
// watertight triangle test may accept a triangle that the exact ray passes by a rounding error. Source: Ize
// 2013, "Robust BVH ray traversal"; Woop, Benthin and Wald 2013, section 4 (error bounds).
//
// Method: distances are measured along the ray's major axis z, s = t |d_z|, so that no slope d_k / d_z
// exceeds one, and each box is padded, as seen from the ray's origin, by slab_padding (m_k + m_z), where m is
// the largest |corner - origin| along an axis. That covers every rounding made here and in the shear of the
// watertight test (see Watertight): with u the unit roundoff, 2u m_k + 4u m_z there and 4u m_k here.
// An inverse slope above 2^80 is cut to 2^80: within the box such a ray moves less than 2^-80 m_z sideways,
// far less than the padding, so zero, -0 and denormal components need no case of their own and no NaN arises.
//
// Every step is monotone in the box: a box inside another has its computed interval inside the other's. Trees
// rely on that: what brute force accepts, no enclosing box rejects.
// Cost: 6 subtractions, 6 products, 2 divisions and the padding; per ray 2 divisions.
// Known weakness: coordinates whose differences overflow make the test say yes to everything.
#pragma once

#include "geometry/box.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::geometry {

template <class T>
class BoxTest {
 public:
  explicit BoxTest(const Ray<T>& ray)
      : origin_(ray.origin), major_(largest_axis(ray.direction)), speed_(std::abs(ray.direction[major_])) {
    for (int k = 0; k < 3; ++k) {
      const T inverse = speed_ / std::abs(ray.direction[k]);
      inverse_slope_[k] = std::copysign(inverse < steepest ? inverse : steepest, ray.direction[k]);
    }
  }

  /// Whether the ray is in the box for some t in [t_min, t_max]; t_enter and t_exit bound those t from
  /// outside and are meaningful only then. False for an empty box and for one with a NaN.
  bool operator()(const Box<T, 3>& box, T t_min, T t_max, T& t_enter, T& t_exit) const {
    T near = -std::numeric_limits<T>::infinity(), far = std::numeric_limits<T>::infinity();
    const T reach_major = reach(box, major_);
    for (int k = 0; k < 3; ++k) {
      if (!(box.low[k] <= box.high[k])) return false;
      const T padding = rounded(tolerance::slab_padding<T> * (reach(box, k) + reach_major)) + smallest;
      const T low = ((box.low[k] - origin_[k]) - padding) * inverse_slope_[k];
      const T high = ((box.high[k] - origin_[k]) + padding) * inverse_slope_[k];
      const bool forward = inverse_slope_[k] > T(0);
      const T first = forward ? low : high, last = forward ? high : low;
      if (first > near)
        near = first;  // written so that a NaN (differences that overflow) widens the interval
      if (last < far) far = last;
    }
    t_enter = std::max(t_min, near / speed_);
    t_exit = std::min(t_max, far / speed_);
    return t_enter <= t_exit;
  }

 private:
  static constexpr T steepest = T(0x1p80);
  static constexpr T smallest = std::numeric_limits<T>::min();  // where relative error bounds end

  T reach(const Box<T, 3>& box, int k) const {
    return std::max(std::abs(box.low[k] - origin_[k]), std::abs(box.high[k] - origin_[k]));
  }

  Vec<T, 3> origin_;
  int major_;
  T speed_;
  Vec<T, 3> inverse_slope_;
};

}  // namespace treeline::geometry
