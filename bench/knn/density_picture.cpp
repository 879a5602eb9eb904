#include "bench/knn/density_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "accel/kd_tree/points.hpp"
#include "bench/knn/svg.hpp"

namespace treeline::bench::knn {
namespace {

constexpr std::size_t neighbours = 16;  // fewer: specks of single points; more: edges blur
constexpr double squares = 128;         // along the longer side
constexpr int shades = 24;              // few, so that equal neighbours in a row become one rectangle
constexpr double least_reach = 1e-6;    // of the widest side: where many points coincide

struct Raster {
  std::size_t width = 0, height = 0;
  std::vector<double> log_density;  // row by row from the top: pictures grow downwards
};

std::size_t squares_of(double side, double widest) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(squares * side / widest)));
}

Raster raster(std::span<const Vec3f> points, const Box3f& box, int axis, double offset) {
  using Tree = accel::KdTree<accel::Points<float, 3>>;
  Tree::Options options;
  options.non_finite = accel::NonFinite::drop;
  const Tree tree(points, options);
  const std::size_t k = std::min(neighbours, tree.size());
  std::vector<accel::Neighbor<float>> near(k);

  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  const double w = double(box.high[u]) - box.low[u], h = double(box.high[v]) - box.low[v];
  const double widest = std::max(w, h), side = widest / squares;
  Raster r{squares_of(w, widest), squares_of(h, widest), {}};
  for (std::size_t j = 0; j < r.height; ++j)
    for (std::size_t i = 0; i < r.width; ++i) {
      Vec3f at;
      at[axis] = static_cast<float>(offset);
      at[u] = static_cast<float>(box.low[u] + (static_cast<double>(i) + 0.5) * side);
      at[v] = static_cast<float>(box.high[v] - (static_cast<double>(j) + 0.5) * side);
      tree.nearest(at, k, near);
      const double reach =
          std::max(std::sqrt(static_cast<double>(near.back().distance2)), least_reach * widest);
      r.log_density.push_back(
          std::log10(static_cast<double>(k) / (4 * std::numbers::pi / 3 * reach * reach * reach)));
    }
  return r;
}

}  // namespace

DensityPicture density_picture(std::span<const Vec3f> points, const Box3f& box, int axis, double offset) {
  if (box.empty() || !(box.extent()[box.widest_axis()] > 0)) return {};
  const Raster r = raster(points, box, axis, offset);
  const auto [low, high] = std::minmax_element(r.log_density.begin(), r.log_density.end());
  const double least = *low, range = std::max(*high - least, 1e-9);
  const auto shade_of = [&](double x) {
    return std::min(shades - 1, static_cast<int>((x - least) / range * shades));
  };
  std::vector<std::string> paths(shades);  // one a shade, a rectangle for each run of it
  for (std::size_t j = 0; j < r.height; ++j)
    for (std::size_t i = 0, end = 0; i < r.width; i = end) {
      const double* row = &r.log_density[j * r.width];
      const int shade = shade_of(row[i]);
      for (end = i + 1; end < r.width && shade_of(row[end]) == shade;) ++end;
      const std::string length = std::to_string(end - i);
      std::string& path = paths[static_cast<std::size_t>(shade)];
      path.append("M").append(std::to_string(i)).append(" ").append(std::to_string(j));
      path.append("h").append(length).append("v1h-").append(length).append("z");
    }
  DensityPicture picture{"", std::pow(10, least), std::pow(10, *high)};
  picture.svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" shape-rendering=\"crispEdges\" viewBox=\"0 0 " +
                std::to_string(r.width) + " " + std::to_string(r.height) + "\">\n";
  for (int shade = 0; shade < shades; ++shade)
    if (const std::string& path = paths[static_cast<std::size_t>(shade)]; !path.empty())
      picture.svg += "<path fill=\"" + svg_shade(shade / double(shades - 1)) + "\" d=\"" + path + "\"/>\n";
  picture.svg += "</svg>\n";
  return picture;
}

}  // namespace treeline::bench::knn
