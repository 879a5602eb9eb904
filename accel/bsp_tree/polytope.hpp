// The convex cell of a BSP node, for its surface area: a list of convex faces, cut by planes.
//
// A cut splits every face and closes both parts with the polygon in which the plane meets the cell, whose
// corners come in pairs from the faces and are put in order by angle. Cell and areas serve cost estimates
// only: a face too small to matter may be lost to rounding. Cost: about 50 operations a corner. Source: Ize,
// Wald and Parker 2008 (surface area heuristic on the true cells).
#pragma once

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/plane.hpp"

namespace treeline::accel {

class Polytope {
 public:
  using Point = geometry::Vec3d;
  using Plane = geometry::Plane3d;

  Polytope() = default;
  explicit Polytope(const geometry::Box3d& box) {
    static constexpr std::size_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& face : faces) {
      for (const std::size_t i : face)
        corners_.push_back({(i & 1 ? box.high : box.low)[0], (i & 2 ? box.high : box.low)[1],
                            (i & 4 ? box.high : box.low)[2]});
      ends_.push_back(corners_.size());
    }
  }

  double area() const {
    double sum = 0;
    each_face([&](const Point* face, std::size_t n) { sum += length(area_vector(face, n)); });
    return sum;
  }
  geometry::Box3d box() const {
    geometry::Box3d b;
    for (const Point& p : corners_) b.grow(p);
    return b;
  }

  /// Areas of the parts on the negative and on the positive side of a plane, without making them.
  std::array<double, 2> areas(const Plane& plane) const {
    std::array<double, 2> area{};
    std::array<Point, 2> total{};
    each_face([&](const Point* face, std::size_t n) {
      cut_face(face, n, plane);
      for (std::size_t side = 0; side < 2; ++side) {
        const Point a = area_vector(part_[side].data(), part_[side].size());
        total[side] += a, area[side] += length(a);
      }
    });
    // The area vectors of a closed surface add up to zero: what is missing is the cut.
    for (std::size_t side = 0; side < 2; ++side) area[side] += length(total[side]);
    return area;
  }

  std::array<Polytope, 2> cut(const Plane& plane) const {
    std::array<Polytope, 2> parts;
    std::vector<Point> rim;
    each_face([&](const Point* face, std::size_t n) {
      cut_face(face, n, plane);
      for (std::size_t side = 0; side < 2; ++side)
        if (part_[side].size() >= 3) parts[side].add_face(part_[side]);
      rim.insert(rim.end(), rim_.begin(), rim_.end());
    });
    if (rim.size() < 3) return parts;
    put_in_order(rim, plane.normal);
    parts[0].add_face(rim);
    std::reverse(rim.begin(), rim.end());
    parts[1].add_face(rim);
    return parts;
  }

 private:
  template <class F>
  void each_face(F&& f) const {
    std::size_t begin = 0;
    for (const std::size_t end : ends_) f(corners_.data() + begin, end - begin), begin = end;
  }
  static Point area_vector(const Point* face, std::size_t n) {
    Point twice{};
    for (std::size_t i = 1; i + 1 < n; ++i) twice += cross(face[i] - face[0], face[i + 1] - face[0]);
    return twice * 0.5;
  }
  void add_face(const std::vector<Point>& face) {
    corners_.insert(corners_.end(), face.begin(), face.end());
    ends_.push_back(corners_.size());
  }

  /// Leaves the parts of a face in part_, and the points in which it meets the plane in rim_.
  void cut_face(const Point* face, std::size_t n, const Plane& plane) const {
    part_[0].clear(), part_[1].clear(), rim_.clear();
    double d = plane.signed_distance(face[0]);
    for (std::size_t i = 0; i < n; ++i) {
      const Point &p = face[i], &q = face[i + 1 < n ? i + 1 : 0];
      const double next = plane.signed_distance(q);
      if (d <= 0) part_[0].push_back(p);
      if (d >= 0) part_[1].push_back(p);
      if (d == 0) rim_.push_back(p);
      if ((d < 0 && next > 0) || (d > 0 && next < 0)) {
        const Point x = p + (q - p) * (d / (d - next));
        part_[0].push_back(x), part_[1].push_back(x), rim_.push_back(x);
      }
      d = next;
    }
  }

  /// Around their mean, counter-clockwise seen from where the normal points. Points come twice, once from
  /// each of two faces; one of each remains.
  static void put_in_order(std::vector<Point>& points, const Point& normal) {
    Point mean{}, u{};
    for (const Point& p : points) mean += p * (1 / static_cast<double>(points.size()));
    for (const Point& p : points)
      if (length2(p - mean) > length2(u)) u = p - mean;
    const Point v = cross(normal, u);
    std::vector<std::pair<double, Point>> by_angle;
    for (const Point& p : points) by_angle.push_back({std::atan2(dot(p - mean, v), dot(p - mean, u)), p});
    std::sort(by_angle.begin(), by_angle.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    points.clear();
    for (const auto& [angle, p] : by_angle)
      if (points.empty() || length2(p - points.back()) > 1e-24 * length2(u)) points.push_back(p);
  }

  std::vector<Point> corners_;     // face after face
  std::vector<std::size_t> ends_;  // of the faces, in corners_
  mutable std::array<std::vector<Point>, 2> part_;
  mutable std::vector<Point> rim_;
};

}  // namespace treeline::accel
