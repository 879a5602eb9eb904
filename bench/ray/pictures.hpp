// Pictures of one mesh for the report: what the camera sees, where methods disagree with the truth, and
// slices through our trees.
#pragma once

#include <string>
#include <vector>

#include "bench/core/task.hpp"
#include "bench/ray/method.hpp"

namespace treeline::bench::ray {

/// Writes ray_<dataset>_*.png and .svg into the folder and appends to its pictures.jsonl.
void draw_pictures(const std::vector<Method>& methods, const BlockSpec&, const RunContext&,
                   const std::string& folder);

}  // namespace treeline::bench::ray
