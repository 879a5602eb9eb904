#include "bench/brdf_integral/shape_truth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/brdf_integral/adaptive.hpp"
#include "geometry/sampling.hpp"

namespace treeline::bench::brdf_integral {
namespace {

using std::numbers::pi;
constexpr double tolerance_of_shapes = 1e-7;  // what two rules may differ by: the finer is far better

/// The integral of the cosine over distance², for a patch p(s, t) with area |normal| ds dt.
template <class Point>
double over_area(const Point& p, const Vec3d& normal, std::span<const double> s, std::span<const double> t) {
  const auto slice = [&](double a) {
    const auto at = [&](double b) {
      const auto [point, area] = p(a, b);
      const double d2 = dot(point, point);
      return Values<1>{area * std::abs(dot(point, normal)) / (d2 * std::sqrt(d2))};
    };
    return integrate<1>(at, t, 0.1 * tolerance_of_shapes);
  };
  return integrate<1>(slice, s, tolerance_of_shapes)[0];
}

/// Of the shape around the direction `middle` that a closed border p(t), t in [0, 2 pi), encloses.
template <class Point>
double within_border(const Point& p, const Vec3d& middle, std::span<const double> breaks) {
  const geometry::Frame<double> f(normalized(middle));
  const auto at = [&](double t) {
    const auto [point, along] = p(t);
    const double x = dot(point, f.x), y = dot(point, f.y), z = dot(point, f.z), r2 = x * x + y * y;
    const double turn = (x * dot(along, f.y) - y * dot(along, f.x)) / r2;
    const double l = std::sqrt(r2 + z * z);
    return Values<1>{turn * (z > 0 ? r2 / (l * (l + z)) : 1 - z / l)};
  };
  return std::abs(integrate<1>(at, breaks, tolerance_of_shapes)[0]);
}

struct OnPatch {
  Vec3d point;
  double area;
};
struct OnBorder {
  Vec3d point, along;
};

SolidAngle of(double area, double border) { return {area, std::abs(area - border)}; }

SolidAngle disc(const Shape& s) {
  const Vec3d normal = normalized(cross(s.u, s.v));
  const double radius = length(s.u);
  const double to_plane = std::abs(dot(s.centre, normal));
  std::vector<double> rings{0};
  for (double r = 0.5 * to_plane; r < radius; r *= 4) rings.push_back(r);
  rings.push_back(radius);
  const double turns[] = {0, 0.5 * pi, pi, 1.5 * pi, 2 * pi};
  const auto patch = [&](double r, double t) {
    return OnPatch{s.centre + (s.u * std::cos(t) + s.v * std::sin(t)) * (r / radius), r};
  };
  const auto border = [&](double t) {
    return OnBorder{s.centre + s.u * std::cos(t) + s.v * std::sin(t), s.v * std::cos(t) - s.u * std::sin(t)};
  };
  return of(over_area(patch, normal, rings, turns), within_border(border, s.centre, turns));
}

/// A flat polygon of three or four corners, four being a parallelogram, around its middle.
SolidAngle polygon(std::span<const Vec3d> corners) {
  const std::size_t n = corners.size();
  Vec3d middle{};
  for (const Vec3d& c : corners) middle += c * (1 / double(n));
  const Vec3d a = corners[0], u = corners[1] - a, v = corners[n - 1] - a, area = cross(u, v);
  const Vec3d normal = normalized(area);
  const double unit[] = {0, 0.5, 1};
  const auto patch = [&](double s, double t) {
    const double across = n == 3 ? 1 - s : 1;
    return OnPatch{a + u * s + v * (t * across), length(area) * across};
  };
  std::vector<double> breaks;
  for (std::size_t k = 0; k <= n; ++k) breaks.push_back(double(k));
  const auto border = [&](double t) {
    const std::size_t k = std::min(n - 1, static_cast<std::size_t>(t));
    const Vec3d side = corners[(k + 1) % n] - corners[k];
    return OnBorder{corners[k] + side * (t - double(k)), side};
  };
  return of(over_area(patch, normal, unit, unit), within_border(border, middle, breaks));
}

/// The faces of a box that the viewer sees; all, from inside.
template <class F>
void for_each_seen_face(const Shape& s, const F& f) {
  const auto inside = [&](int k) { return std::abs(s.centre[k]) < s.u[k]; };
  const bool within = inside(0) && inside(1) && inside(2);
  for (int k = 0; k < 3; ++k)
    for (const double side : {-1.0, 1.0}) {
      const double at = s.centre[k] + side * s.u[k];
      if (!within && at * side > 0) continue;
      Vec3d middle = s.centre, u{}, v{};
      middle[k] = at;
      u[(k + 1) % 3] = s.u[(k + 1) % 3], v[(k + 2) % 3] = s.u[(k + 2) % 3];
      f(middle, u, v);
    }
}

SolidAngle parallelogram(const Vec3d& middle, const Vec3d& u, const Vec3d& v) {
  const Vec3d corners[] = {middle - u - v, middle + u - v, middle + u + v, middle - u + v};
  return polygon(corners);
}

SolidAngle sphere(const Shape& s) {
  const double d = length(s.centre), radius = length(s.u), sine = radius / d;
  const Vec3d towards = -s.centre * (1 / d);
  const geometry::Frame<double> f(towards);
  // The part of its surface that is seen, by the angle at its centre.
  const double limit[] = {0, std::acos(sine)};
  const auto ring = [&](double b) {
    const Vec3d n = towards * std::cos(b) + f.x * std::sin(b), p = s.centre + n * radius;
    const double d2 = dot(p, p);
    return Values<1>{2 * pi * radius * radius * std::sin(b) * -dot(p, n) / (d2 * std::sqrt(d2))};
  };
  return of(2 * pi * sine * sine / (1 + std::sqrt((1 - sine) * (1 + sine))),
            integrate<1>(ring, limit, tolerance_of_shapes)[0]);
}

}  // namespace

SolidAngle solid_angle_truth(const Shape& s) {
  switch (s.kind) {
    case ShapeKind::sphere:
      return sphere(s);
    case ShapeKind::disc:
      return disc(s);
    case ShapeKind::triangle: {
      const Vec3d corners[] = {s.centre, s.centre + s.u, s.centre + s.v};
      return polygon(corners);
    }
    case ShapeKind::rectangle:
      return parallelogram(s.centre, s.u, s.v);
    case ShapeKind::box:
      break;
  }
  SolidAngle sum;
  for_each_seen_face(s, [&](const Vec3d& middle, const Vec3d& u, const Vec3d& v) {
    const SolidAngle face = parallelogram(middle, u, v);
    sum.value += face.value, sum.apart += face.apart;
  });
  return sum;
}

double area_over_r2(const Shape& s, bool tilted) {
  const auto flat = [&](const Vec3d& middle, double area, const Vec3d& normal) {
    const double d2 = dot(middle, middle);
    return area / d2 * (tilted ? std::abs(dot(middle, normal)) / std::sqrt(d2) : 1);
  };
  switch (s.kind) {
    case ShapeKind::sphere:
      return flat(s.centre, pi * dot(s.u, s.u), normalized(s.centre));  // its cross-section
    case ShapeKind::disc:
      return flat(s.centre, pi * dot(s.u, s.u), normalized(cross(s.u, s.v)));
    case ShapeKind::triangle: {
      const Vec3d n = cross(s.u, s.v);
      return flat(s.centre + (s.u + s.v) * (1.0 / 3), 0.5 * length(n), normalized(n));
    }
    case ShapeKind::rectangle: {
      const Vec3d n = cross(s.u, s.v);
      return flat(s.centre, 4 * length(n), normalized(n));
    }
    case ShapeKind::box:
      break;
  }
  double sum = 0;
  for_each_seen_face(s, [&](const Vec3d& middle, const Vec3d& u, const Vec3d& v) {
    const Vec3d n = cross(u, v);
    sum += flat(middle, 4 * length(n), normalized(n));
  });
  return sum;
}

}  // namespace treeline::bench::brdf_integral
