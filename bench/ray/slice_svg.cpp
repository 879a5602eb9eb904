#include "bench/ray/slice_svg.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "geometry/box.hpp"

namespace treeline::bench::ray {
namespace {

constexpr double pixels = 480;  // along the longer side

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", x);
  return text;
}

}  // namespace

void write_slice_svg(const std::string& file, const std::vector<accel::SliceCell>& cells) {
  geometry::Box<double, 2> box;
  std::size_t deepest = 1;
  for (const auto& cell : cells) {
    for (const auto& p : cell.outline) box.grow(p);
    deepest = std::max(deepest, cell.depth);
  }
  if (box.empty()) box = {{0, 0}, {1, 1}};
  const auto extent = box.extent();
  const double scale = pixels / std::max({extent[0], extent[1], 1e-30});
  std::ofstream out(file);
  out << R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="-2 -2 )" << number(extent[0] * scale + 4) << ' '
      << number(extent[1] * scale + 4) << R"(" stroke="#1b3a57" stroke-width="0.5">)" << '\n';
  for (const auto& cell : cells) {
    const double depth = static_cast<double>(cell.depth) / static_cast<double>(deepest);
    // Empty cells stay white, so that the surface shows through as the filled ones.
    const std::string fill =
        cell.primitives == 0 ? "#ffffff" : "hsl(205,60%," + number(92 - 50 * depth) + "%)";
    out << "<polygon fill=\"" << fill << "\" fill-opacity=\"0.7\" points=\"";
    for (const auto& p : cell.outline)
      out << number((p[0] - box.low[0]) * scale) << ',' << number((box.high[1] - p[1]) * scale) << ' ';
    out << "\"/>\n";
  }
  out << "</svg>\n";
  if (!out) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace treeline::bench::ray
