// How much mesh does a query need? Our binary hierarchy over the mesh, and over what OpenMesh's decimation
// leaves of it (Garland and Heckbert 1997): the knob keep is the share of the faces that are left.
//
// Claim: approximate. Its answers lie on the smaller mesh, whose faces have other numbers, so only their
// distances are judged. The time of the build is mostly the decimation's. A soup has no edges to collapse:
// what cannot be made small enough says so.
#include <fmt/format.h>

#include "accel/bvh.hpp"

#include "bench/closest_point/tree_index.hpp"
#include "datasets_gen/files/half_edges.hpp"

namespace treeline::bench::closest_point {
namespace {

constexpr double too_many = 1.05;  // times the faces asked for

std::unique_ptr<Index> build(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  const auto keep = knobs.at("keep").get<double>();
  const Knobs tree_knobs = {{"leaf_size", 4}};
  if (keep == 1) return build_tree<accel::Bvh, float, NoNode>(mesh, tree_knobs, threads);
  if (!datasets::has_half_edges()) throw Unsupported("this build has no OpenMesh to decimate with");
  const geometry::Mesh3f small = datasets::decimated(mesh, keep).mesh;
  const double share = static_cast<double>(small.size()) / static_cast<double>(mesh.size());
  if (share > keep * too_many)
    throw Unsupported(
        fmt::format("no further edge can be collapsed: {:.3g} % of the faces are left, where "
                    "{:g} % were asked for",
                    100 * share, 100 * keep));
  return build_tree<accel::Bvh, float, NoNode>(small, tree_knobs, threads);
}

std::vector<Knobs> builds() {
  std::vector<Knobs> all;
  for (const double keep : {1.0, 0.5, 0.25, 0.1, 0.05}) all.push_back(Knobs{{"keep", keep}});
  return all;
}

const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "bvh_decimated",
              .family = "bvh",
              .claim = Claim::approximate,
              .build_knobs = builds(),
              .stress_builds = {},
              .ladder = 0,
              .largest_n = 200'000,  // decimation takes some forty microseconds a face
              .quick_largest_n = 60'000,
              .scales = false},
     .build = build,
     .names_triangles = false});

}  // namespace
}  // namespace treeline::bench::closest_point
