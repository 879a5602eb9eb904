// The task distance_field: how far is it to the surface of a mesh, on which side, and what does a ray meet,
// if only samples of the distance are kept?
//
// Every field is built at several resolutions (cells along the longest side of the mesh's box), with
// distances known within a band of 3 cells on either side. Its build is all of it, trees included. Query
// sets:
//   near: points within 1 % of the longest side from the surface, so that every resolution of the sweep (at
//     most 256) knows them. error and error_mean: the mean of |answer - truth| in longest sides; max, p99 and
//     the signed bias alike. uniform: points of the box and a tenth around it: the share of wrong sides, as
//     beyond its band a field knows no more. trace: rays from all around through the box: the error of t in
//     longest sides, at most 1, which is that of a false hit and of a false miss.
// Fields of its own (distance_field_…): sample_error_max, _mean (in longest sides, of the samples
// in the band), sample_signs_wrong (their share, null where nothing tells sides); signs_wrong;
// steps_mean, steps_max, exhausted, false_hits, false_misses, untold_misses (misses where there is a hit, and
// the field did not say that it might be), doubtful (the share of rays that are told to be doubtful or are
// given up), note (of a mesh that is open or inside out), and what the field tells of itself: known_samples,
// bound_cells (the mean of its bricks' bounds on the error, in cells), told_closed, told_inside_out,
// sign_conflicts, undecided_signs. Truth: truth.hpp. Claims: bounded: an answer is off by no more than the
// field said it might be, and is what it said that of; a ray that missed a surface, or went through one to
// hit another, was told to be doubtful, one that hit is within the bound of one, and of the rays that clearly
// miss, by what the field says for certain along them, no more than half are doubtful. approximate: none.
#pragma once

#include "bench/core/registered_task.hpp"
#include "bench/distance_field/method.hpp"

namespace treeline::bench::distance_field {

class DistanceFieldTask final : public RegisteredTask<Method> {
 public:
  DistanceFieldTask();
  std::string name() const override { return "distance_field"; }
  int version() const override { return 4; }
  std::vector<BlockSpec> blocks(Profile) const override;
  /// Damaged meshes, and those hard cases of the task ray that are closed or at least finite.
  std::vector<BlockSpec> hard_blocks() const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::mesh; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"near"}; }
};

}  // namespace treeline::bench::distance_field
