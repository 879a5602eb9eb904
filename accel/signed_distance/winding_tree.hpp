// How often a mesh winds around a point, summed over its faces, or over groups of them from afar.
//
// Sources: the winding number is the sum of the signed solid angles of all faces over 4 pi (Jacobson, Kavan
// and Sorkine-Hornung 2013, "Robust inside-outside segmentation using generalized winding numbers"), each by
// van Oosterom and Strackee 1983. Groups seen from farther than `reach` times their radius count by their
// Taylor expansion to second order about the centre of their area (Barill, Dickson, Schmidt, Levin and
// Jacobson 2018, "Fast winding numbers for soups and clouds"). For a closed mesh it is a whole number, 0
// outside; for one with holes it fades across them. Every face counts by its area: one that is missing or
// turned around is felt nearby and nowhere else.
//
// Groups lie where WindingPlace moves them: a mesh far from the origin is as one at it, and one of any size
// as one of size 1. Their balls hold the corners themselves, not what float makes of them for the builder.
// Moments are kept in units of a group's radius, so that neither they nor their powers leave the range of
// float. Single faces are looked at where they are given. Cost: 128 bytes a node, 36 bytes a face and some 15
// ns a group met. Known weakness: near the surface the exact sum of the nearest leaves takes most of the
// time; the second order leaves an error of some 1e-3 with the default reach.
#pragma once

#include <numbers>

#include "accel/bvh/build_binned.hpp"
#include "accel/concepts.hpp"
#include "accel/triangle_place.hpp"
#include "geometry/exact/orientation.hpp"
#include "geometry/exact/triangle_distance.hpp"
#include "geometry/mesh.hpp"

namespace treeline::accel {

/// Sums of signed solid angles of triangles seen from a point.
///
/// The tangent of half an angle is a quotient (van Oosterom and Strackee 1983), so half the angle is that of
/// a complex number, and angles add up as the numbers are multiplied: one arc tangent does for all, and full
/// turns are counted where the product passes the negative real axis. On which side of a triangle's plane
/// the point lies is decided exactly. Error: some roundings of double a triangle, times the square of its
/// size over the distance from the point to its edges. Coordinates of any size.
class SolidAngles {
 public:
  explicit SolidAngles(const geometry::Vec3d& from) : from_(from) {}

  void add(const geometry::Triangle3d& t) {
    geometry::Vec3d a = t.a - from_, b = t.b - from_, c = t.c - from_;
    double la = length(a), lb = length(b), lc = length(c);
    constexpr double shortest = 1e-80, longest = 1e80;  // products of three lengths lose no digits
    if (!(std::min({la, lb, lc}) > shortest && std::max({la, lb, lc}) < longest)) [[unlikely]] {
      a = towards(t.a), b = towards(t.b), c = towards(t.c);
      la = length(a), lb = length(b), lc = length(c);
    }
    const double scale = la * lb * lc;
    double y = dot(a, cross(b, c));
    const double x = scale + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    constexpr double flat = 1e-12;  // above, the sign of y is right for certain
    if (!(std::abs(y) > flat * scale)) [[unlikely]] {
      const int side = geometry::orientation(t.a, t.b, t.c, from_);
      if (side == 0) {  // seen edge-on
        on_ = on_ || geometry::exact_distance2(from_, t) == 0;
        return;
      }
      // In front of a face half the angle is just above -pi, behind it just below: the sign is all there is.
      y = -side * std::max(std::abs(y), scale * 0x1p-60);
    }
    const double p = x_ * x - y_ * y, q = x_ * y + y_ * x;
    const bool above = y_ >= 0, other_above = y >= 0;
    turns_ += above && other_above && q < 0 ? 1 : 0;
    turns_ -= !above && !other_above && q >= 0 ? 1 : 0;
    const double size = 1 / std::max(std::abs(p), std::abs(q));
    x_ = p * size, y_ = q * size;
  }
  /// The sum over 4 pi: positive from behind.
  double winding() const { return turns_ + std::atan2(y_ + 0.0, x_) / (2 * std::numbers::pi); }
  /// Whether the point is on one of the triangles, which has no angle then.
  bool on_one() const { return on_; }

