// Pairs of faces of a mesh that may have a point in common beyond the corners and edges that both have.
//
// Problem: the exact test of all pairs is n². Boxes tell most pairs apart, but not those around one corner,
// where all of them meet: n faces of a cone would be n² pairs again. Method: faces with a corner that many
// share, a fan, are looked at from there, where they are arcs of all directions, in a tree over boxes around
// these. Two faces of a fan meet elsewhere only if their arcs do, since next to the corner a face is as good
// as its angle; any other face meets only those whose arcs meet the cone in which it is seen. Pairs of faces
// in no fan: a tree over those of each class of sizes; each asks its own and the smaller classes for boxes
// that meet its own, are not on one side of its plane and not beside it. Cost: O(n log n) and the pairs that
// are left, six to eight a face on a surface. Known weakness: n faces on one spot or around one edge are n²
// pairs, as are those that end next to one spot at corners of their own.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "accel/batch.hpp"
#include "accel/far_from.hpp"
#include "geometry/box_tree.hpp"

namespace treeline::accel {

namespace detail {

/// Of a face: numbers of its corners, equal where positions are.
using Corners = std::array<std::uint32_t, 3>;

/// The corners that many faces share.
class FanCorners {
 public:
  static constexpr std::uint32_t many = 32;
  static constexpr std::uint32_t none = 0xffffffffu;

  explicit FanCorners(std::span<const Corners> corners) : corners_(corners), first_(1) {
    for (const Corners& c : corners)
      for (const std::uint32_t v : c) {
        if (v >= around_.size()) around_.resize(v + std::size_t{1});
        ++around_[v];
      }
    std::vector<std::uint32_t> number(around_.size(), none);
    for (std::uint32_t v = 0; v < around_.size(); ++v)
      if (is_fan(v)) number[v] = static_cast<std::uint32_t>(first_.size()) - 1, first_.push_back(around_[v]);
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    faces_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t f = 0; f < corners.size(); ++f)
      for (std::uint32_t k = 0; k < 3; ++k)
        if (const std::uint32_t v = corners[f][k]; is_fan(v)) faces_[next[number[v]]++] = {f, k};
  }

  std::size_t size() const { return first_.size() - 1; }
  struct Seat {
    std::uint32_t face, place;  // of its corners
  };
  /// The faces around one of them.
  std::span<const Seat> faces(std::size_t fan) const {
    return std::span(faces_).subspan(first_[fan], first_[fan + 1] - first_[fan]);
  }
  std::uint32_t corner(const Seat& seat) const { return corners_[seat.face][seat.place]; }
  bool is_fan(std::uint32_t corner) const { return around_[corner] >= many; }
  /// The one of a face that most faces share.
  std::uint32_t of(std::uint32_t face) const {
    std::uint32_t most = none;
    for (const std::uint32_t v : corners_[face])
      if (is_fan(v) && (most == none || around_[v] > around_[most])) most = v;
    return most;
  }
  bool has(std::uint32_t face, std::uint32_t corner) const {
    const Corners& c = corners_[face];
    return c[0] == corner || c[1] == corner || c[2] == corner;
  }
  /// The first one that both faces have: there they are looked at as a pair.
  std::uint32_t shared(std::uint32_t f, std::uint32_t g) const {
    std::uint32_t first = none;
    if (size() == 0) return first;
    for (const std::uint32_t v : corners_[f])
      if (is_fan(v) && has(g, v)) first = std::min(first, v);
    return first;
  }

