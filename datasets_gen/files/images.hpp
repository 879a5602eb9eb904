// Images through OpenImageIO: every format that it reads. Internal to the readers and writers; in builds
// without the package none of this is there.
#pragma once

#include "datasets_gen/files/input.hpp"

namespace treeline::datasets::files {

/// Whether OpenImageIO has a reader for files of this extension, which is in lower case and without its dot.
bool is_image_extension(const std::string& extension);

/// The first image of the file, its first four channels, values as the file has them: integers as shares of
/// their largest, with no curve undone and no alpha multiplied in. Throws FileError for what is no image, has
/// more than most_image_values values or a value that is not finite.
Dataset read_image(const Input&);
inline constexpr std::size_t most_image_values = std::size_t{1} << 28;

/// Writes a new file, `path`; `format` is "png" or "exr". Throws FileError naming `named` for an image that
/// the format cannot hold bit for bit: PNG has 8 or 16 bits a value, EXR floats.
void write_image(const shading::Image&, const std::filesystem::path& path, const std::string& format,
                 const std::filesystem::path& named);

}  // namespace treeline::datasets::files
