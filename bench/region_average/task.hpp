// The task region_average: what is the mean of a region of a texture?
//
// Query sets, each in random order and, called …_sorted, in that of a picture; sizes in texels:
//   texel, aligned16: squares of whole texels, with corners at multiples of their side; square4, square24:
//   anywhere; oblong: 64 x 4 and 4 x 64; rotated: 32 x 8 at any angle; disc: of radius 12; gaussian: of
//   deviation 6, cut off at three (the last three in order in the full profile alone). build: the structure
//   is made anew from the texture, in its own memory; a query is a texel.
// error: the root of the mean square of answer - truth, over the range of the texture's values (the largest
// absolute one, where they are all alike); max, p99, mean and signed bias alike. Truth: truth.hpp. Beyond its
// borders a texture goes on as its outermost texels.
// Fields of its own (region_average_…): last_quarter, the error over footprints whose middle is in the lower
// right quarter, where tables hold their largest sums; mean, of the texture's absolute values; of hard cases
// with moments variance_error and negative_variances.
// Claims: exact: one ulp of float, for boxes along the axes (brute force: for all); where a texture has other
// values than levels of 16 bits and the table knows no others, half a step. bounded: what its sums may lose.
#pragma once

#include "bench/core/registered_task.hpp"
#include "bench/region_average/method.hpp"

namespace treeline::bench::region_average {

class RegionAverageTask final : public RegisteredTask<Method> {
 public:
  RegionAverageTask();
  std::string name() const override { return "region_average"; }
  int version() const override { return 1; }
  std::vector<BlockSpec> blocks(Profile) const override;
  /// Those of datasets_gen/hard/hard_textures.hpp.
  std::vector<BlockSpec> hard_blocks() const override;
  std::vector<BlockSpec> scaling_blocks(Profile) const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::image; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"square24", "oblong"}; }
  /// The texture, what methods make of it with one footprint at every pixel, and how far they are off.
  void pictures(const BlockSpec&, const RunContext&, const std::string& folder) const override;

 private:
  /// independent: as in BlockInput.
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&, bool scaling, bool independent) const;
};

}  // namespace treeline::bench::region_average
