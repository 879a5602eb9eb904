// Soft shadows from a distance field: a cone of the light's width, marched, is as open as the nearest thing
// beside its axis leaves it.
//
// With d the distance to the scene at t along the way to the light's middle, and tan a the light's radius
// over its distance, x = d / (t tan a) is how far off the axis the nearest thing is, in radii of the cone.
// Forms: min(x, 1) (Quilez 2010: one-sided; what shadows have is only their outer half, and a half-plane is
// off by 0.29, darker by 0.25 on average); the same with the cone's radius kept within limits, darkened as
// steps run out (Unreal Engine 4, 2014); two-sided (Quilez 2017: on to x = -1, inside of things, then
// (1 + x)² (2 - x) / 4: off by 0.028); and a disc's segment in place of that polynomial: exact for a straight
// edge. Aaltonen's step (2018) takes the nearest thing to be where the balls of two steps meet, between them:
// too dark by some 0.05 beside balls; where the second ball holds the first, as over a flat floor, they do
// not meet, and it must not be used (guard). Cost: some ten to sixty look-ups, whatever the light's size.
// Known weakness: one number stands for all that is beside the cone, so that two blockers count as the nearer
// one (a slit of a quarter of the radius to either side: 0.66 for 0.32). A surface hides itself where the
// light is so low that sin < tan a of its height over it, or, by the field's error, near the start. The
// inside of a sheet thinner than a cell is in no sample: distances above it never come to zero, and it hides
// nothing. An open sheet has no inside at all, and what it hides is up to the lattice: samples of a brick
// (8³) that hang together get the side that the nearest face gives the one farthest off (field/build.hpp).
// Between two sheets that look the same way, a floor and a roof, that may be the floor's outer side or the
// roof's inner one. If a brick takes the roof's, distances change sign at the roof, and it hides the light;
// if it takes the floor's, they are positive on both sides of the roof and come down to its distance from the
// samples, up to half a cell: with that more than the cone's radius there, it hides nothing. A finer lattice
// moves the bricks, so that the error does not fall with the cell.
#pragma once

#include <optional>

#include "accel/distance_field.hpp"
#include "shading/shadow/closed_forms.hpp"
#include "shading/shadow/light_samples.hpp"
#include "shading/shadow/method.hpp"

namespace treeline::shading::shadow {

enum class FieldShadowForm { one_sided, clamped, two_sided, disc };
enum class NearestThing {
  at_samples,  ///< the least x of those seen
  between      ///< Aaltonen's
};

struct FieldShadowOptions {
  FieldShadowForm form = FieldShadowForm::disc;
  NearestThing nearest = NearestThing::at_samples;
  bool guard = true;  ///< of Aaltonen's step
  int max_steps = 128;
  /// All in units of the field. The march starts `offset` along the receiver's normal, `start` on.
  double offset = 0, start = 1e-3;
  double tolerance = 1e-4;  ///< nearer than this is a hit for the one-sided forms and for lights of no size
  double min_step = 1e-4;
  double cone_step = 0.25;                       ///< the least step too, in radii of the cone
  double min_radius = 0, max_radius = INFINITY;  ///< of the cone, for the clamped form
  double max_distance = INFINITY;                ///< nothing farther hides the sun
};

struct FieldShadow {
  float visibility = 1;
  int steps = 0;           ///< samples of the field
  bool exhausted = false;  ///< max_steps were not enough
};

template <accel::field::DistanceField Field>
class DistanceFieldShadow {
 public:
  /// The field must outlive this. An area light is taken for a disc of its area that faces the receiver. The
  /// light's kind and place are all that is taken from the scene. Throws InvalidScene for a light or options
  /// that are none, and for a sun where neither samples nor max_distance end the way.
  DistanceFieldShadow(const Field& field, const Light& light, const FieldShadowOptions& options = {})
      : field_(&field), shape_(light), options_(options) {
    detail::check_knob("max_steps", options.max_steps, 1, 1 << 20);
    for (const auto& [name, value] : {std::pair{"start", options.start},
                                      {"tolerance", options.tolerance},
                                      {"min_step", options.min_step}})
      if (!(value > 0) || std::isinf(value))
        throw InvalidScene(std::string(name) + " is " + std::to_string(value) +
                           "; it must be positive and finite");
    detail::check_knob("cone_step", options.cone_step, 0, 4);
    if (!std::isfinite(options.offset) || !(options.min_radius >= 0) ||
        !(options.max_radius >= options.min_radius) || !(options.max_distance > 0))
      throw InvalidScene("the offset is not finite, the cone's radii are no interval, or max_distance is 0");
    if (!is_sampled && shape_.directional() && std::isinf(options.max_distance))
      throw InvalidScene("the way to the sun has no end: neither samples nor max_distance");
    if (light.kind == LightKind::directional)
      radius_ = std::tan(light.angle);
    else if (light.kind == LightKind::disc)
      radius_ = std::sqrt(length(cross(light.u, light.v)));
    else if (light.kind == LightKind::rectangle)
      radius_ = std::sqrt(4 / std::numbers::pi * length(cross(light.u, light.v)));
  }

