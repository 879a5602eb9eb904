// Task `ray`: what does a ray hit first in a mesh, and does it hit anything at all?
//
// Queries: queries.hpp, and of some meshes moving.hpp; on hard cases the rays of the case, as `closest` and
// as
//   `any`.
// Truth: brute force with exact signs (truth.hpp) for an evenly spread sample of each set (all rays where the
// mesh is
//   small); a second witness in CGAL's exact kernel (oracle.hpp) agrees with it in the tests.
// Judging: judge.hpp says when an answer is right, borderline or false. Borderline answers count as right,
//   with the error that judge.cpp gives them; ray_borderline says how many there were. An answer counts as
//   right if it is right exactly, or right for the same ray moved by at most eps = 32 · unit_roundoff ·
//   (largest |coordinate| of the origin and of the triangles involved).
// Errors: error and error_mean are the mean over rays of min(1, |t - t_true| / t_true), where false hits and
// false
//   misses count 1; error_max and error_p99 of the same; bias is the mean signed relative error of t.
//   Any-hit sets: the share of false answers. Fields of its own: ray_judged, ray_false_hits,
//   ray_false_misses, ray_borderline, ray_wrong_primitive (ties apart), ray_wrong_t, ray_hit_share (of the
//   judged rays, how many truly hit); ray_surplus and ray_missing (hits where exact arithmetic has none, and
//   the reverse: borderline or not); ray_t_ulp_max and _mean (|t - t_true| in spacings of float at t_true,
//   where both are of one surface), ray_t_outside (answers whose t lies beyond their own triangle by more
//   than eps); ray_leaks_per_million (of rays from inside a closed mesh, those that met nothing; of other
//   rays at a closed mesh, the false misses; null for open meshes); ray_self_hits_per_million (of rays from a
//   convex surface outward, those that hit it; null elsewhere); ray_update_s (moving vertices: seconds of the
//   refit or rebuild); of our trees ray_references, ray_inner_nodes, ray_leaf_count, ray_depth, ray_sah_cost
//   and ray_node_bytes (an inner node's).
// Claims: exact: right up to the rounding of double, t rounded to float. bounded: right or borderline in
//   float, and no ray from inside a closed mesh gets out. approximate: may leak at edges and vertices, and t
//   may be off on a triangle that is thin or seen edge-on; anything else is wrong.
// Advice: on camera, diffuse, shadow and edge. A leak is an answer as wrong as can be, and a tolerance holds
//   for the worst single answer; the other sets show leaks by luck only, so that without edge a leaking
//   method would be advised to whoever wants none. With it, no method that leaks meets a tolerance below 1;
//   whoever can live with leaks at edges chooses among the sets in the report.
#pragma once

#include "bench/core/registered_task.hpp"
#include "bench/ray/method.hpp"

namespace treeline::bench::ray {

class RayTask final : public RegisteredTask<Method> {
 public:
  RayTask();

  std::string name() const override { return "ray"; }
  int version() const override { return 4; }
  std::vector<BlockSpec> blocks(Profile) const override;
  std::vector<BlockSpec> hard_blocks() const override;
  std::vector<BlockSpec> scaling_blocks(Profile) const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::mesh; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"camera", "diffuse", "shadow", "edge"}; }
  void pictures(const BlockSpec&, const RunContext&, const std::string& folder) const override;

 private:
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&, bool scaling) const;
};

}  // namespace treeline::bench::ray