 private:
  /// A vector from the point to another: only its direction is right, which is all that an angle needs.
  [[gnu::noinline, gnu::cold]] geometry::Vec3d towards(const geometry::Vec3d& to) const {
    geometry::Vec3d d = to - from_;
    if (!is_finite(d)) d = to * 0.5 - from_ * 0.5;
    const double most = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
    if (most > 0)
      for (int k = 0; k < 3; ++k) d[k] = std::ldexp(d[k], -std::ilogb(most));
    return d;
  }

  geometry::Vec3d from_;
  double x_ = 1, y_ = 0;
  int turns_ = 0;
  bool on_ = false;
};

struct WindingNumber {
  double value = 0;
  bool on_surface = false;  ///< the point is on a face; value leaves that face out
};

/// Where moments are taken: coordinates of some 1, moved and scaled without a rounding.
class WindingPlace {
 public:
  WindingPlace() = default;
  template <class T>
  explicit WindingPlace(const geometry::Box<T, 3>& box) : origin_(exact_centre(box)) {
    double largest = 0;
    for (int k = 0; k < 3; ++k)
      largest = std::max(
          {largest, std::abs(double(box.low[k]) - origin_[k]), std::abs(double(box.high[k]) - origin_[k])});
    if (largest > 0) factor_ = std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1022, 1022));
  }
  /// Infinite for points too far away to be told from that.
  geometry::Vec3d operator()(const geometry::Vec3d& p) const {
    return factor_ < 1 ? p * factor_ - origin_ * factor_ : (p - origin_) * factor_;
  }
  geometry::Triangle3d operator()(const geometry::Triangle3d& t) const {
    return {(*this)(t.a), (*this)(t.b), (*this)(t.c)};
  }

 private:
  geometry::Vec3d origin_{};
  double factor_ = 1;
};

template <class T>
class WindingTree {
 public:
  using Point = geometry::Vec<T, 3>;

  /// reach: from how many of its radii on a group of faces counts by its moments; at least 1, infinite for
  /// the exact sum. Faces without area do not count, nor, where they are dropped, those with a corner that is
  /// not finite. Throws InvalidInput for such a corner where it is refused, a face that names no vertex, a
  /// reach below 1 or threads < 1.
  WindingTree(const geometry::Mesh<T>& mesh, double reach, int threads,
              NonFinite non_finite = NonFinite::refuse)
      : reach_(reach) {
    if (!(reach >= 1)) throw InvalidInput("reach is " + std::to_string(reach) + "; it must be at least 1");
    check_threads(threads);
    const std::vector<geometry::Triangle<T>> triangles = with_area(mesh, non_finite);
    if (triangles.empty()) return;
    geometry::Box<T, 3> box;
    for (const auto& t : triangles) box.grow(t.box());
    place_ = WindingPlace(box);
    std::vector<geometry::Triangle<float>> rounded;
    rounded.reserve(triangles.size());
    for (const auto& t : triangles) rounded.emplace_back(place_(geometry::Triangle3d(t)));
    BinaryBuildOptions how;
    how.threads = threads;
    const BinaryTree binary = build_binned(rounded, how);
    triangles_.reserve(binary.references.size());
    for (const std::uint32_t i : binary.references) triangles_.push_back(triangles[i]);
    nodes_.resize(binary.nodes.size());
    gather(binary);
  }

  WindingNumber operator()(const Point& q) const {
    WindingNumber r;
    const geometry::Vec3d placed = place_(geometry::Vec3d(q));
    SolidAngles near{geometry::Vec3d(q)};
    std::uint32_t stack[2 * binary_max_depth + 2];
    int height = 0;
    if (!nodes_.empty()) stack[height++] = 0;
    while (height > 0) {
      const Node& node = nodes_[stack[--height]];
      const geometry::Vec3d away = geometry::Vec3d(node.centre) - placed;
      const double distance = length(away);
      if (distance > reach_ * double(node.radius)) {
        if (distance < nowhere * double(node.radius))
          r.value += node.from_afar(geometry::Vec3f(away / double(node.radius)));
      } else if (node.count > 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
          near.add(geometry::Triangle3d(triangles_[i]));
      } else {
        stack[height++] = node.first, stack[height++] = node.first + 1;
      }
    }
    r.value += near.winding(), r.on_surface = near.on_one();
    return r;
  }