  float visibility(const Receiver& receiver) const { return trace(receiver).visibility; }
  FieldShadow trace(const Receiver& receiver) const;
  std::size_t bytes() const {
    if constexpr (requires { field_->samples().bytes(); })
      return field_->samples().bytes();
    else
      return sizeof(Field);
  }

 private:
  /// Whether the way ends with what the samples cover. A formula's bounds end at its surface: what passes
  /// beside it is in half shadow.
  static constexpr bool is_sampled = requires(const Field& f) { f.samples().lattice(), f.bounds(); };

  double end_of(const Vec3d& from, const Vec3d& way, double distance) const {
    double end = shape_.directional() ? options_.max_distance : distance;
    if constexpr (is_sampled)
      end = std::min(end, accel::field::detail::within({from, way, 0, INFINITY}, field_->bounds()).end);
    return end;
  }
  float open(double x) const {
    x = std::clamp(x, -1.0, 1.0);
    switch (options_.form) {
      case FieldShadowForm::two_sided:
        return static_cast<float>(0.25 * (1 + x) * (1 + x) * (2 - x));
      case FieldShadowForm::disc:
        return static_cast<float>(disc_over_edge(x));
      default:
        return static_cast<float>(std::max(0.0, x));
    }
  }

  const Field* field_;
  LightShape shape_;
  FieldShadowOptions options_;
  double radius_ = 0;  // of the light; of the sun's disc at distance 1
};

template <accel::field::DistanceField Field>
FieldShadow DistanceFieldShadow<Field>::trace(const Receiver& receiver) const {
  const FieldShadowOptions& o = options_;
  const Vec3d from = receiver.position + receiver.normal * o.offset, towards = shape_.towards(from);
  const double distance = length(towards);
  FieldShadow result;
  if (!(distance > 0)) return result;
  const Vec3d way = towards / distance;
  const double slope = shape_.directional() ? radius_ : radius_ / distance, end = end_of(from, way, distance);
  const bool two_sided =
      (o.form == FieldShadowForm::two_sided || o.form == FieldShadowForm::disc) && slope > 0;

  double least = 1, last = 0, step = 0, t = o.start;
  for (; t < end; t += step) {
    if (result.steps == o.max_steps) {
      result.exhausted = true;
      break;
    }
    const accel::field::FieldSample sample = field_->sample(from + way * t);
    const double d = sample.distance;
    ++result.steps;
    if (!two_sided && d <= o.tolerance) {
      result.visibility = 0;
      return result;
    }
    double near = d, at = t;
    if (o.nearest == NearestThing::between && step > 0 && last > 0 && d > 0) {
      // Where both balls touch the same thing: so far back along the way, and that far beside it.
      const double back = (d * d - last * last + step * step) / (2 * step);
      if (!o.guard || (back > 0 && back < d))
        near = std::sqrt(std::max(0.0, d * d - back * back)), at = t - back;
    }
    double cone = slope * at;
    if (o.form == FieldShadowForm::clamped) cone = std::clamp(cone, o.min_radius, o.max_radius);
    // What is not known is a lower bound on the distance, and no reason to be dark; its sign is right.
    if ((sample.known || d < 0) && (slope > 0 || o.min_radius > 0))
      least = std::min(least, near / std::max(cone, std::numeric_limits<double>::min()));
    if (two_sided && least <= -1) break;
    last = d, step = std::max({std::abs(d), o.min_step, o.cone_step * slope * t});
  }
  result.visibility = open(least);
  if (o.form == FieldShadowForm::clamped)
    result.visibility =
        std::min(result.visibility, 1 - static_cast<float>(result.steps) / static_cast<float>(o.max_steps));
  return result;
}

/// What suits samples of a mesh: clear of the surface by a cell, which is more than the error of a look-up.
template <class SampledField>
FieldShadowOptions field_shadow_options(const SampledField& field) {
  const double cell = field.samples().lattice().spacing;
  FieldShadowOptions o;
  o.offset = o.start = cell, o.tolerance = 0.1 * cell, o.min_step = 0.25 * cell;
  return o;
}

static_assert(ShadowMethod<DistanceFieldShadow<accel::field::Sphere>>);

}  // namespace treeline::shading::shadow
