// One mesh, what is asked about it, and how the answers are judged.
#pragma once

#include <string>

#include "bench/distance_field/method.hpp"
#include "datasets_gen/dataset.hpp"

namespace treeline::bench::distance_field {

struct BlockInput {
  datasets::Dataset dataset;
  /// Tells the sides where the dataset itself does not; empty: it does, if it is closed.
  geometry::Mesh3f whole;
  /// What a reader of the rows must know of the mesh; empty: nothing.
  std::string note;
  std::size_t points = 4096, rays = 4096, judged = 4096;
  std::uint64_t seed = 1;
  int threads = 1;           // for the truth
  bool quick = false;        // time is short
  bool must_answer = false;  // a refusal is wrong
};

/// Methods must outlive the block. Throws std::invalid_argument for a mesh without faces.
std::unique_ptr<Block> open_block(const std::vector<Method>&, BlockInput);

}  // namespace treeline::bench::distance_field
