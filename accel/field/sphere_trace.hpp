// Sphere tracing: where a ray meets the surface of a distance field, by steps that the field says are free.
//
// Method (Hart 1996): the field's certain clearance at a point is a ball without surface, and the ray goes on
// to its border. Over-relaxation (Keinert et al. 2014): it goes farther by a factor, and comes back where the
// two balls leave a gap. Where the surface may be within the field's error, steps follow the field itself,
// divided by how steep it gets, so that they cannot pass through what the field calls inside; a ray that
// passes without meeting it has come near a surface that the field may have lost (`doubtful`, whether it
// meets another one behind or none), which is a hit if that is wanted. Cost: steps grow with the square root
// of 1 / clearance for a grazed sphere and with 1 / angle over a plane. Known weakness: a cap on steps is a
// wrong answer unless its status is read.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "accel/field/concepts.hpp"
#include "accel/ray_checks.hpp"
#include "geometry/box.hpp"
#include "geometry/ray.hpp"

namespace treeline::accel::field {

enum class TraceStatus {
  hit,
  miss,
  exhausted  ///< the steps allowed were not enough: neither
};

struct TraceOptions {
  int max_steps = 512;
  double relaxation = 1.6;  ///< factor of steps, in [1, 2); 1 is plain sphere tracing
  /// Nearer than this, by the field's distance, is a hit; in units of the field, > 0. None: 1e-5 of the
  /// longest side of the field's bounds(), and 1e-5 where it has no bounds.
  std::optional<double> tolerance;
  bool stop_at_doubt = false;  ///< a surface that may be there is a hit: misses nothing, hits too much
};

struct Trace {
  TraceStatus status = TraceStatus::miss;
  double t = 0;   ///< of the hit, or how far the ray got, free of the surface; in lengths of its direction
  int steps = 0;  ///< samples of the field that were taken
  /// The ray passed a surface by less than the error, or may have passed through one that the field has lost.
  /// Of a hit, also: the field does not come to zero here, its error may.
  bool doubtful = false;
};

/// The first meeting in [t_min, t_max], from outside or from inside; the direction may be of any length.
/// Throws InvalidInput for a ray or options that are none; for a ray without beginning or end where the field
/// has no bounds(); for one whose origin or start lies beyond 2^500, where squared distances overflow; and
/// where the t of a hit does.
template <DistanceField Field>
Trace sphere_trace(const Field& field, const geometry::Rayd& given, const TraceOptions& options = {});

namespace detail {

inline void check(const TraceOptions& o) {
  if (o.max_steps < 1)
    throw InvalidInput("max_steps is " + std::to_string(o.max_steps) + "; it must be at least 1");
  if (!(o.relaxation >= 1 && o.relaxation < 2))
    throw InvalidInput("relaxation is " + std::to_string(o.relaxation) + "; it must be in [1, 2)");
  if (o.tolerance && (!(*o.tolerance > 0) || std::isinf(*o.tolerance)))
    throw InvalidInput("tolerance is " + std::to_string(*o.tolerance) + "; it must be positive and finite");
}

/// The tolerance given, or that of the field's size.
template <class Field>
double tolerance_of(const Field& field, const TraceOptions& o) {
  constexpr double share = 1e-5;
  if (o.tolerance) return *o.tolerance;
  if constexpr (requires { field.bounds(); }) {
    const Vec3d sides = field.bounds().extent();
    if (const double longest = std::max({sides[0], sides[1], sides[2]}); longest > 0) return share * longest;
  }
  return share;
}

/// The ray with its direction's largest component in [1, 2), so that no square of it overflows or vanishes;
/// its t are those of the given one times 2^exponent.
struct ScaledRay {
  explicit ScaledRay(const geometry::Rayd& given) : ray(given) {
    double largest = 0;
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(given.direction[k]));
    exponent = std::ilogb(largest);
    for (int k = 0; k < 3; ++k) ray.direction[k] = std::scalbn(given.direction[k], -exponent);
    ray.t_min = std::scalbn(given.t_min, exponent), ray.t_max = std::scalbn(given.t_max, exponent);
  }
  double given_t(double t) const { return std::scalbn(t, -exponent); }

