// One surface, or one special question, and how the answers to it are judged.
#pragma once

#include "bench/brdf_integral/method.hpp"
#include "bench/brdf_integral/queries.hpp"
#include "datasets_gen/dataset.hpp"

namespace treeline::bench::brdf_integral {

struct BlockInput {
  datasets::Dataset dataset;
  Asks asks = Asks::integrals;
  std::vector<Set> sets;
  std::size_t n = 1;
  std::uint64_t seed = 1;
  std::size_t walks = 1 << 16;  // of the furnace's truth
  int threads = 1;              // for the truth
  bool quick = false;           // time is short
  bool must_answer = false;     // a refusal is wrong
  bool hard = false;
};

/// Methods must outlive the block.
std::unique_ptr<Block> open_block(const std::vector<Method>&, BlockInput);

}  // namespace treeline::bench::brdf_integral