  std::size_t bytes() const {
    return nodes_.capacity() * sizeof(Node) + triangles_.capacity() * sizeof(triangles_[0]);
  }

 private:
  /// From so many radii even 2^32 faces make less than 1e-8, and cubes of more leave the range of float.
  static constexpr double nowhere = 0x1p30;

  static std::vector<geometry::Triangle<T>> with_area(const geometry::Mesh<T>& mesh, NonFinite non_finite) {
    std::vector<geometry::Triangle<T>> triangles;
    triangles.reserve(mesh.size());
    for (std::size_t f = 0; f < mesh.size(); ++f) {
      for (const std::uint32_t corner : mesh.faces[f])
        if (corner >= mesh.vertices.size())
          throw InvalidInput("face " + std::to_string(f) + " names vertex " + std::to_string(corner) +
                             " of " + std::to_string(mesh.vertices.size()));
      const geometry::Triangle<T> t = mesh.triangle(f);
      if (!is_finite(t)) {
        if (non_finite == NonFinite::drop) continue;
        throw InvalidInput("triangle " + std::to_string(f) + " has a coordinate that is not finite");
      }
      if (!geometry::is_degenerate(t)) triangles.push_back(t);
    }
    return triangles;
  }

  /// Moments about the centre in units of the radius, over 4 pi, as far as the expansion needs them.
  struct Node {
    Point centre{};
    float radius = 0;  // of a ball about the centre that holds the group
    std::uint32_t first = 0, count = 0;
    float area[3]{};       // of area times normal
    float trace = 0;       // of the first moments
    float first_order[6];  // of the first moments, symmetric: xx yy zz, twice xy yz zx
    float vector[3]{};     // of the second moments, contracted
    float cubic[10]{};     // of the second moments, symmetric: xxx yyy zzz, xxy xxz yyx yyz zzx zzy, xyz

    float from_afar(const geometry::Vec3f& r) const {
      const float x = r[0], y = r[1], z = r[2], xx = x * x, yy = y * y, zz = z * z;
      const float inverse2 = 1 / (xx + yy + zz), inverse = std::sqrt(inverse2), inverse3 = inverse * inverse2;
      const float zeroth = area[0] * x + area[1] * y + area[2] * z;
      const float first = first_order[0] * xx + first_order[1] * yy + first_order[2] * zz +
                          first_order[3] * x * y + first_order[4] * y * z + first_order[5] * z * x;
      const float along = vector[0] * x + vector[1] * y + vector[2] * z;
      const float third = xx * (cubic[0] * x + cubic[3] * y + cubic[4] * z) +
                          yy * (cubic[1] * y + cubic[5] * x + cubic[6] * z) +
                          zz * (cubic[2] * z + cubic[7] * x + cubic[8] * y) + cubic[9] * x * y * z;
      return inverse3 * (zeroth + trace - 3 * inverse2 * (first + along - 5 * inverse2 * third));
    }
  };

  /// Integrals over a group of faces: of the normal, of (x - centre) n, of (x - centre) (x - centre) n / 2.
  struct Moments {
    geometry::Vec3d centre{}, normal{};
    double area = 0;
    double first[3][3]{}, second[3][3][3]{};  // the last index is the normal's

