#include "bench/core/rounding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/tolerances.hpp"

namespace treeline::bench {
namespace {

constexpr double worth_a_word = 1e-6;  // of the extent, as the readers' own note has it
constexpr double worth_doing = 4;      // so many times less is float's loss afterwards

geometry::Box3d finite_box(const geometry::Mesh3f& mesh) {
  geometry::Box3d box;
  for (const geometry::Vec3f& vertex : mesh.vertices)
    if (geometry::is_finite(vertex)) box.grow(geometry::Vec3d(vertex));
  return box;
}

/// 123456.7 → 123000 where the mesh is 2000 wide: whole thousands are round enough to type.
double round_middle(double middle, double extent) {
  const double step = std::pow(10.0, std::floor(std::log10(extent)));
  return std::round(middle / step) * step;
}

}  // namespace

std::string format_remedy(const datasets::Dataset& input) {
  if (input.kind != datasets::Kind::mesh) return "";
  const geometry::Box3d box = finite_box(input.mesh);
  if (box.empty()) return "";
  const geometry::Vec3d sides = box.extent();
  const double extent = std::max({sides[0], sides[1], sides[2]});
  if (!(extent > 0) || !(input.rounding > worth_a_word * extent)) return "";
  geometry::Vec3d middle = box.centre();
  double farthest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = round_middle(middle[axis], extent);
    farthest =
        std::max({farthest, std::abs(box.low[axis] - middle[axis]), std::abs(box.high[axis] - middle[axis])});
  }
  const double after = farthest * geometry::tolerance::unit_roundoff<float>;
  if (input.rounding < worth_doing * after) return "";
  return fmt::format(
      "subtract its middle, ({:.15g}, {:.15g}, {:.15g}), from vertices and ray origins while they are "
      "doubles: float then moves them by up to about {:.1g} in place of {:.2g}",
      middle[0], middle[1], middle[2], after, input.rounding);
}

std::string format_rounding(const datasets::Dataset& input, bool in_double) {
  if (!(input.rounding > 0)) return "";
  if (in_double)
    return fmt::format(
        "  input  read as doubles, and errors are against these; float moves coordinates by up to {:.2g} "
        "(the file's unit)\n",
        input.rounding);
  std::string out = fmt::format(
      "  input  coordinates were rounded to float, which moved them by up to {:.2g} (the file's unit); "
      "errors above are\n         against the rounded ones{}\n",
      input.rounding,
      input.kind == datasets::Kind::cloud
          ? "; Bvh<Points<double, 3>, Wide> and KdTree<Points<double, 3>> take doubles"
          : "");
  if (const std::string remedy = format_remedy(input); !remedy.empty()) out += "  remedy " + remedy + "\n";
  return out;
}

}  // namespace treeline::bench
