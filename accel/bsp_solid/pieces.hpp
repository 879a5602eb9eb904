// Convex polygons in an arena of corners, and cutting them by planes.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "accel/bsp_solid/exact_space.hpp"

namespace treeline::accel::solid {

struct Piece {
  PlaneId plane;
  Id face;                             // its number in the source
  std::uint32_t first;                 // corners[first], … first + count - 1, in order
  std::uint32_t count : 31, flip : 1;  // flip: faces against the plane's normal
};

template <class Space>
class Pieces {
 public:
  using Corner = typename Space::Corner;

  explicit Pieces(const SolidGrid& grid) : space(grid) {}

  Space space;
  std::vector<Corner> corners;

  std::span<Corner> of(const Piece& p) { return {corners.data() + p.first, p.count}; }
  std::span<const Corner> of(const Piece& p) const { return {corners.data() + p.first, p.count}; }

  enum class Side { on, front, back, both };
  /// A piece is on its own plane whatever its corners say, and so is never cut by it.
  Side side(PlaneId plane, const Piece& p) {
    if (p.plane == plane) return Side::on;
    bool front = false, back = false;
    sides_.clear();
    for (const Corner& c : of(p)) {
      const int s = space.side(plane, c);
      sides_.push_back(static_cast<signed char>(s));
      front = front || s > 0, back = back || s < 0;
    }
    return front ? (back ? Side::both : Side::front) : back ? Side::back : Side::on;
  }

  /// The two parts of a piece that side() has just found on both sides: in front and behind.
  std::pair<Piece, Piece> cut(PlaneId plane, const Piece& p) {
    for (auto& part : part_) part.clear();
    for (std::uint32_t i = 0, n = p.count; i < n; ++i) {
      const std::uint32_t next = i + 1 < n ? i + 1 : 0;
      const int s = sides_[i], t = sides_[next];
      Corner &from = corners[p.first + i], &to = corners[p.first + next];
      if (s == 0) {
        // The edge that leaves goes to one side; along the plane on the other.
        part_[0].push_back(t > 0 ? from : turned(from, plane));
        part_[1].push_back(t < 0 ? from : turned(from, plane));
        continue;
      }
      auto &own = part_[s > 0 ? 0 : 1], &other = part_[s > 0 ? 1 : 0];
      const bool crosses = t != 0 && (t > 0) != (s > 0);
      if (!crosses) {
        own.push_back(from);
        continue;
      }
      const Corner middle = space.cut(p.plane, from, to, plane);
      own.push_back(from), own.push_back(turned(middle, plane));
      other.push_back(middle);
    }
    return {put(p, part_[0]), put(p, part_[1])};
  }

  /// Whether a piece that the plane has cut, of which `part` is left on one side, runs through the inside of
  /// one that lies in the plane. Both are convex: if not, a line parts what they have in the plane, an edge
  /// of the one there or the other's plane.
  bool run_through(PlaneId plane, const Piece& part, const Piece& there) {
    std::array<Corner, 2> ends;
    std::size_t found = 0;
    for (const Corner& c : of(part))
      if (found < 2 && space.side(plane, c) == 0) ends[found++] = c;
    if (found < 2) return false;
    constexpr double far = 1;  // in steps: corners are rounded by far less
    for (int k = 0; k < 3; ++k) {
      const double low = std::min(double(ends[0].at[k]), double(ends[1].at[k])),
                   high = std::max(double(ends[0].at[k]), double(ends[1].at[k]));
      bool before = true, beyond = true;
      for (const Corner& c : of(there))
        before = before && double(c.at[k]) < low - far, beyond = beyond && double(c.at[k]) > high + far;
      if (before || beyond) return false;
    }
    bool front = false, back = false;
    for (const Corner& c : of(there)) {
      const int s = space.side(part.plane, c);
      front = front || s > 0, back = back || s < 0;
    }
    if (!front || !back) return false;
    for (std::uint32_t i = 0; i < there.count; ++i) {
      Corner& from = corners[there.first + i];
      const PlaneId edge =
          space.edge(there.plane, from, corners[there.first + (i + 1 < there.count ? i + 1 : 0)]);
      int inward = 0;
      for (const Corner& c : of(there))
        if (inward = space.side(edge, c); inward != 0) break;
      if (space.side(edge, ends[0]) * inward <= 0 && space.side(edge, ends[1]) * inward <= 0) return false;
    }
    return true;
  }

 private:
  static Corner turned(Corner c, PlaneId edge) {
    if constexpr (Space::is_exact) c.edge = edge, c.twin = no_plane;
    return c;
  }
  Piece put(Piece p, const std::vector<Corner>& part) {
    p.first = static_cast<std::uint32_t>(corners.size());
    p.count = static_cast<std::uint32_t>(part.size()) & 0x7fffffffu;
    corners.insert(corners.end(), part.begin(), part.end());
    return p;
  }

  std::vector<signed char> sides_;
  std::vector<Corner> part_[2];
};

}  // namespace treeline::accel::solid
