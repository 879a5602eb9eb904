// Eight triangles of a leaf at once against a ray: which of them the ray test could accept.
//
// The ray tests of geometry/intersect_triangle.hpp decide on the signs of a few sums of products; these are
// computed here by the same kernels with the same roundings, lane by lane, so a triangle is dropped only
// where the test itself would say no. The few that remain are put to the test one by one. Cost: some 50
// instructions for eight triangles. Known weakness: a leaf of one or two triangles costs as much as one of
// eight.
#pragma once

#include "accel/simd/lanes.hpp"
#include "geometry/intersect_triangle.hpp"

namespace treeline::accel {

/// For a ray test that has no filter of its own: every triangle stays. Called with the rows of a leaf (see
/// triangle_leaves.hpp), moved on to the first of the eight triangles; bits beyond the leaf's end mean
/// nothing.
template <class RayTest, class T>
class LeafFilter {
 public:
  explicit LeafFilter(const geometry::Ray<T>&) {}
  std::uint32_t operator()(const T*, std::size_t) const { return 0xffu; }
};

template <class T>
class LeafFilter<geometry::Watertight, T> {
  using Lanes = simd::Lanes<T>;
  using Test = geometry::Watertight;

 public:
  explicit LeafFilter(const geometry::Ray<T>& ray) : origin_(ray.origin), shear_(ray.direction) {}

  std::uint32_t operator()(const T* rows, std::size_t stride) const {
    const Lanes along_x = Lanes::broadcast(shear_.along_x), along_y = Lanes::broadcast(shear_.along_y);
    const auto coordinate = [&](std::size_t corner, int axis) {
      return Lanes::load(rows + (3 * corner + static_cast<std::size_t>(axis)) * stride) -
             Lanes::broadcast(origin_[axis]);
    };
    const auto corner = [&](std::size_t i) {
      return Test::sheared<Lanes>(coordinate(i, shear_.x), coordinate(i, shear_.y), coordinate(i, shear_.z),
                                  along_x, along_y);
    };
    const auto edge = Test::edges<Lanes>(corner(0), corner(1), corner(2));
    const Lanes zero = Lanes::broadcast(T(0));
    const auto negative = (edge[0] < zero) | (edge[1] < zero) | (edge[2] < zero);
    const auto positive = (zero < edge[0]) | (zero < edge[1]) | (zero < edge[2]);
    return ~(negative & positive).bits() & 0xffu;
  }

 private:
  geometry::Vec<T, 3> origin_;
  Test::Shear<T> shear_;
};

template <class T>
class LeafFilter<geometry::MollerTrumbore, T> {
  using Lanes = simd::Lanes<T>;
  using Test = geometry::MollerTrumbore;

 public:
  explicit LeafFilter(const geometry::Ray<T>& ray) : origin_(ray.origin), direction_(ray.direction) {}

  std::uint32_t operator()(const T* rows, std::size_t stride) const {
    using V = std::array<Lanes, 3>;
    const auto numbers = [](const geometry::Vec<T, 3>& p) {
      return V{Lanes::broadcast(p[0]), Lanes::broadcast(p[1]), Lanes::broadcast(p[2])};
    };
    const auto corner = [&](std::size_t i) {
      return V{Lanes::load(rows + 3 * i * stride), Lanes::load(rows + (3 * i + 1) * stride),
               Lanes::load(rows + (3 * i + 2) * stride)};
    };
    const auto at =
        Test::crossing<Lanes>(numbers(origin_), numbers(direction_), corner(0), corner(1), corner(2));
    const Lanes zero = Lanes::broadcast(T(0)), one = Lanes::broadcast(T(1));
    return ((zero <= at.u) & (at.u <= one) & (zero <= at.v) & (at.u + at.v <= one)).bits();
  }

 private:
  geometry::Vec<T, 3> origin_, direction_;
};

}  // namespace treeline::accel
