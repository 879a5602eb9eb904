// A few points in no tree, in order of id: 16 at a time are measured by one pass of vector instructions, so
// that some hundreds cost a query less than a small tree of them would.
//
// Cost: O(1) to add, O(log n + n / 16) to find and take out, 2 to 3 ns for each 16 a query.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <vector>

#include "accel/concepts.hpp"
#include "accel/simd/doubles16.hpp"

namespace treeline::accel {

template <class T, int D>
class LoosePoints {
 public:
  using Point = geometry::Vec<T, D>;

  std::size_t size() const { return ids_.size(); }
  Id id(std::size_t i) const { return ids_[i]; }
  Point point(std::size_t i) const {
    Point p;
    for (int a = 0; a < D; ++a) p[a] = x_[axis(a)][i];
    return p;
  }
  /// Ids come in ascending order.
  void add(Id id, const Point& p) {
    if (size() == x_[0].size())
      for (auto& x : x_) x.resize(size() + simd::lanes, std::numeric_limits<T>::infinity());
    for (int a = 0; a < D; ++a) x_[axis(a)][size()] = p[a];
    ids_.push_back(id);
  }
  /// The point that it was, if there is one.
  std::optional<Point> erase(Id id) {
    const auto at = std::lower_bound(ids_.begin(), ids_.end(), id);
    if (at == ids_.end() || *at != id) return {};
    const Point erased = point(static_cast<std::size_t>(at - ids_.begin()));
    for (auto& x : x_) {
      const auto from = x.begin() + (at - ids_.begin());
      std::copy(from + 1, x.begin() + static_cast<std::ptrdiff_t>(size()), from);
      x[size() - 1] = std::numeric_limits<T>::infinity();
    }
    ids_.erase(at);
    return erased;
  }
  void clear() {
    ids_.clear();
    for (auto& x : x_) x.clear();
  }
  std::size_t bytes() const {
    std::size_t sum = ids_.capacity() * sizeof(Id);
    for (const auto& x : x_) sum += x.capacity() * sizeof(T);
    return sum;
  }

  /// Calls f(distance², i) for those within a squared distance, which are measured as trees measure them.
  template <class F>
  void each_near(const Point& q, T limit, F&& f) const {
    using Lanes = std::conditional_t<std::is_same_v<T, float>, simd::Floats16, simd::Doubles16>;
    for (std::size_t first = 0; first < size(); first += simd::lanes) {
      Lanes sum;
      for (int a = 0; a < D; ++a) {
        const Lanes d = Lanes::load(x_[axis(a)].data() + first) - Lanes::broadcast(q[a]);
        sum = a == 0 ? d * d : sum + d * d;
      }
      std::uint32_t near = simd::bits_le(sum, Lanes::broadcast(limit));
      if (size() - first < simd::lanes) near &= (1u << (size() - first)) - 1;  // no absent ones
      if (near == 0) continue;
      alignas(64) T distance2[simd::lanes];
      sum.store(distance2);
      for (; near != 0; near &= near - 1) {
        const int i = std::countr_zero(near);
        f(distance2[i], first + static_cast<std::size_t>(i));
      }
    }
  }

 private:
  static constexpr std::size_t axis(int a) { return static_cast<std::size_t>(a); }

  std::array<std::vector<T>, D> x_;  // absent ones, up to the next 16, are infinite
  std::vector<Id> ids_;
};

}  // namespace treeline::accel
