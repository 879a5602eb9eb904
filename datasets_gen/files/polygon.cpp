#include "datasets_gen/files/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "geometry/exact/orientation.hpp"

namespace treeline::datasets::files {
namespace {

using geometry::Vec2d;
using geometry::Vec3d;

bool is_in_line(std::span<const geometry::Vec3f> corners) {
  const Vec3d origin(corners[0]);
  Vec3d along{};
  for (const auto& p : corners) {
    const Vec3d to = Vec3d(p) - origin;
    if (along == Vec3d{}) along = to;
    if (cross(along, to) != Vec3d{}) return false;
  }
  return true;
}

/// Whether an outline of positive area may be one that does not meet itself: walking around it one turns
/// around once. Where it turns back on itself nobody says to which side; one that does is given either.
bool may_turn_once(std::span<const Vec2d> points) {
  std::vector<Vec2d> sides;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const Vec2d s = points[(i + 1) % points.size()] - points[i]; s != Vec2d{}) sides.push_back(s);
  double angle = 0, back = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Vec2d &p = sides[i], &q = sides[(i + 1) % sides.size()];
    const double turn = p[0] * q[1] - p[1] * q[0], along = dot(p, q);
    if (turn == 0 && along < 0)
      ++back;
    else
      angle += std::atan2(turn, along);
  }
  constexpr double pi = std::numbers::pi;
  return std::abs(angle - 2 * pi) < (back + 0.5) * pi;
}

/// A polygon in the plane that turns counter-clockwise, whose ears are cut off one by one.
class Ears {
 public:
  explicit Ears(std::vector<Vec2d> points) : points_(std::move(points)), left_(points_.size()) {
    std::iota(left_.begin(), left_.end(), std::size_t{0});
  }
  std::optional<Filling> cut() {
    Filling r;
    for (std::size_t at = 0, tried = 0; left_.size() > 3;) {
      if (tried == 2 * left_.size()) return std::nullopt;
      at %= left_.size();
      // Corners in line are cut off where nothing else can be: triangles of no area keep the mesh closed.
      if (is_ear(at, tried >= left_.size())) {
        r.push_back({before(at), left_[at], after(at)});
        left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
        tried = 0;
      } else {
        ++at, ++tried;
      }
    }
    if (turn(left_[0], left_[1], left_[2]) < 0) return std::nullopt;
    r.push_back({left_[0], left_[1], left_[2]});
    return r;
  }

 private:
  std::size_t before(std::size_t at) const { return left_[(at + left_.size() - 1) % left_.size()]; }
  std::size_t after(std::size_t at) const { return left_[(at + 1) % left_.size()]; }
  int turn(std::size_t a, std::size_t b, std::size_t c) const {
    return geometry::orientation(points_[a], points_[b], points_[c]);
  }
  bool is_ear(std::size_t at, bool in_line) const {
    const std::size_t a = before(at), b = left_[at], c = after(at);
    const int turns = turn(a, b, c);
    if (in_line && turns == 0) return true;
    if (turns <= 0) return false;
    return std::ranges::none_of(left_, [&](std::size_t p) {
      if (points_[p] == points_[a] || points_[p] == points_[b] || points_[p] == points_[c]) return false;
      return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
    });
  }

  std::vector<Vec2d> points_;
  std::vector<std::size_t> left_;
};

}  // namespace

Filling fan(std::size_t corners) {
  Filling r;
  for (std::size_t k = 2; k < corners; ++k) r.push_back({0, k - 1, k});
  return r;
}

std::optional<Filling> fill_polygon(std::span<const geometry::Vec3f> corners) {
  const std::size_t n = corners.size();
  if (n < 4) return fan(n);
  Vec3d normal{};
  for (std::size_t i = 0; i < n; ++i) {
    if (!geometry::is_finite(corners[i])) return fan(n);
    const Vec3d origin(corners[0]);
    normal += cross(Vec3d(corners[i]) - origin, Vec3d(corners[(i + 1) % n]) - origin);
  }
  const int axis = largest_axis(normal);
  if (normal[axis] == 0) {
    if (is_in_line(corners)) return fan(n);
    return std::nullopt;
  }
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<Vec2d> flat;
  for (const auto& p : corners)
    flat.push_back(normal[axis] > 0 ? Vec2d{double(p[u]), double(p[v])} : Vec2d{double(p[v]), double(p[u])});
  if (!may_turn_once(flat)) return std::nullopt;
  // A fan fills what lies around its first corner in order: each of its triangles then looks the same way.
  const auto turn = [&](std::size_t a, std::size_t b, std::size_t c) {
    return geometry::orientation(flat[a], flat[b], flat[c]);
  };
  bool by_fan = true;
  double angle = 0;
  for (std::size_t k = 2; k < n; ++k) {
    by_fan = by_fan && turn(0, k - 1, k) >= 0;
    const Vec2d p = flat[k - 1] - flat[0], q = flat[k] - flat[0];
    angle += std::atan2(p[0] * q[1] - p[1] * q[0], dot(p, q));
  }
  if (by_fan && angle < 6) return fan(n);  // less than all around: no second layer
  if (n > most_concave_corners) return std::nullopt;
  return Ears(std::move(flat)).cut();
}

}  // namespace treeline::datasets::files
