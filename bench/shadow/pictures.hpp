// Pictures of one scene: the truth, each method beside it, and where it is off.
#pragma once

#include <string>

#include "bench/shadow/block.hpp"

namespace treeline::bench::shadow {

/// Writes the truth with each method's most accurate image of its first build and the map of its errors under
/// it, all in one picture; for our methods with a knob of at least three steps, in two scenes, a strip of
/// images from its least to its most; and the index of them. Nothing in builds without OpenImageIO. Throws
/// std::runtime_error naming a file that cannot be written.
void draw_pictures(const std::vector<Method>& methods, ShadowBlock& block, const std::string& dataset,
                   int threads, const std::string& folder);

}  // namespace treeline::bench::shadow