 private:
  std::span<const Corners> corners_;
  std::vector<std::uint32_t> around_;  // faces that have a corner
  std::vector<std::size_t> first_;     // of a fan, in the list
  std::vector<Seat> faces_;
};

/// The directions from a corner of a face to its other points: an arc of the unit sphere, in a box.
class Arc {
 public:
  template <class T>
  Arc(const geometry::Vec<T, 3>& at, const geometry::Vec<T, 3>& p, const geometry::Vec<T, 3>& q)
      : from_(normalized(geometry::Vec3d(p) - geometry::Vec3d(at))),
        to_(normalized(geometry::Vec3d(q) - geometry::Vec3d(at))) {
    // No point of an arc is farther from its chord than the one in the middle. Directions are off by some
    // 2^-51; beyond a third of a circle a radius is enough.
    constexpr double roundings = 0x1p-40;
    const double chord2 = distance2(from_, to_);
    is_short_ = chord2 < 3;
    const double rise = (is_short_ ? 1 - std::sqrt(1 - chord2 / 4) : 1) + roundings;
    const auto off = geometry::Vec3d::filled(rise);
    box_ = {min(from_, to_) - off, max(from_, to_) + off};
  }
  const geometry::Box3d& box() const { return box_; }
  /// Of its circle's plane; none where two directions that are off by roundings do not give it.
  std::optional<FarFromPlane> far_from_circle() const {
    if (!is_short_) return std::nullopt;
    return FarFromPlane(geometry::Triangle3d{{}, from_, to_});
  }

 private:
  geometry::Vec3d from_, to_;
  geometry::Box3d box_;
  bool is_short_;
};

/// The directions from a point to those of a triangle.
class Cone {
 public:
  template <class T>
  Cone(const geometry::Vec3d& from, const geometry::Triangle<T>& t)
      : to_{geometry::Vec3d(t.a) - from, geometry::Vec3d(t.b) - from, geometry::Vec3d(t.c) - from} {
    for (auto& d : to_) {
      if (d == geometry::Vec3d{}) return;
      d = normalized(d);
    }
    // Sums of directions, by weights of 1 in all, are then no shorter than 1/4, and their roundings small.
    constexpr double least = -0.4;
    is_narrow_ = std::min({dot(to_[0], to_[1]), dot(to_[1], to_[2]), dot(to_[2], to_[0])}) > least;
    for (int i = 0; i < 3; ++i) {
      side_[i] = cross(to_[i], to_[(i + 1) % 3]);
      inner_[i] = dot(side_[i], to_[(i + 2) % 3]);
    }
  }
  /// Whether no direction in a box is one of these.
  bool is_far(const geometry::Box3d& box) const {
    constexpr double doubt = 0x1p-42, roundings = 8 * doubt;  // directions are off by some 2^-51
    if (!is_narrow_) return false;
    const geometry::Vec3d centre = box.centre(), half = box.extent() * 0.5;
    for (int i = 0; i < 3; ++i) {
      double middle = 0, reach = roundings;
      for (int k = 0; k < 3; ++k) middle += side_[i][k] * centre[k], reach += std::abs(side_[i][k]) * half[k];
      if ((inner_[i] > -doubt && middle < -reach) || (inner_[i] < doubt && middle > reach)) return true;
    }
    return false;
  }

 private:
  geometry::Vec3d to_[3];
  geometry::Vec3d side_[3];  // normals of the planes through two of them
  double inner_[3];          // on which side of each the third one is
  bool is_narrow_ = false;
};

/// Whether boxes are near to a face, as far as boxes, its plane and its edges tell.
template <class T>
class NearFace {
 public:
  explicit NearFace(const geometry::Triangle<T>& t) : triangle_(t), box_(t.box()), far_from_plane_(t) {}

  bool operator()(const geometry::Box<T, 3>& box) {
    constexpr std::size_t many = 128;  // where there is much to keep away from
    if (++boxes_ == many) far_from_edges_.emplace(triangle_);
    return box_.overlaps(box) && !far_from_plane_(box) && !(far_from_edges_ && (*far_from_edges_)(box));
  }
  /// Looked at so far.
  std::size_t boxes() const { return boxes_; }

