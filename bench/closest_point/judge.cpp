#include "bench/closest_point/judge.hpp"

#include <algorithm>

#include "bench/closest_point/queries.hpp"
#include "geometry/exact/triangle_distance.hpp"

namespace treeline::bench::closest_point {
namespace {

using geometry::Triangle3d;
using geometry::Vec3d;

/// Bounded methods: what rounding makes of a closest point, relative to the largest coordinate involved.
constexpr double bounded_slack = 64;
/// Exact methods find the nearest triangle; the point on it may be rounded to float.
constexpr double exact_slack = 4;
/// Approximate methods promise nothing, but an answer farther off than this, over the diagonal, is no
/// approximation.
constexpr double no_approximation = 1e-2;
constexpr double much = 1e-6;  // over the diagonal

double largest(const Vec3d& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }
double largest(const Triangle3d& t) { return std::max({largest(t.a), largest(t.b), largest(t.c)}); }

using Float = std::numeric_limits<float>;

/// Half the distance of neighbouring numbers of a method at a coordinate: of float's it stops to shrink.
double rounding(double at, const Promise& promise) {
  return std::max(promise.roundoff * at, promise.in_float ? double(Float::denorm_min()) / 2 : 0.0);
}
/// Whether a squared distance is that of `distance` but for the slack, or for leaving the range of float.
bool is_square(double distance2, double distance, double slack, bool in_float) {
  if (std::abs(std::sqrt(distance2) - distance) <= slack) return true;
  const double true2 = distance * distance;
  return in_float && (std::abs(distance2 - true2) <= 4 * double(Float::denorm_min()) ||
                      (true2 > double(Float::max()) && distance2 > double(Float::max())));
}

}  // namespace

Judge::Judge(const geometry::Mesh3f& mesh) : mesh_(mesh) {
  const geometry::Box3d box = box_of(mesh);
  if (!(box.low[0] <= box.high[0])) return;
  const double reach = std::max(largest(box.low), largest(box.high));
  diagonal_ = geometry::length(box.extent());
  if (!(diagonal_ > 0)) diagonal_ = reach > 0 ? reach : 1;
  floor_ = geometry::tolerance::unit_roundoff<float> * std::max(1.0, reach / diagonal_);
}

Judged Judge::operator()(const geometry::Vec3f& query, const TrueClosest& truth, const Answer& answer,
                         const Promise& promise) const {
  Judged judged;
  const auto failed = [&](Verdict verdict) {
    judged.verdict = verdict, judged.error = 1;
    return judged;
  };
  if (!truth) {
    // Every distance to a query at infinity is infinite, and to say so is no mistake.
    const bool none = !answer || (!std::isnan(answer.distance2) && !std::isfinite(answer.distance2));
    return none ? judged : failed(Verdict::surplus);
  }
  if (!answer || !geometry::is_finite(answer.point)) return failed(Verdict::missing);
  const Vec3d q(query);
  const double distance = std::sqrt(truth.distance2);
  const Triangle3d nearest(mesh_.triangle(truth.primitive));
  // How far it is does not depend on what a method names instead of the nearest.
  const double reach = std::max(largest(q), largest(nearest));
  double reach_of_named = reach, too_far = 0;  // the triangle named, than the nearest
  if (promise.names_triangles) {
    if (answer.primitive >= mesh_.size() || !geometry::is_finite(mesh_.triangle(answer.primitive)))
      return failed(Verdict::no_triangle);
    const Triangle3d named(mesh_.triangle(answer.primitive));
    reach_of_named = std::max(reach, largest(named));
    // Exactly: of slivers even double does not tell whether a point is on them.
    judged.off_triangle = std::sqrt(geometry::exact_distance2(answer.point, named)) / diagonal_;
    if (answer.primitive != truth.primitive) {
      const double distance2 = geometry::exact_distance2(q, named);
      judged.farther = distance2 > truth.distance2;
      too_far = std::sqrt(distance2) - distance;
      judged.much_farther = too_far > much * diagonal_;
    }
  }
  judged.signed_error = (geometry::length(q - answer.point) - distance) / diagonal_;
  judged.error = std::max(std::abs(judged.signed_error), judged.off_triangle);
  if (distance > 0)
    judged.relative = std::min(1.0, std::abs(std::sqrt(answer.distance2) - distance) / distance);
  if (std::isnan(judged.relative)) judged.relative = 1;

  if (promise.claim == Claim::approximate || promise.claim == Claim::stochastic) {
    const double limit =
        std::max(no_approximation, bounded_slack * rounding(reach_of_named, promise) / diagonal_);
    if (!promise.names_triangles) return judged;
    if (!(judged.error <= limit))
      judged.verdict = judged.off_triangle > limit ? Verdict::off_triangle : Verdict::wrong_distance;
    else if (!is_square(answer.distance2, distance, limit * diagonal_, promise.in_float))
      judged.verdict = Verdict::wrong_distance;
    return judged;
  }
  if (promise.claim == Claim::exact && judged.farther)
    judged.verdict = Verdict::farther_triangle;
  else if (promise.claim == Claim::exact && answer.distance2 != truth.distance2)
    judged.verdict = Verdict::wrong_distance;
  const double roundings = promise.claim == Claim::exact ? exact_slack : bounded_slack;
  const double slack = roundings * rounding(reach, promise);
  // A point may lie as far off a triangle as that one's coordinates excuse: not so its distance.
  if (promise.claim == Claim::bounded && too_far > slack) judged.verdict = Verdict::farther_triangle;
  if (promise.claim == Claim::bounded && !is_square(answer.distance2, distance, slack, promise.in_float))
    judged.verdict = Verdict::wrong_distance;
  if (!(std::abs(judged.signed_error) * diagonal_ <= slack)) judged.verdict = Verdict::wrong_distance;
  if (!(judged.off_triangle * diagonal_ <= roundings * rounding(reach_of_named, promise)))
    judged.verdict = Verdict::off_triangle;
  return judged;
}

std::string_view to_string(Verdict v) {
  switch (v) {
    case Verdict::right:
      return "right";
    case Verdict::missing:
      return "no answer";
    case Verdict::surplus:
      return "an answer where there is none";
    case Verdict::no_triangle:
      return "no such triangle";
    case Verdict::wrong_distance:
      return "wrong distance";
    case Verdict::off_triangle:
      return "point off its triangle";
    case Verdict::farther_triangle:
      return "a farther triangle";
  }
  return "?";
}

}  // namespace treeline::bench::closest_point
