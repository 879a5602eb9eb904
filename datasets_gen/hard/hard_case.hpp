// Hard cases: small inputs on which methods are known to break, each with its source and its law.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/cloud.hpp"
#include "geometry/mesh.hpp"
#include "geometry/ray.hpp"

namespace treeline::datasets {

/// What a method may do with a case and still be right.
enum class Expect {
  answers,            // must answer, and answer right
  answers_or_refuses  // may refuse with a clear error; if it answers, it must answer right over the finite
                      // part
};

/// Rays from points of a convex closed surface that lead away from it, each from an origin `offset` off.
struct RaysOut {
  std::string name;  // of the query set
  std::vector<geometry::Rayf> rays;
};

struct HardCase {
  std::string family;  // one file of datasets_gen/hard each
  std::string name;    // unique over all families
  std::string source;  // paper, upstream issue or derivation
  std::string law;     // what must hold, in one sentence
  Expect expect = Expect::answers;

  // For the task knn: points, and queries of each kind that is not empty.
  geometry::Cloud3f cloud;
  std::vector<geometry::Vec3f> queries;
  std::size_t k = 8;
  std::optional<float> radius;  // radius queries too

  // For the task ray: a mesh, and rays.
  geometry::Mesh3f mesh;
  std::vector<geometry::Rayf> rays;
  std::size_t judged = SIZE_MAX;  // so many of the rays are enough to judge; leaks count them all
  bool from_inside = false;       // every ray starts inside the closed mesh: each must hit
  std::vector<RaysOut> outward;   // instead of rays: the smallest offset that no ray hits at is sought

  // For the task closest_point: a mesh, and points whose nearest on it is asked for.
  std::vector<geometry::Vec3f> probes;

  bool for_rays() const { return !rays.empty() || !outward.empty(); }
  bool for_closest_points() const { return !probes.empty(); }
  bool for_points() const { return !for_rays() && !for_closest_points(); }
};

/// All cases of all families; deterministic.
std::vector<HardCase> hard_cases();

}  // namespace treeline::datasets
