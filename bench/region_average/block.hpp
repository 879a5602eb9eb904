// One texture, the footprints asked for, and how the means are judged.
#pragma once

#include "bench/region_average/method.hpp"
#include "bench/region_average/queries.hpp"
#include "datasets_gen/dataset.hpp"

namespace treeline::bench::region_average {

struct BlockInput {
  datasets::Dataset dataset;
  std::vector<FootprintSet> sets;
  int threads = 1;           // for the truth
  bool quick = false;        // time is short
  bool must_answer = false;  // a refusal is wrong
  bool moments = false;      // channels are z and z²: variances are judged, too
  bool independent = false;  // texels are of each other, and none is negative: theory knows what sums lose
};

/// Methods must outlive the block. Throws std::invalid_argument for an image without pixels or with more than
/// four channels.
std::unique_ptr<Block> open_block(const std::vector<Method>&, BlockInput);

}  // namespace treeline::bench::region_average