  geometry::Rayd ray;
  int exponent;
};

inline void check_near(const Vec3d& p, const char* what) {
  for (int k = 0; k < 3; ++k)
    if (!(std::abs(p[k]) <= 0x1p500))
      throw InvalidInput(std::string("the ray's ") + what +
                         " has a coordinate beyond 2^500, where squared distances overflow");
}

struct Reach {
  double begin, end;  // begin > end: none
};
/// Where on the ray the box is.
inline Reach within(const geometry::Rayd& ray, const geometry::Box3d& box) {
  Reach r{ray.t_min, ray.t_max};
  for (int k = 0; k < 3; ++k) {
    if (ray.direction[k] == 0) {
      if (ray.origin[k] < box.low[k] || ray.origin[k] > box.high[k]) return {1, 0};
      continue;
    }
    const double a = (box.low[k] - ray.origin[k]) / ray.direction[k];
    const double b = (box.high[k] - ray.origin[k]) / ray.direction[k];
    r.begin = std::max(r.begin, std::min(a, b)), r.end = std::min(r.end, std::max(a, b));
  }
  return r;
}
/// Where on the ray the surface can be.
template <class Field>
Reach reach_of(const Field& field, const geometry::Rayd& ray) {
  if constexpr (requires { field.bounds(); }) {
    geometry::Box3d box = field.bounds();
    double reach = 0;  // rounding could miss a ray along a side
    for (int k = 0; k < 3; ++k)
      reach = std::max({reach, std::abs(box.low[k]), std::abs(box.high[k]), std::abs(ray.origin[k])});
    const Vec3d slack = Vec3d::filled(reach * 0x1p-40);
    return within(ray, {box.low - slack, box.high + slack});
  } else {
    if (!std::isfinite(ray.t_min) || !std::isfinite(ray.t_max))
      throw InvalidInput(std::string("the ray's ") + (std::isfinite(ray.t_min) ? "t_max" : "t_min") +
                         ", times its direction, is not finite, and the field has no bounds");
    return {ray.t_min, ray.t_max};
  }
}

}  // namespace detail

template <DistanceField Field>
Trace sphere_trace(const Field& field, const geometry::Rayd& given, const TraceOptions& options) {
  detail::check(options);
  check_ray(given);
  detail::check_near(given.origin, "origin");
  const detail::ScaledRay scaled(given);
  const geometry::Rayd& ray = scaled.ray;
  const auto [begin, end] = detail::reach_of(field, ray);
  const double speed = length(ray.direction), steepness = field.lipschitz(),
               tolerance = detail::tolerance_of(field, options);
  const double last_t = std::isfinite(given.t_max) ? given.t_max : scaled.given_t(end);
  Trace trace;
  trace.t = last_t;
  if (!(begin <= end)) return trace;
  detail::check_near(ray.at(begin), "start");

  double side = 0;                          // of the start: 1 outside
  double last = 0, step = 0, free = begin;  // the ball before, the step from there, and that ball's border
  double relaxation = options.relaxation;
  bool near = false;    // the last step followed the field
  bool passed = false;  // it came near, and went away again
  for (trace.t = begin; trace.steps < options.max_steps;) {
    const FieldSample s = field.sample(ray.at(trace.t));
    ++trace.steps;
    if (side == 0) side = s.distance < 0 ? -1 : 1;
    const double clearance = s.clearance(), height = side * s.distance;
    // A gap between two balls, or the surface where they touch: back to the border of the first.
    if (!near && step > last && (last + clearance < step || height < 0)) {
      trace.t = free, step = last, relaxation = 1;
      continue;
    }
    passed |= near && clearance > tolerance;
    near = clearance <= tolerance;
    if (height <= (near ? tolerance : 0) || (near && options.stop_at_doubt)) {
      trace.status = TraceStatus::hit, trace.doubtful = passed || height > tolerance;
      trace.t = scaled.given_t(trace.t);
      if (!std::isfinite(trace.t))
        throw InvalidInput("the ray's direction is so short that the t of its hit is not finite");
      return trace;
    }
    trace.doubtful |= near;
    last = near ? height / steepness : clearance;
    step = near ? last : clearance * relaxation;
    relaxation = options.relaxation;
    free = trace.t + last / speed;
    if (free >= end || trace.t >= end) {
      trace.t = last_t;
      return trace;
    }
    double next = trace.t + step / speed;
    if (next > end) next = end, step = (end - trace.t) * speed;
    if (!(next > trace.t)) break;  // the step is lost in rounding
    trace.t = next;
  }
  trace.status = TraceStatus::exhausted, trace.t = scaled.given_t(trace.t);
  return trace;
}

}  // namespace treeline::accel::field
