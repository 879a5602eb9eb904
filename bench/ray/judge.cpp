#include "bench/ray/judge.hpp"

#include <array>
#include <numbers>

#include "geometry/distance.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::ray {
namespace {

using accel::Id;
using geometry::Rayd;
using geometry::Triangle3d;
using geometry::Vec3d;

constexpr int directions = 16;
constexpr double radii[] = {1.0, 0.5, 0.25};
constexpr double eps_factor = 32;

/// The ray moved sideways: itself, then parallels on circles of radius up to eps.
std::vector<Rayd> moved_rays(const Rayd& ray, double eps) {
  const Vec3d d = geometry::normalized(ray.direction);
  Vec3d axis{};
  axis[std::abs(d[0]) < 0.6 ? 0 : 1] = 1;
  const Vec3d x = geometry::normalized(geometry::cross(d, axis)), y = geometry::cross(d, x);
  std::vector<Rayd> rays{ray};
  for (const double radius : radii)
    for (int i = 0; i < directions; ++i) {
      const double angle = 2 * std::numbers::pi * i / directions;
      Rayd moved = ray;
      moved.origin += (x * std::cos(angle) + y * std::sin(angle)) * (radius * eps);
      rays.push_back(moved);
    }
  return rays;
}

/// Squared distance of two segments (Ericson 2005, section 5.1.9).
double segment_distance2(const Vec3d& a0, const Vec3d& a1, const Vec3d& b0, const Vec3d& b1) {
  const Vec3d a = a1 - a0, b = b1 - b0, gap = a0 - b0;
  const double aa = geometry::dot(a, a), bb = geometry::dot(b, b), ab = geometry::dot(a, b);
  const double ag = geometry::dot(a, gap), bg = geometry::dot(b, gap);
  const auto share = [](double x, double whole) { return whole > 0 ? std::clamp(x / whole, 0.0, 1.0) : 0.0; };
  double s = share(ab * bg - ag * bb, aa * bb - ab * ab);
  double u = bb > 0 ? (ab * s + bg) / bb : 0;
  if (u < 0)
    u = 0, s = share(-ag, aa);
  else if (u > 1)
    u = 1, s = share(ab - ag, aa);
  return geometry::distance2(a0 + a * s, b0 + b * u);
}

bool usable(const Rayd& r) {
  return geometry::is_finite(r.origin) && geometry::is_finite(r.direction) &&
         geometry::length2(r.direction) > 0 && !std::isnan(r.t_min) && !std::isnan(r.t_max);
}

}  // namespace

struct Judge::Case {
  const geometry::Rayf& given;
  Rayd ray;
  double eps, speed;  // speed: length of the direction
  std::vector<Rayd> moved;

  Case(const geometry::Rayf& r, double eps)
      : given(r),
        ray{Vec3d(r.origin), Vec3d(r.direction), double(r.t_min), double(r.t_max)},
        eps(eps),
        speed(geometry::length(ray.direction)) {}
  /// What t may be off by: eps as a length, and the rounding of t to float.
  double slack(double t) const {
    return eps / speed + geometry::tolerance::unit_roundoff<float> * (std::isfinite(t) ? std::abs(t) : 0);
  }
};

double Judge::largest_coordinate(const geometry::Mesh3f& mesh) {
  double largest = 0;
  for (const auto& face : mesh.faces)
    for (const auto vertex : face)
      for (int axis = 0; axis < 3; ++axis)
        if (const double x = std::abs(mesh.vertices[vertex][axis]); std::isfinite(x))
          largest = std::max(largest, x);
  return largest;
}

double Judge::eps(const geometry::Rayf& ray, std::span<const Id> faces) const {
  double largest = 0;
  const auto grow = [&](const geometry::Vec3f& point) {
    for (int axis = 0; axis < 3; ++axis)
      if (const double x = std::abs(point[axis]); std::isfinite(x)) largest = std::max(largest, x);
  };
  grow(ray.origin);
  for (const Id face : faces)
    if (face < mesh_.size())
      for (const auto vertex : mesh_.faces[face]) grow(mesh_.vertices[vertex]);
  return eps_factor * unit_roundoff_ * largest;
}

std::vector<Id> Judge::faces_near(const Rayd& ray, double distance) {
  if (!boxes_) boxes_.emplace(mesh_);
  return ray::faces_near(mesh_, *boxes_, ray, distance);
}

