// Sphere tracing: where a ray meets the surface of a distance field, by steps that the field says are free.
//
// Method (Hart 1996): the field's certain clearance at a point is a ball without surface, and the ray goes on
// to its border. Over-relaxation (Keinert et al. 2014): it goes farther by a factor, and comes back where the
// two balls leave a gap. Where the surface may be within the field's error, steps follow the field itself,
// divided by how steep it gets, so that they cannot pass through what the field calls inside; a ray that
// passes without meeting it has come near a surface that the field may have lost (`doubtful`), which is a hit
// if that is wanted. Cost: steps grow with the square root of 1 / clearance for a grazed sphere and with 1 /
// angle over a plane. Known weakness: a cap on steps is a wrong answer unless its status is read.
#pragma once

#include <algorithm>
#include <cmath>
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
  double tolerance =
      1e-5;  ///< nearer than this, by the field's distance, is a hit; in units of the field, > 0
  bool stop_at_doubt = false;  ///< a surface that may be there is a hit: misses nothing, hits too much
};

struct Trace {
  TraceStatus status = TraceStatus::miss;
  double t = 0;   ///< of the hit, or how far the ray got, free of the surface; in lengths of its direction
  int steps = 0;  ///< samples of the field that were taken
  /// Hit: the field does not come to zero here, its error may. Else: the ray passed a surface by less than
  /// the error.
  bool doubtful = false;
};

/// The first meeting in [t_min, t_max], from outside or from inside. Throws InvalidInput for a ray or options
/// that are none, and for an endless ray where the field has no bounds().
template <DistanceField Field>
Trace sphere_trace(const Field& field, const geometry::Rayd& ray, const TraceOptions& options = {});

namespace detail {

inline void check(const TraceOptions& o) {
  if (o.max_steps < 1)
    throw InvalidInput("max_steps is " + std::to_string(o.max_steps) + "; it must be at least 1");
  if (!(o.relaxation >= 1 && o.relaxation < 2))
    throw InvalidInput("relaxation is " + std::to_string(o.relaxation) + "; it must be in [1, 2)");
  if (!(o.tolerance > 0) || std::isinf(o.tolerance))
    throw InvalidInput("tolerance is " + std::to_string(o.tolerance) + "; it must be positive and finite");
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
    if (!std::isfinite(ray.t_max))
      throw InvalidInput("the ray's t_max is not finite, and the field has no bounds");
    return {ray.t_min, ray.t_max};
  }
}

}  // namespace detail

template <DistanceField Field>
Trace sphere_trace(const Field& field, const geometry::Rayd& ray, const TraceOptions& options) {
  detail::check(options);
  check_ray(ray);
  const auto [begin, end] = detail::reach_of(field, ray);
  const double speed = length(ray.direction), steepness = field.lipschitz();
  Trace trace;
  trace.t = std::isfinite(ray.t_max) ? ray.t_max : end;
  if (!(begin <= end)) return trace;

  double side = 0;                          // of the start: 1 outside
  double last = 0, step = 0, free = begin;  // the ball before, the step from there, and that ball's border
  double relaxation = options.relaxation;
  bool near = false;  // the last step followed the field
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
    near = clearance <= options.tolerance;
    if (height <= (near ? options.tolerance : 0) || (near && options.stop_at_doubt)) {
      trace.status = TraceStatus::hit, trace.doubtful = height > options.tolerance;
      return trace;
    }
    trace.doubtful |= near;
    last = near ? height / steepness : clearance;
    step = near ? last : clearance * relaxation;
    relaxation = options.relaxation;
    free = trace.t + last / speed;
    if (free >= end || trace.t >= end) {
      trace.t = std::isfinite(ray.t_max) ? ray.t_max : end;
      return trace;
    }
    double next = trace.t + step / speed;
    if (next > end) next = end, step = (end - trace.t) * speed;
    if (!(next > trace.t)) break;  // the step is lost in rounding
    trace.t = next;
  }
  trace.status = TraceStatus::exhausted;
  return trace;
}

}  // namespace treeline::accel::field
