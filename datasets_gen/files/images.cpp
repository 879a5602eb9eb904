#include "datasets_gen/files/images.hpp"

#include <OpenImageIO/imageio.h>

#include <cctype>

namespace treeline::datasets::files {
namespace {

/// OpenImageIO's words, on one line.
std::string told(std::string words) {
  std::ranges::replace(words, '\n', ' ');
  while (!words.empty() && std::isspace(static_cast<unsigned char>(words.back()))) words.pop_back();
  return words.empty() ? "it gives no reason" : words;
}

std::string sides(const OIIO::ImageSpec& spec) {
  return std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels of " +
         std::to_string(spec.nchannels) + " channels";
}

void check_finite(const Input& in, const shading::Image& image) {
  std::size_t odd = 0, first = 0;
  for (std::size_t i = image.values.size(); i-- > 0;)
    if (!std::isfinite(image.values[i])) ++odd, first = i;
  if (odd == 0) return;
  const auto c = static_cast<std::size_t>(image.channels), w = static_cast<std::size_t>(image.width);
  in.fail("pixel (" + std::to_string(first / c % w) + ", " + std::to_string(first / c / w) + ")",
          "channel " + std::to_string(first % c) + " is not finite" +
              (odd > 1 ? ", the first of " + std::to_string(odd) + " such values" : ""));
}

/// All pixels, as whole numbers of which `top` are 1. OpenImageIO multiplies by 1 / top, which is off by a
/// digit.
template <class Level>
bool read_levels(OIIO::ImageInput& in, OIIO::TypeDesc type, float top, shading::Image& image) {
  std::vector<Level> levels(image.values.size());
  if (!in.read_image(0, 0, 0, image.channels, type, levels.data())) return false;
  std::ranges::transform(levels, image.values.begin(),
                         [top](Level v) { return static_cast<float>(v) / top; });
  return true;
}

bool read_pixels(OIIO::ImageInput& in, OIIO::TypeDesc held, shading::Image& image) {
  if (held == OIIO::TypeDesc::UINT8) return read_levels<std::uint8_t>(in, held, 255, image);
  if (held == OIIO::TypeDesc::UINT16) return read_levels<std::uint16_t>(in, held, 65535, image);
  return in.read_image(0, 0, 0, image.channels, OIIO::TypeDesc::FLOAT, image.values.data());
}

/// Whether every value is a whole number of steps, `top` of which make 1.
bool in_levels(const shading::Image& image, float top) {
  return std::ranges::all_of(
      image.values, [&](float v) { return v >= 0 && v <= 1 && std::floor(v * top + 0.5f) / top == v; });
}

}  // namespace

bool is_image_extension(const std::string& extension) {
  // "tiff:tif,tiff,tx;png:png;…"
  const std::string all = OIIO::get_string_attribute("extension_list");
  std::vector<std::string_view> formats, words;
  split(all, ";", formats);
  for (const std::string_view format : formats) {
    split(format, ":,", words);
    if (words.empty() || words[0] == "null" || words[0] == "term" || words[0] == "socket") continue;
    if (std::find(words.begin() + 1, words.end(), extension) != words.end()) return true;
  }
  return false;
}

Dataset read_image(const Input& file) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  const auto in = OIIO::ImageInput::open(file.path.string(), &config);
  if (!in) file.fail("", "cannot be read as an image: " + told(OIIO::geterror()));
  const OIIO::ImageSpec spec = in->spec();
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1)
    file.fail("", "holds no pixels: " + sides(spec));
  if (spec.depth > 1) file.fail("", "is a volume of " + std::to_string(spec.depth) + " slices, not an image");
  if (spec.deep) file.fail("", "is a deep image, which is not read");
  const int channels = std::min(spec.nchannels, 4);
  const auto values = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  if (values > most_image_values / static_cast<std::size_t>(channels))
    file.fail("", "has " + sides(spec) + ", more than the 2^28 values that are read");
  Dataset r;
  r.name = file.path.filename().string();
  r.kind = Kind::image;
  r.image = shading::Image(spec.width, spec.height, channels);
  if (!read_pixels(*in, spec.format, r.image))
    file.fail("", "cannot be read in full: " + told(in->geterror()));
  check_finite(file, r.image);
  if (spec.nchannels > channels)
    r.notes.push_back("has " + std::to_string(spec.nchannels) +
                      " channels, of which the first four are read");
  if (in->seek_subimage(1, 0)) r.notes.push_back("holds more than one image, of which the first is read");
  return r;
}

void write_image(const shading::Image& image, const std::filesystem::path& path, const std::string& format,
                 const std::filesystem::path& named) {
  OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT;
  if (format == "png") {
    type = in_levels(image, 255) ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16;
    if (type == OIIO::TypeDesc::UINT16 && !in_levels(image, 65535))
      throw FileError(named, "",
                      "PNG has 256 or 65536 levels from 0 to 1, and this image has values between them; .exr "
                      "holds floats");
  }
  OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  // Or the writer of EXR would date files by the clock: equal images are equal files.
  if (format == "exr") spec.attribute("DateTime", "");
  const auto out = OIIO::ImageOutput::create(format);
  if (!out) throw FileError(named, "", "cannot be written: " + told(OIIO::geterror()));
  if (!out->open(path.string(), spec) || !out->write_image(OIIO::TypeDesc::FLOAT, image.values.data()) ||
      !out->close())
    throw FileError(named, "", "cannot be written: " + told(out->geterror()));
}

}  // namespace treeline::datasets::files