const std::vector<Id>& Judge::near(std::size_t ray_number, const Case& c) {
  Near& near = near_[ray_number];
  if (near.distance < 2 * c.eps) near = {2 * c.eps, faces_near(c.ray, 2 * c.eps)};
  return near.faces;
}

/// Grows eps by what the ray meets up to t = end, and moves the ray.
void Judge::widen(std::size_t ray_number, Case& c, double end) {
  std::vector<Id> met;
  Rayd ray = c.ray;
  ray.t_max = std::min(ray.t_max, end);
  for (const Id face : near(ray_number, c))
    if (exact_closest(mesh_, std::span(&face, 1), ray)) met.push_back(face);
  c.eps = std::max(c.eps, eps(c.given, met));
  c.moved = moved_rays(c.ray, c.eps);
}

/// Condition B: does some moved ray meet nothing in between?
bool Judge::passes(const Case& c, std::span<const Id> faces, double t_from, double t_to) const {
  if (!(t_from <= t_to)) return true;
  for (Rayd ray : c.moved) {
    ray.t_min = t_from, ray.t_max = t_to;
    if (!exact_closest(mesh_, faces, ray)) return true;
  }
  return false;
}

/// Is every face but the answered one that the ray meets in between missed by some moved ray, each face by a
/// ray of its own?
bool Judge::slips(const Case& c, std::span<const Id> faces, Id answered, double t_from, double t_to) const {
  for (const Id face : faces) {
    if (face == answered) continue;
    Rayd ray = c.ray;
    ray.t_min = t_from, ray.t_max = t_to;
    const std::span<const Id> alone(&face, 1);
    if (exact_closest(mesh_, alone, ray) && !passes(c, alone, t_from, t_to)) return false;
  }
  return true;
}

/// Condition A.
bool Judge::on_face(const Case& c, Id face, double t) const {
  if (face >= mesh_.size() || !geometry::is_finite(mesh_.triangle(face))) return false;
  if (!(t >= c.ray.t_min - c.slack(t) && t <= c.ray.t_max + c.slack(t))) return false;
  const double reach = c.slack(t) * c.speed;
  return geometry::closest_point_on_triangle(c.ray.at(t), Triangle3d(mesh_.triangle(face))).distance2 <=
         reach * reach;
}

/// Does the triangle, which the ray misses, come within eps of it? The nearest point is on an edge or at an
/// end.
bool Judge::touches(const Case& c, Id face) const {
  const Triangle3d t(mesh_.triangle(face));
  const double from = c.ray.t_min - c.slack(c.ray.t_min);
  double to = c.ray.t_max + c.slack(c.ray.t_max);
  if (!std::isfinite(to))  // past the triangle is far enough
    to = from + (geometry::distance(c.ray.at(from), t.a) + geometry::distance(t.a, t.b) +
                 geometry::distance(t.a, t.c)) /
                    c.speed;
  const Vec3d begin = c.ray.at(from), end = c.ray.at(to);
  const double eps2 = c.eps * c.eps;
  return geometry::closest_point_on_triangle(begin, t).distance2 <= eps2 ||
         geometry::closest_point_on_triangle(end, t).distance2 <= eps2 ||
         segment_distance2(begin, end, t.a, t.b) <= eps2 || segment_distance2(begin, end, t.b, t.c) <= eps2 ||
         segment_distance2(begin, end, t.c, t.a) <= eps2;
}

/// Is t as near to the triangle's plane as an approximate method comes, and the triangle near the ray?
bool Judge::on_plane(const Case& c, Id face, double t) const {
  if (face >= mesh_.size() || !geometry::is_finite(mesh_.triangle(face))) return false;
  const Triangle3d triangle(mesh_.triangle(face));
  const Vec3d n = triangle.area_normal();
  // The longest side over the least height is longest² / |n|, and it is at least one.
  const double longest2 =
      std::max({geometry::distance2(triangle.a, triangle.b), geometry::distance2(triangle.b, triangle.c),
                geometry::distance2(triangle.c, triangle.a)});
  if (!(std::abs(geometry::dot(n, c.ray.at(t) - triangle.a)) <= c.slack(t) * c.speed * longest2))
    return false;
  const std::span<const Id> alone(&face, 1);
  for (const Rayd& ray : c.moved)
    if (exact_closest(mesh_, alone, ray)) return true;
  return false;
}

