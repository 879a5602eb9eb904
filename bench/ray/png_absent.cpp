// Stands in for png.cpp in builds without OpenImageIO.
#ifdef TREELINE_WITHOUT_PNG
#include "bench/ray/png.hpp"

namespace treeline::bench::ray {

bool write_png(const std::string&, const shading::Image&) { return false; }

}  // namespace treeline::bench::ray
#endif
