#include "bench/ray/png.hpp"

#include <OpenImageIO/imageio.h>

namespace treeline::bench::ray {

bool write_png(const std::string& file, const shading::Image& image) {
  const auto out = OIIO::ImageOutput::create(file);
  if (!out) throw std::runtime_error(file + ": " + OIIO::geterror());
  OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (!out->open(file, spec) || !out->write_image(OIIO::TypeDesc::FLOAT, image.values.data()) ||
      !out->close())
    throw std::runtime_error(file + ": " + out->geterror());
  return true;
}

}  // namespace treeline::bench::ray