 private:
  const geometry::Triangle<T>& triangle_;
  geometry::Box<T, 3> box_;
  FarFromPlane far_from_plane_;
  std::optional<FarFromEdges> far_from_edges_;
  std::size_t boxes_ = 0;
};

/// The faces around corners of many, seen from there.
template <class T>
class Fans {
 public:
  Fans(std::span<const geometry::Triangle<T>> triangles, const FanCorners& corners)
      : triangles_(triangles), corners_(corners), fans_(corners.size()) {
    std::vector<geometry::Box<T, 3>> roots;
    std::vector<geometry::Box3d> around;
    for (std::size_t i = 0; i < fans_.size(); ++i) {
      around.clear();
      geometry::Box<T, 3>& root = roots.emplace_back();
      for (const auto& [face, k] : corners.faces(i)) {
        const geometry::Triangle<T>& t = triangles[face];
        const auto& at = k == 0 ? t.a : k == 1 ? t.b : t.c;
        fans_[i].from = geometry::Vec3d(at);
        fans_[i].arcs.push_back(k == 0 ? Arc(at, t.b, t.c) : k == 1 ? Arc(at, t.c, t.a) : Arc(at, t.a, t.b));
        around.push_back(fans_[i].arcs.back().box());
        root.grow(t.box());
      }
      fans_[i].tree = geometry::BoxTree<double>(around);
    }
    roots_ = geometry::BoxTree<T>(roots);
  }

  /// Calls visit(face, other) for faces of the fan that come after the one in a seat and may meet it beyond
  /// the fan's corner. Returns how many boxes it has looked at.
  template <class Visit>
  std::size_t each_beside(std::size_t fan, std::size_t seat, Visit& visit) const {
    const auto seats = corners_.faces(fan);
    const Arc& arc = fans_[fan].arcs[seat];
    const auto far_from_circle = arc.far_from_circle();
    std::size_t boxes = 0;
    fans_[fan].tree.each(
        [&](const geometry::Box3d& box) {
          return ++boxes, arc.box().overlaps(box) && !(far_from_circle && (*far_from_circle)(box));
        },
        [&](std::uint32_t other) {
          const std::uint32_t f = seats[seat].face, g = seats[other].face;
          if (seat < other && corners_.shared(f, g) == corners_.corner(seats[seat])) visit(f, g);
        });
    return boxes;
  }
  /// Calls visit(face, other) for faces of fans that may meet this one and share none. Of two that are both
  /// in fans one finds the other.
  template <class Visit>
  std::size_t each_near(std::uint32_t face, Visit& visit) const {
    NearFace<T> near(triangles_[face]);
    const std::uint32_t own = corners_.of(face);
    std::size_t boxes = 0;
    roots_.each(near, [&](std::uint32_t number) {
      const Fan& fan = fans_[number];
      const auto seats = corners_.faces(number);
      const std::uint32_t corner = corners_.corner(seats[0]);
      if ((own != FanCorners::none && own > corner) || corners_.has(face, corner)) return;
      const Cone cone(fan.from, triangles_[face]);
      fan.tree.each([&](const geometry::Box3d& box) { return ++boxes, !cone.is_far(box); },
                    [&](std::uint32_t seat) {
                      const std::uint32_t other = seats[seat].face;
                      if (corners_.of(other) == corner && corners_.shared(face, other) == FanCorners::none &&
                          near(triangles_[other].box()))
                        visit(face, other);
                    });
    });
    return boxes + near.boxes();
  }

 private:
  struct Fan {
    geometry::Vec3d from;
    std::vector<Arc> arcs;
    geometry::BoxTree<double> tree;  // over boxes around the arcs
  };

