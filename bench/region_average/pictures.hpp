// Pictures of a texture averaged over one footprint at every pixel: by the truth, by every method, and how
// far these are off; strips of one knob from its least to its most.
#pragma once

#include <string>

#include "bench/region_average/method.hpp"
#include "datasets_gen/dataset.hpp"

namespace treeline::bench::region_average {

/// Adds files and their lines of pictures.jsonl to the folder. In builds that cannot write PNG nothing is
/// written. Throws std::runtime_error naming what cannot be written.
void write_pictures(const std::vector<Method>&, const datasets::Dataset&, const std::string& folder);

}  // namespace treeline::bench::region_average
