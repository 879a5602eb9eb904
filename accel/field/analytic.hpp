// Distance fields in closed form: sphere, box, plane, torus; union, smooth union and difference of any two.
//
// They are truth for the sampled ones. Sphere, box, plane and torus are exact everywhere. Of a union the
// distance is exact outside and a lower bound in magnitude inside, of a difference it is a lower bound
// everywhere: sample() says so. Sources: Hart 1996 for the shapes and why min and max keep the Lipschitz
// constant of 1; Quilez 2008 for the polynomial smooth minimum. Cost: tens of operations. Known weakness: a
// smooth union is a shape of its own, larger than the union by up to a quarter of the blend's width; of
// sampled fields, it is only right where both are known: the blend should be narrower than their bands.
#pragma once

#include <algorithm>
#include <cmath>

#include "accel/field/concepts.hpp"
#include "geometry/box.hpp"
#include "geometry/plane.hpp"

namespace treeline::accel::field {

/// A shape whose distance is exact: supplies distance() and gradient().
template <class Shape>
struct ExactField {
  FieldSample sample(const Vec3d& p) const { return {static_cast<const Shape&>(*this).distance(p), 0, true}; }
  double lipschitz() const { return 1; }
};

struct Sphere : ExactField<Sphere> {
  Vec3d centre{};
  double radius = 1;

  Sphere() = default;
  Sphere(const Vec3d& c, double r) : centre(c), radius(r) {}
  double distance(const Vec3d& p) const { return length(p - centre) - radius; }
  geometry::Box3d bounds() const { return {centre - Vec3d::filled(radius), centre + Vec3d::filled(radius)}; }
  Vec3d gradient(const Vec3d& p) const {
    const Vec3d out = p - centre;
    return out == Vec3d{} ? Vec3d{} : normalized(out);
  }
};

/// Behind the plane is inside; its normal is of unit length.
struct HalfSpace : ExactField<HalfSpace> {
  geometry::Plane3d plane;

  explicit HalfSpace(const geometry::Plane3d& p) : plane(p) {}
  double distance(const Vec3d& p) const { return plane.signed_distance(p); }
  Vec3d gradient(const Vec3d&) const { return plane.normal; }
};

struct AxisBox : ExactField<AxisBox> {
  geometry::Box3d box;

  explicit AxisBox(const geometry::Box3d& b) : box(b) {}
  const geometry::Box3d& bounds() const { return box; }
  double distance(const Vec3d& p) const {
    const Vec3d gap = gap_to(p);
    const double deepest = gap[largest(gap)];
    return deepest <= 0 ? deepest : length(max(gap, Vec3d{}));
  }
  Vec3d gradient(const Vec3d& p) const {
    const Vec3d gap = gap_to(p), middle = box.centre();
    const auto outward = [&](int k) { return p[k] < middle[k] ? -1.0 : 1.0; };
    Vec3d r{};
    const int k = largest(gap);
    if (gap[k] <= 0) {
      r[k] = outward(k);
      return r;
    }
    for (int i = 0; i < 3; ++i) r[i] = std::max(gap[i], 0.0) * outward(i);
    return normalized(r);
  }

 private:
  Vec3d gap_to(const Vec3d& p) const { return max(box.low - p, p - box.high); }
  static int largest(const Vec3d& gap) {
    return gap[0] >= gap[1] ? (gap[0] >= gap[2] ? 0 : 2) : gap[1] >= gap[2] ? 1 : 2;
  }
};

/// Around the z-axis: `tube` is the radius of the tube whose middle runs at distance `ring` from the centre.
struct Torus : ExactField<Torus> {
  Vec3d centre{};
  double ring = 1, tube = 0.25;

  Torus(const Vec3d& c, double ring_radius, double tube_radius)
      : centre(c), ring(ring_radius), tube(tube_radius) {}
  geometry::Box3d bounds() const {
    const Vec3d reach{ring + tube, ring + tube, tube};
    return {centre - reach, centre + reach};
  }
  double distance(const Vec3d& p) const {
    const Vec3d v = p - centre;
    return std::hypot(std::hypot(v[0], v[1]) - ring, v[2]) - tube;
  }
  Vec3d gradient(const Vec3d& p) const {
    const Vec3d v = p - centre;
    const double around = std::hypot(v[0], v[1]), x = around - ring, r = std::hypot(x, v[2]);
    if (r == 0) return {};
    const double turn = around > 0 ? x / (r * around) : 0;
    return {v[0] * turn, v[1] * turn, v[2] / r};
  }
};

/// The surface lies within bounds().
template <class F>
concept BoundedField = DistanceField<F> && requires(const F& field) {
  { field.bounds() } -> std::convertible_to<geometry::Box3d>;
};

/// What two fields make together. distance() has a Lipschitz constant no larger than theirs.
template <DistanceField A, DistanceField B>
struct Union {
  A a;
  B b;