  std::span<const geometry::Triangle<T>> triangles_;
  const FanCorners& corners_;
  std::vector<Fan> fans_;
  geometry::BoxTree<T> roots_;  // over their faces
};

/// Deals the numbers below n out to threads; take(number, visitor) returns how many boxes it has looked at.
template <class Visitor, class Finish, class Take>
std::size_t deal_out(std::size_t n, int threads, const Visitor& visitor, const Finish& finish,
                     const Take& take) {
  std::mutex mutex;
  std::size_t boxes = 0;
  parallel_ranges(n, threads, [&](std::size_t begin, std::size_t end) {
    Visitor mine = visitor;
    std::size_t looked_at = 0;
    for (std::size_t i = begin; i < end; ++i) looked_at += take(i, mine);
    const std::lock_guard lock(mutex);
    boxes += looked_at;
    finish(mine);
  });
  return boxes;
}

/// Pairs of faces in no fan. The larger of two asks: its plane tells it more.
template <class T, class Visitor, class Finish>
std::size_t each_pair_in_no_fan(std::span<const geometry::Triangle<T>> triangles, const FanCorners& fans,
                                int threads, const Visitor& visitor, const Finish& finish) {
  std::vector<int> size(triangles.size());  // in powers of two
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < size.size(); ++i) {
    if (fans.of(i) != FanCorners::none) continue;
    const geometry::Vec<T, 3> sides = triangles[i].box().extent();
    size[i] = std::ilogb(sides[0] + sides[1] + sides[2]);
    order.push_back(i);
  }
  // A tree for each class of sizes: boxes of the largest are in the way of all others. The classes one by
  // one.
  constexpr int classes = 3;  // sizes in each: a factor of eight
  const auto class_of = [&](std::uint32_t i) { return size[i] / classes - (size[i] % classes < 0); };
  std::ranges::stable_sort(order, {}, class_of);
  std::size_t boxes = 0;
  std::vector<geometry::Box<T, 3>> of_class;
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    of_class.clear();
    for (; last < order.size() && class_of(order[last]) == class_of(order[first]); ++last)
      of_class.push_back(triangles[order[last]].box());
    const geometry::BoxTree<T> tree(of_class);
    const std::span asking = std::span(order).subspan(first);  // as large, or larger
    boxes += deal_out(asking.size(), threads, visitor, finish, [&](std::size_t k, Visitor& visit) {
      const std::uint32_t i = asking[k];
      NearFace<T> near(triangles[i]);
      tree.each(near, [&](std::uint32_t number) {
        const std::uint32_t j = asking[number];
        if (size[j] < size[i] || (size[j] == size[i] && j > i)) visit(i, j);  // else that one asks
      });
      return near.boxes();
    });
  }
  return boxes;
}

}  // namespace detail

/// Of triangles with area, the corners of which have equal numbers where they are at equal positions. Each
/// thread has copies of `visitor`, calls them as visitor(i, j), once for each pair, and in the end, one at a
/// time, finish(copy). Returns how many boxes it has looked at. Coordinates: floats, or doubles whose
/// products of three differences stay in range.
template <class T, class Visitor, class Finish>
std::size_t each_near_pair(const std::vector<geometry::Triangle<T>>& triangles,
                           const std::vector<std::array<std::uint32_t, 3>>& corners, int threads,
                           const Visitor& visitor, const Finish& finish) {
  const std::span<const geometry::Triangle<T>> all(triangles);
  const detail::FanCorners fan_corners(corners);
  std::size_t boxes = detail::each_pair_in_no_fan(all, fan_corners, threads, visitor, finish);
  if (fan_corners.size() == 0) return boxes;
  const detail::Fans<T> fans(all, fan_corners);
  for (std::size_t fan = 0; fan < fan_corners.size(); ++fan)
    boxes += detail::deal_out(
        fan_corners.faces(fan).size(), threads, visitor, finish,
        [&](std::size_t seat, Visitor& visit) { return fans.each_beside(fan, seat, visit); });
  boxes += detail::deal_out(all.size(), threads, visitor, finish, [&](std::size_t i, Visitor& visit) {
    return fans.each_near(static_cast<std::uint32_t>(i), visit);
  });
  return boxes;
}

}  // namespace treeline::accel
