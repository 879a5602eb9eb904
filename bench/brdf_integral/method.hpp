// What a method gives this task: something made for a surface that answers whole query sets.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/brdf_integral/sky.hpp"
#include "bench/core/task.hpp"
#include "geometry/vec.hpp"
#include "shading/material.hpp"

namespace treeline::bench::brdf_integral {

using geometry::Vec3d;
using shading::Material;

/// What a block asks; each method answers one of these, and is offered nowhere else.
///   integrals: how much light a surface reflects to a viewer, 3 numbers a query
///   kernels: the value of its BRDF for pairs of directions, and samples of directions
///   furnace: how much a rough metal reflects with all bounces between its facets, 1 number a query
///   fresnel: how much of the light a smooth boundary reflects
///   solid_angles: how large a shape is seen
enum class Asks { integrals, kernels, furnace, fresnel, solid_angles };

/// Directions as arrays, as kernels read them.
struct Directions {
  std::vector<float> x, y, z;
  void add(const Vec3d& w) { x.push_back(float(w[0])), y.push_back(float(w[1])), z.push_back(float(w[2])); }
};

/// A boundary between two media: of index over that before it, and extinction.
struct Medium {
  double index = 1.5, extinction = 0;
};

enum class ShapeKind { sphere, disc, triangle, rectangle, box };
/// As seen from the origin. sphere, disc: around `centre`, of radius `length(u)`, a disc's normal along
/// cross(u, v). rectangle: centre ± u ± v. triangle: with corners centre, centre + u, centre + v. box: along
/// the axes, from centre - u to centre + u.
struct Shape {
  ShapeKind kind = ShapeKind::sphere;
  Vec3d centre{}, u{}, v{};
};

/// Queries of one kind. Of integrals, each view is asked `repeats` times, with a seed each, one after the
/// other; kernels answer for every entry.
struct Set {
  std::string name;
  std::size_t channels = 1;  ///< numbers a query
  // Integrals:
  std::vector<Vec3d> views;  ///< one a query; none: `average`, over all viewers, weighed by their cosine
  Sky sky;
  std::size_t repeats = 1;
  std::size_t averages = 0;  ///< queries of a set without views
  // Kernels: `evaluate` asks f(wi, wo), `sample` the direction for wo and (u, v), of which it answers the
  // weight.
  bool samples = false;
  Directions wi, wo;
  std::vector<float> u, v;
  // Furnace: facets, and how much of the light each reflects, at normal incidence (Schlick).
  double alpha = 0.5, reflectance = 1;
  // Fresnel: cosines of the angle before the boundary.
  Medium medium;
  std::vector<double> cosines;
  // Solid angles:
  std::vector<Shape> shapes;

  std::size_t queries() const {
    if (averages > 0) return averages;
    return !views.empty()     ? views.size()
           : !wo.x.empty()    ? wo.x.size()
           : !cosines.empty() ? cosines.size()
           : !shapes.empty()  ? shapes.size()
                              : 1;
  }
};

/// Of all contributions to the answers of one viewer: sums of powers, and the largest. Fireflies show here.
struct Moments {
  double n = 0, sum = 0, sum2 = 0, sum3 = 0, sum4 = 0, largest = 0;

  void add(double x) {
    n += 1, sum += x, sum2 += x * x, sum3 += x * x * x, sum4 += x * x * x * x;
    largest = std::max(largest, x);
  }
};

class Answerer {
 public:
  virtual ~Answerer() = default;
  /// Answers of query i from out[i * channels] on. Throws Unsupported where the method has no such query.
  virtual void answer(const Set&, const Knobs& query_knobs, int threads, std::span<float> out) = 0;
  /// Of a stochastic method: what its answers to the set are sums of, viewer by viewer.
  virtual std::vector<Moments> moments(const Set&, const Knobs& query_knobs) {
    (void)query_knobs;
    return {};
  }
};

struct Input {
  const Material& material;
  int threads = 1;
  std::uint64_t seed = 1;  ///< of all random numbers
};

struct Method {
  MethodInfo info;
  Asks asks = Asks::integrals;
  double allowed = 0;  ///< largest error by the method's own claim; 0: none is promised
  std::unique_ptr<Answerer> (*build)(const Input&, const Knobs& build_knobs) = nullptr;
};

}  // namespace treeline::bench::brdf_integral
