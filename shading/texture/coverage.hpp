// How much of each texel a footprint covers, in closed form and double: the weights of the exact mean.
//
// Boxes along the axes: products of two overlaps. Rotated boxes: the box is cut into the strips of the
// texels' rows, these at the texels' columns; areas by the shoelace formula, but whole texels at once. Discs:
// the area left of a column within a row, integrated: of the height h(y) = sqrt(r² - y²) up to where it
// passes the column. Gaussians: differences of the error function along x and y, within their reach.
// Cost: O(texels). Accuracy: some 1e-15 of the footprint's area a texel.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "shading/texture/footprint.hpp"

namespace treeline::shading::texture {

namespace coverage {

struct Point {
  double x, y;
};

/// A convex polygon of few corners.
struct Polygon {
  std::array<Point, 10> p;
  int size = 0;

  void add(const Point& q) { p[static_cast<std::size_t>(size++)] = q; }
  const Point& operator[](int i) const { return p[static_cast<std::size_t>(i)]; }
  double area() const {
    double twice = 0;
    for (int i = 1; i + 1 < size; ++i)
      twice += (p[static_cast<std::size_t>(i)].x - p[0].x) * (p[static_cast<std::size_t>(i) + 1].y - p[0].y) -
               (p[static_cast<std::size_t>(i) + 1].x - p[0].x) * (p[static_cast<std::size_t>(i)].y - p[0].y);
    return 0.5 * std::abs(twice);
  }
};

/// The part with sign * coordinate <= sign * limit (Sutherland and Hodgman 1974).
template <double Point::*coordinate>
Polygon cut(const Polygon& from, double limit, double sign) {
  Polygon r;
  for (int i = 0; i < from.size; ++i) {
    const Point &a = from[i], &b = from[i + 1 == from.size ? 0 : i + 1];
    const double da = sign * (limit - a.*coordinate), db = sign * (limit - b.*coordinate);
    if (da >= 0) r.add(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
      const double t = da / (da - db);
      Point q{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
      q.*coordinate = limit;
      r.add(q);
    }
  }
  return r;
}

/// The integral of sqrt(r² - y²) from 0 to y.
inline double half_disc(double y, double r) {
  const double t = std::clamp(y / r, -1.0, 1.0);
  return 0.5 * r * r * (t * std::sqrt((1 - t) * (1 + t)) + std::asin(t));
}

/// The area of the disc around the origin with y in [y0, y1] and x <= a.
inline double disc_left_of(double a, double y0, double y1, double r) {
  y0 = std::clamp(y0, -r, r), y1 = std::clamp(y1, -r, r);
  const double whole = 2 * (half_disc(y1, r) - half_disc(y0, r));
  if (a >= r) return whole;
  if (a <= -r) return 0;
  const double b = std::sqrt((r - a) * (r + a));  // the circle passes x = a at y = -b and b
  const double m0 = std::clamp(y0, -b, b), m1 = std::clamp(y1, -b, b);
  const double between = a * (m1 - m0) + half_disc(m1, r) - half_disc(m0, r);
  return a < 0 ? between : between + whole - 2 * (half_disc(m1, r) - half_disc(m0, r));
}

/// Calls f(j, top, bottom) for the rows of texels that [y0, y1] touches.
template <class F>
void rows(double y0, double y1, F&& f) {
  for (double j = std::floor(y0); j < y1; ++j) f(j, std::max(j, y0), std::min(j + 1, y1));
}

template <class F>
void box(const Footprint& f, F&& add) {
  const Box b = bounding_box(f);
  rows(b.y0, b.y1, [&](double j, double top, double bottom) {
    rows(b.x0, b.x1,
         [&](double i, double left, double right) { add(i, j, (right - left) * (bottom - top)); });
  });
}

template <class F>
void rotated(const Footprint& f, F&& add) {
  Polygon whole;
  for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
    whole.add({f.x + a * f.ux + b * f.vx, f.y + a * f.uy + b * f.vy});
  double low = INFINITY, high = -INFINITY;
  for (int i = 0; i < whole.size; ++i) low = std::min(low, whole[i].y), high = std::max(high, whole[i].y);
  rows(low, high, [&](double j, double top, double bottom) {
    const Polygon strip = cut<&Point::y>(cut<&Point::y>(whole, bottom, 1), top, -1);
    if (strip.size < 3) return;
    // Where the strip is as high as the row, texels between its borders at top and bottom are whole.
    double left = INFINITY, right = -INFINITY, from = -INFINITY, to = INFINITY;
    for (int side = 0; side < 2; ++side) {
      double least = INFINITY, most = -INFINITY;
      for (int i = 0; i < strip.size; ++i)
        if (strip[i].y == (side == 0 ? top : bottom))
          least = std::min(least, strip[i].x), most = std::max(most, strip[i].x);
      from = std::max(from, least), to = std::min(to, most);
    }
    for (int i = 0; i < strip.size; ++i)
      left = std::min(left, strip[i].x), right = std::max(right, strip[i].x);
    const bool whole_row = top == j && bottom == j + 1;
    Polygon rest = strip;
    for (double i = std::floor(left); i < right; ++i) {
      if (whole_row && i >= from && i + 1 <= to) {
        add(i, j, 1.0);
        continue;
      }
      const Polygon texel = cut<&Point::x>(cut<&Point::x>(rest, i + 1, 1), i, -1);
      if (const double area = texel.size < 3 ? 0 : texel.area(); area > 0) add(i, j, area);
    }
  });
}

template <class F>
void disc(const Footprint& f, F&& add) {
  const double r = std::hypot(f.ux, f.uy);
  rows(f.y - r, f.y + r, [&](double j, double top, double bottom) {
    const double y0 = top - f.y, y1 = bottom - f.y;
    const double near = y0 <= 0 && y1 >= 0 ? 0 : std::min(std::abs(y0), std::abs(y1));
    const double reach = near < r ? std::sqrt((r - near) * (r + near)) : 0;
    const double first = std::floor(f.x - reach);
    double before = disc_left_of(first - f.x, y0, y1, r);
    for (double i = first; i < f.x + reach; ++i) {
      const double here = disc_left_of(i + 1 - f.x, y0, y1, r);
      if (here > before) add(i, j, here - before);
      before = here;
    }
  });
}

/// The weights of the texels that the reach along one axis touches.
inline std::vector<double> gaussian_weights(double centre, double sigma) {
  std::vector<double> r;
  const double scale = 0.7071067811865476 / sigma;
  rows(centre - gaussian_reach * sigma, centre + gaussian_reach * sigma, [&](double, double a, double b) {
    r.push_back(0.5 * (std::erf((b - centre) * scale) - std::erf((a - centre) * scale)));
  });
  return r;
}

template <class F>
void gaussian(const Footprint& f, F&& add) {
  const double sx = std::abs(f.ux), sy = std::abs(f.vy);
  const std::vector<double> wx = gaussian_weights(f.x, sx), wy = gaussian_weights(f.y, sy);
  const double i0 = std::floor(f.x - gaussian_reach * sx), j0 = std::floor(f.y - gaussian_reach * sy);
  for (std::size_t j = 0; j < wy.size(); ++j)
    for (std::size_t i = 0; i < wx.size(); ++i)
      add(i0 + static_cast<double>(i), j0 + static_cast<double>(j), wx[i] * wy[j]);
}

}  // namespace coverage

/// Calls f(i, j, weight) for every texel that the footprint covers, row by row, inside of the texture or not;
/// the numbers of column and row are whole. Weights are areas in texels (of Gaussians, shares). Returns their
/// sum. Boxes without area, which no texel is covered by, are the caller's matter.
template <class F>
double for_each_texel(const Footprint& f, F&& visit) {
  double sum = 0;
  const auto add = [&](double i, double j, double weight) { sum += weight, visit(i, j, weight); };
  switch (f.shape) {
    case Shape::box:
      f.aligned() ? coverage::box(f, add) : coverage::rotated(f, add);
      break;
    case Shape::disc:
      coverage::disc(f, add);
      break;
    case Shape::gaussian:
      coverage::gaussian(f, add);
      break;
  }
  return sum;
}

}  // namespace treeline::shading::texture
