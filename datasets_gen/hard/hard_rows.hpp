// Hard cases for indices over rows of any dimension: as hard_case.hpp, with rows and queries of as many
// columns.
#pragma once

#include "datasets_gen/dataset.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::datasets {

struct HardRows {
  std::string name;  // unique, over all other hard cases too
  std::string source, law;
  Expect expect = Expect::answers;
  Vectors rows, queries;
  std::size_t k = 8;
};

/// Deterministic.
std::vector<HardRows> hard_rows();

}  // namespace treeline::datasets