Judged Judge::closest(std::size_t ray_number, const geometry::Rayf& ray, const TrueHit& truth,
                      const RayAnswer& answer) {
  Case c(ray, eps(ray, std::array{truth.primitive, answer.primitive}));
  const bool hit = static_cast<bool>(answer);
  if (!hit && !truth) return {};
  if (!usable(c.ray) || (hit && !std::isfinite(answer.t))) return {Verdict::false_hit, false, 1, 0};
  const double t = hit ? double(answer.t) : std::numeric_limits<double>::infinity();

  Judged judged;
  if (hit && truth) {
    // An absolute floor of s keeps hits at the origin of the ray from dividing by nothing.
    judged.signed_error = (t - truth.t) / std::max(truth.t, c.eps / c.speed);
    judged.error = std::min(1.0, std::abs(judged.signed_error));
    if (std::abs(t - truth.t) <= c.slack(truth.t)) {
      if (answer.primitive == truth.primitive || on_face(c, answer.primitive, t)) return judged;
      judged.verdict = Verdict::wrong_primitive;
      return judged;
    }
  }

  const double end = hit ? t : c.ray.t_max;
  widen(ray_number, c, end);
  const auto& faces = near(ray_number, c);
  const double from = c.ray.t_min + c.slack(c.ray.t_min), to = end - c.slack(end);
  if ((!hit || on_face(c, answer.primitive, t)) && passes(c, faces, from, to)) {
    judged.verdict = Verdict::borderline;
    // Another surface than the true one, or none: what is left to measure is how far off that surface the
    // answer is.
    if (!hit || !truth || answer.primitive != truth.primitive) {
      judged.signed_error = 0;
      judged.error = 0;
      if (hit) {
        const auto point = c.ray.at(t);
        const auto foot =
            geometry::closest_point_on_triangle(point, Triangle3d(mesh_.triangle(answer.primitive)));
        judged.error = std::min(
            1.0, std::sqrt(foot.distance2) / std::max(geometry::distance(point, c.ray.origin), c.eps));
      }
    }
    return judged;
  }
  const bool real = hit && on_plane(c, answer.primitive, t);
  if (hit && truth && answer.primitive == truth.primitive)
    judged.verdict = Verdict::wrong_t;
  else
    judged.verdict = hit && t < truth.t ? Verdict::false_hit : Verdict::false_miss;
  if (judged.verdict != Verdict::wrong_t) judged.error = 1, judged.signed_error = 0;
  judged.excused = (!hit || real) && slips(c, faces, answer.primitive, from, to);
  return judged;
}

Judged Judge::any(std::size_t ray_number, const geometry::Rayf& ray, const TrueHit& truth, bool answer) {
  if (answer == static_cast<bool>(truth)) return {};
  Case c(ray, eps(ray, std::span(&truth.primitive, 1)));
  if (!usable(c.ray)) return {Verdict::false_hit, false, 1, 0};
  if (!answer) {
    widen(ray_number, c, c.ray.t_max);
    const auto& faces = near(ray_number, c);
    const double from = c.ray.t_min + c.slack(c.ray.t_min), to = c.ray.t_max - c.slack(c.ray.t_max);
    if (passes(c, faces, from, to)) return {Verdict::borderline, false, 0, 0};
    return {Verdict::false_miss, slips(c, faces, accel::no_id, from, to), 1, 0};
  }
  // Which triangle it was is not told: any may have been, each with the eps that it would be involved with.
  const double widest = std::max(c.eps, eps_factor * unit_roundoff_ * largest_);
  for (const Id face : faces_near(c.ray, widest)) {
    c.eps = eps(ray, std::span(&face, 1));
    if (touches(c, face)) return {Verdict::borderline, false, 0, 0};
  }
  return {Verdict::false_hit, false, 1, 0};
}

std::string_view to_string(Verdict v) {
  switch (v) {
    case Verdict::right:
      return "right";
    case Verdict::borderline:
      return "borderline";
    case Verdict::false_hit:
      return "false hit";
    case Verdict::false_miss:
      return "false miss";
    case Verdict::wrong_t:
      return "wrong t";
    case Verdict::wrong_primitive:
      return "wrong primitive";
  }
  return "?";
}

}  // namespace treeline::bench::ray