  double distance(const Vec3d& p) const { return std::min(a.distance(p), b.distance(p)); }
  geometry::Box3d bounds() const requires BoundedField<A> && BoundedField<B> {
    return merged(geometry::Box3d(a.bounds()), geometry::Box3d(b.bounds()));
  }
  Vec3d gradient(const Vec3d& p) const {
    return a.distance(p) <= b.distance(p) ? a.gradient(p) : b.gradient(p);
  }
  /// Known outside of both; inside, the other's surface may be hidden, and the distance larger.
  FieldSample sample(const Vec3d& p) const {
    const FieldSample x = a.sample(p), y = b.sample(p);
    FieldSample r = x.distance <= y.distance ? x : y;
    r.error = std::max(x.error, y.error);
    r.known = r.known && r.distance - r.error > 0;
    return r;
  }
  double lipschitz() const { return std::max(a.lipschitz(), b.lipschitz()); }
};
template <DistanceField A, DistanceField B>
Union(A, B) -> Union<A, B>;

/// A without B.
template <DistanceField A, DistanceField B>
struct Difference {
  A a;
  B b;

  double distance(const Vec3d& p) const { return std::max(a.distance(p), -b.distance(p)); }
  geometry::Box3d bounds() const requires BoundedField<A> { return a.bounds(); }
  Vec3d gradient(const Vec3d& p) const {
    return a.distance(p) >= -b.distance(p) ? a.gradient(p) : -b.gradient(p);
  }
  FieldSample sample(const Vec3d& p) const {
    return {distance(p), std::max(a.sample(p).error, b.sample(p).error), false};
  }
  double lipschitz() const { return std::max(a.lipschitz(), b.lipschitz()); }
};
template <DistanceField A, DistanceField B>
Difference(A, B) -> Difference<A, B>;

namespace detail {

/// What a sample leaves open of the distance.
struct Range {
  double low, high;
};
inline Range range(const FieldSample& s) {
  constexpr double any = 0x1p1000;  // beyond what a mesh can have, and finite
  if (s.known) return {s.distance - s.error, s.distance + s.error};
  const double least = s.clearance();
  if (least > 0) return s.distance < 0 ? Range{-any, -least} : Range{least, any};
  return {-any, any};
}

}  // namespace detail

/// A union whose crease is filled where the two distances differ by less than `width`; 0 or less: a union.
template <DistanceField A, DistanceField B>
struct SmoothUnion {
  A a;
  B b;
  double width = 0.1;

  double distance(const Vec3d& p) const { return joined(a.distance(p), b.distance(p)); }
  geometry::Box3d bounds() const requires BoundedField<A> && BoundedField<B> {
    const Vec3d grown = Vec3d::filled(width > 0 ? 0.25 * width : 0);  // by so much distances fall
    const geometry::Box3d box = merged(geometry::Box3d(a.bounds()), geometry::Box3d(b.bounds()));
    return {box.low - grown, box.high + grown};
  }
  Vec3d gradient(const Vec3d& p) const {
    const double x = a.distance(p), y = b.distance(p), share = 0.5 * nearness(x, y);  // of the farther one
    const Vec3d u = a.gradient(p), v = b.gradient(p);
    return x <= y ? u * (1 - share) + v * share : v * (1 - share) + u * share;
  }
  /// It grows with either distance: from the least and the most that they can be follows what it is at least.
  FieldSample sample(const Vec3d& p) const {
    const auto x = detail::range(a.sample(p)), y = detail::range(b.sample(p));
    const double d = distance(p), low = joined(x.low, y.low), high = joined(x.high, y.high);
    const double least = std::max({low, -high, 0.0});
    return {d, std::max(std::abs(d) - least, 0.0), false};
  }
  double lipschitz() const { return std::max(a.lipschitz(), b.lipschitz()); }

 private:
  double joined(double x, double y) const {
    const double near = nearness(x, y);
    return near > 0 ? std::min(x, y) - 0.25 * width * near * near : std::min(x, y);
  }
  double nearness(double x, double y) const {
    return width > 0 ? std::max(width - std::abs(x - y), 0.0) / width : 0;
  }
};
template <DistanceField A, DistanceField B>
SmoothUnion(A, B, double) -> SmoothUnion<A, B>;

static_assert(DistanceField<Sphere> && DistanceField<HalfSpace> && DistanceField<AxisBox>);
static_assert(DistanceField<Torus> && DistanceField<Union<Sphere, Torus>>);
static_assert(DistanceField<Difference<AxisBox, Sphere>> && DistanceField<SmoothUnion<Sphere, Sphere>>);

}  // namespace treeline::accel::field
