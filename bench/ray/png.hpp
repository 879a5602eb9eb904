// Pictures as PNG files, through OpenImageIO. In builds without it nothing is written.
#pragma once

#include <string>

#include "shading/image.hpp"

namespace treeline::bench::ray {

/// Values in [0, 1] are written as they are, 8 bits a channel. False in builds without OpenImageIO.
/// Throws std::runtime_error naming the file if it cannot be written.
bool write_png(const std::string& file, const shading::Image& image);

}  // namespace treeline::bench::ray