    /// The same about another centre, added.
    void add(const Moments& m) {
      const geometry::Vec3d d = m.centre - centre;
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
          first[i][k] += m.first[i][k] + d[i] * m.normal[k];
          for (int j = 0; j < 3; ++j)
            second[i][j][k] += m.second[i][j][k] + 0.5 * (d[i] * m.first[j][k] + d[j] * m.first[i][k] +
                                                          d[i] * d[j] * m.normal[k]);
        }
      normal += m.normal;
    }
  };

  static Moments moments_of(const geometry::Triangle3d& t) {
    Moments m;
    m.centre = t.centroid(), m.normal = t.area_normal() * 0.5, m.area = length(m.normal);
    const geometry::Vec3d u[3] = {t.a - m.centre, t.b - m.centre, t.c - m.centre};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        // The mean of x_i x_j over the triangle about its centroid is a twelfth of the corners' sum.
        const double mean = (u[0][i] * u[0][j] + u[1][i] * u[1][j] + u[2][i] * u[2][j]) / 12;
        for (int k = 0; k < 3; ++k) m.second[i][j][k] = 0.5 * mean * m.normal[k];
      }
    return m;
  }

  /// From the leaves up. The centre is the mean of the parts' centres by area, as T holds it.
  void gather(const BinaryTree& binary) {
    std::vector<Moments> moments(binary.nodes.size());
    std::vector<geometry::Box<double, 3>> boxes(binary.nodes.size());  // of the corners, not rounded
    std::vector<std::uint32_t> order{0};                               // parents before children
    for (std::size_t i = 0; i < order.size(); ++i)
      if (const BinaryNode& n = binary.nodes[order[i]]; n.count == 0)
        order.push_back(n.first), order.push_back(n.first + 1);
    for (std::size_t i = order.size(); i-- > 0;) {
      const BinaryNode& from = binary.nodes[order[i]];
      std::vector<Moments> parts;
      auto& box = boxes[order[i]];
      if (from.count == 0) {
        parts = {moments[from.first], moments[from.first + 1]};
        box.grow(boxes[from.first]), box.grow(boxes[from.first + 1]);
      }
      for (std::uint32_t k = from.first; k < from.first + from.count; ++k) {
        const geometry::Triangle3d t = place_(geometry::Triangle3d(triangles_[k]));
        parts.push_back(moments_of(t)), box.grow(t.box());
      }
      Moments& m = moments[order[i]];
      geometry::Vec3d sum{};
      for (const Moments& part : parts) m.area += part.area, sum += part.centre * part.area;
      const geometry::Vec3d middle = m.area > 0 ? sum / m.area : box.centre();
      m.centre = geometry::Vec3d(Point(middle));
      for (const Moments& part : parts) m.add(part);
      Node& node = nodes_[order[i]];
      node.first = from.first, node.count = from.count;
      pack(m, box, node);
    }
  }
  static void pack(const Moments& m, const geometry::Box<double, 3>& box, Node& node) {
    node.centre = Point(m.centre);
    geometry::Vec3d far;
    for (int k = 0; k < 3; ++k)
      far[k] = std::max(std::abs(box.low[k] - m.centre[k]), std::abs(box.high[k] - m.centre[k]));
    // Rounded up.
    node.radius = static_cast<float>(length(far) * (1 + 1e-6)) + std::numeric_limits<float>::denorm_min();
    const double r = double(node.radius);
    constexpr double whole = 4 * std::numbers::pi;
    const double zeroth = 1 / (whole * r * r), first = zeroth / r, second = first / r;
    const auto f = [](double x) { return static_cast<float>(x); };
    for (int k = 0; k < 3; ++k) node.area[k] = f(m.normal[k] * zeroth);
    const auto& p = m.first;
    node.trace = f((p[0][0] + p[1][1] + p[2][2]) * first);
    for (int k = 0; k < 3; ++k) {
      node.first_order[k] = f(p[k][k] * first);
      node.first_order[3 + k] = f((p[k][(k + 1) % 3] + p[(k + 1) % 3][k]) * first);
      double contracted = 0;
      for (int i = 0; i < 3; ++i) contracted += 2 * m.second[i][k][i] + m.second[i][i][k];
      node.vector[k] = f(contracted * second);
    }
    const auto symmetric = [&](int i, int j, int k) {  // the sum over all orders of the indices
      const auto& s = m.second;
      if (i == j && j == k) return f(s[i][i][i] * second);
      if (i == j) return f((s[i][i][k] + s[i][k][i] + s[k][i][i]) * second);
      return f((s[i][j][k] + s[j][k][i] + s[k][i][j] + s[j][i][k] + s[k][j][i] + s[i][k][j]) * second);
    };
    const float cubic[10] = {symmetric(0, 0, 0), symmetric(1, 1, 1), symmetric(2, 2, 2), symmetric(0, 0, 1),
                             symmetric(0, 0, 2), symmetric(1, 1, 0), symmetric(1, 1, 2), symmetric(2, 2, 0),
                             symmetric(2, 2, 1), symmetric(0, 1, 2)};
    std::copy(cubic, cubic + 10, node.cubic);
  }

  double reach_;
  WindingPlace place_;
  std::vector<Node> nodes_;
  std::vector<geometry::Triangle<T>> triangles_;
};

}  // namespace treeline::accel
