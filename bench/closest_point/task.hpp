// Task `closest_point`: which point of a mesh lies nearest to a query, and on which triangle?
//
// Queries: queries.hpp; on hard cases the points of the case, as `closest`.
// Truth: brute force without an error (truth.hpp) for an evenly spread sample of each set (all queries where
//   the mesh is small); a second witness in CGAL's exact kernel (oracle.hpp) agrees with it in the tests.
// Errors: over the diagonal of the box of the finite triangles, and the larger of two: how far the distance
// to
//   the point answered is from the true one, and how far that point lies off the triangle named. No answer
//   where there is one counts 1, and so does an answer where there is none. error and error_mean are the mean
//   over queries; bias is the mean signed error of the distance. Fields of its own: closest_point_judged;
//   _far_off (the share of answers off by more than 1e-6); _wrong_triangle (the share that name a triangle
//   that is farther than the nearest, ties apart, in exact arithmetic) and _much_farther (by more than 1e-6);
//   _off_triangle_max; _relative_mean and _max (of the distance as the method gives it, over the true
//   distance, at most 1); of our trees _references, _inner_nodes, _leaf_count, _depth and _node_bytes.
// Claims: exact: the triangle is a nearest one in exact arithmetic, the squared distance in double is the
// true
//   one rounded once, and the point is right to 4 unit roundoffs of float. bounded: the distance, as it is
//   told and to the point, is off by at most 64 unit roundoffs of the largest |coordinate| of the query and
//   the nearest triangle, the triangle named is no farther than the nearest by more than that, and the point
//   off the triangle named by as much of the query and that triangle; of float or, of methods that say so,
//   double; of methods that answer in float at least 64 of float's least steps. approximate: nothing, but an
//   answer off by both a hundredth of the diagonal and that bound is wrong (not of methods that search a mesh
//   of their own).
// Advice: on near, uniform and on_vertex. The ladder begins with decimated meshes: the least model.
#pragma once

#include "bench/closest_point/method.hpp"
#include "bench/core/registered_task.hpp"

namespace treeline::bench::closest_point {

class ClosestPointTask final : public RegisteredTask<Method> {
 public:
  ClosestPointTask();

  std::string name() const override { return "closest_point"; }
  int version() const override { return 1; }
  std::vector<BlockSpec> blocks(Profile) const override;
  std::vector<BlockSpec> hard_blocks() const override;
  std::vector<BlockSpec> scaling_blocks(Profile) const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::mesh; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"near", "uniform", "on_vertex"}; }
  void pictures(const BlockSpec&, const RunContext&, const std::string& folder) const override;

 private:
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&, bool scaling) const;
};

}  // namespace treeline::bench::closest_point
