// Normals of a GGX surface with the density with which a viewer sees them, D(h) max(0, o·h) / A(o), where A
// is Ggx::projected_area: three samplers.
//
//  heitz_2018: Heitz, "Sampling the GGX distribution of visible normals": a warped disc seen from o.
//  caps: Dupuy and Benyoub 2023, "Sampling visible GGX normals with spherical caps": o plus a uniform
//  direction
//    of a cap; no frame to build, about twice as fast.
//  bounded: Eto and Tokuyoshi 2023, "Bounded VNDF sampling for Smith-GGX reflections": the cap cut where all
//    reflections lie below the surface. The density of the reflected direction is D / (4 B) with
//    B = bounded_area <= A; its variance is 5 % of that of the others at α = 0.1, seen head-on.
//
// The surface is a hemisphere that the roughness has stretched; what is seen of the hemisphere is simple.
// Cost: two roots, a sine and a cosine, a normalisation. Known weakness: of `heitz_2018` and `caps` a share
// of the reflections is below the surface and lost: head-on α²/(1+α²), at α = 1 cosθ/(1+cosθ).
#pragma once

#include <algorithm>

#include "shading/brdf/ggx.hpp"

namespace treeline::shading::brdf {

namespace detail {

template <std::floating_point T>
Direction<T> stretched(const Ggx<T>& d, const Direction<T>& o) {
  return geometry::normalized(Direction<T>{d.ax * o[0], d.ay * o[1], o[2]});
}
/// The facet's normal for a normal m of the hemisphere, which need not be of unit length.
template <std::floating_point T>
Direction<T> unstretched(const Ggx<T>& d, const Direction<T>& m) {
  const Direction<T> h{d.ax * m[0], d.ay * m[1], std::max(T(0), m[2])};
  const T l = geometry::length(h);
  return l > T(0) ? h / l : Direction<T>{0, 0, 1};
}
/// w plus a uniform direction of the part of the sphere with z in (-below, 1].
template <std::floating_point T>
Direction<T> plus_cap(const Direction<T>& w, T below, T u, T v) {
  const T angle = T(2) * std::numbers::pi_v<T> * u, z = (T(1) - v) * (T(1) + below) - below;
  const T r = std::sqrt(std::max(T(0), (T(1) - z) * (T(1) + z)));
  return {w[0] + r * std::cos(angle), w[1] + r * std::sin(angle), w[2] + z};
}

}  // namespace detail

/// o: unit, z above 0; u, v in [0, 1).
template <std::floating_point T>
Direction<T> sample_visible_heitz_2018(const Ggx<T>& d, const Direction<T>& o, T u, T v) {
  const Direction<T> w = detail::stretched(d, o);
  const T across2 = w[0] * w[0] + w[1] * w[1];
  const Direction<T> t1 =
      across2 > T(0) ? Direction<T>{-w[1], w[0], T(0)} / std::sqrt(across2) : Direction<T>{1, 0, 0};
  const Direction<T> t2 = geometry::cross(w, t1);
  const T r = std::sqrt(u), angle = T(2) * std::numbers::pi_v<T> * v;
  const T p1 = r * std::cos(angle), s = T(0.5) * (T(1) + w[2]);
  const T p2 = (T(1) - s) * std::sqrt(std::max(T(0), T(1) - p1 * p1)) + s * r * std::sin(angle);
  return detail::unstretched(d, p1 * t1 + p2 * t2 + std::sqrt(std::max(T(0), T(1) - p1 * p1 - p2 * p2)) * w);
}

/// Arguments as above.
template <std::floating_point T>
Direction<T> sample_visible_caps(const Ggx<T>& d, const Direction<T>& o, T u, T v) {
  const Direction<T> w = detail::stretched(d, o);
  return detail::unstretched(d, detail::plus_cap(w, w[2], u, v));
}

/// Share of the lower part of the cap that `bounded` keeps: for o at height z and s = 1 + sinθ,
/// k = (1 - a²) s² / (s² + a² z²) with a the smaller roughness; 0 for a >= 1.
template <std::floating_point T>
T bounded_share(const Ggx<T>& d, const Direction<T>& o) {
  const T a = std::min({d.ax, d.ay, T(1)}), s = T(1) + std::sqrt(o[0] * o[0] + o[1] * o[1]);
  return (T(1) - a) * (T(1) + a) * s * s / (s * s + a * a * o[2] * o[2]);
}

/// B(o): the density of a direction reflected at a normal of `bounded` is D / (4 B).
template <std::floating_point T>
T bounded_area(const Ggx<T>& d, const Direction<T>& o) {
  return T(0.5) * (bounded_share(d, o) * o[2] + d.stretched_length(o));
}

/// Arguments as above.
template <std::floating_point T>
Direction<T> sample_visible_bounded(const Ggx<T>& d, const Direction<T>& o, T u, T v) {
  const Direction<T> w = detail::stretched(d, o);
  return detail::unstretched(d, detail::plus_cap(w, bounded_share(d, o) * w[2], u, v));
}

}  // namespace treeline::shading::brdf
