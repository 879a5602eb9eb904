#include "bench/knn/slice_picture.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "bench/knn/density_picture.hpp"
#include "bench/knn/double_scan.hpp"
#include "bench/knn/svg.hpp"

namespace treeline::bench::knn {
namespace {

constexpr double longer_side = 640;        // of the picture, in pixels
constexpr double near_plane = 0.005;       // points drawn: this share of the box's widest side from the plane
constexpr std::size_t most_points = 4000;  // drawn, evenly spread: more only make the file large
constexpr std::size_t most_cells = 20000;  // drawn: beyond, outlines are finer than a pixel

struct Frame {
  int u, v;
  double scale, left, top;  // top: the largest v, as pictures grow downwards
  double width, height;

  Frame(const Box3f& box, int axis) : u(axis == 0 ? 1 : 0), v(axis == 2 ? 1 : 2) {
    const double w = double(box.high[u]) - box.low[u], h = double(box.high[v]) - box.low[v];
    const double widest = std::max(w, h);
    scale = widest > 0 ? longer_side / widest : 1;
    left = box.low[u], top = box.high[v];
    width = std::max(1.0, w * scale), height = std::max(1.0, h * scale);
  }
  std::string x(double value) const { return svg_number((value - left) * scale); }
  std::string y(double value) const { return svg_number((top - value) * scale); }
};

int shortest_axis(const Box3f& box) {
  const Vec3f e = box.extent();
  int r = 0;
  for (int a = 1; a < 3; ++a)
    if (e[a] < e[r]) r = a;
  return r;
}

std::string file_name(std::string text) {
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
  return text + ".svg";
}

std::ofstream opened(const std::filesystem::path& path, std::ios::openmode mode) {
  std::ofstream out(path, mode);
  if (!out) throw std::runtime_error("cannot write " + path.string());
  return out;
}

/// Writes the picture, then its line of the index: what the index names is there.
void save(const std::filesystem::path& folder, const std::string& name, const std::string& svg, Knobs entry) {
  const std::string file = file_name(name);
  auto out = opened(folder / file, std::ios::out);
  out << svg;
  if (!out.flush()) throw std::runtime_error("cannot write " + (folder / file).string());
  entry["file"] = file;
  auto index = opened(folder / "pictures.jsonl", std::ios::app);
  index << entry.dump() << '\n';
  if (!index.flush()) throw std::runtime_error("cannot write " + (folder / "pictures.jsonl").string());
}

std::string slice_caption(const std::vector<accel::SliceCell>& cells, const Knobs& knobs) {
  const auto [shallowest, deepest] = std::minmax_element(
      cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.depth < b.depth; });
  std::string built;
  for (const auto& [name, value] : knobs.items())
    built += (built.empty() ? "" : ", ") + name + " " +
             (value.is_string() ? value.get<std::string>() : value.dump());
  const std::string least = std::to_string(shallowest->depth), most = std::to_string(deepest->depth);
  std::string text =
      "The plane through the middle of the cloud across its shortest side. Outlines are leaves' cells, " +
      (least == most ? "all at depth " + least
                     : "light where they lie shallow (depth " + least + "), dark where deep (" + most + ")") +
      "; dots are points within " + svg_figure(100 * near_plane) + " % of the cloud's width of the plane.";
  if (cells.size() > most_cells)
    text += " Only the first " + std::to_string(most_cells) + " cells are drawn.";
  return built.empty() ? text : text + " Built with " + built + ".";
}

}  // namespace

std::string slice_svg(std::span<const Vec3f> points, const std::vector<accel::SliceCell>& cells,
                      const Box3f& box, int axis, double offset) {
  const Frame frame(box, axis);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-2 -2 " +
                    svg_number(frame.width + 4) + " " + svg_number(frame.height + 4) +
                    "\">\n<g stroke=\"#444\" stroke-width=\"0.4\">\n";
  std::size_t shallowest = SIZE_MAX, deepest = 0;
  for (const auto& c : cells)
    shallowest = std::min(shallowest, c.depth), deepest = std::max(deepest, c.depth);
  for (std::size_t i = 0; i < std::min(cells.size(), most_cells); ++i) {
    const double share = deepest > shallowest ? static_cast<double>(cells[i].depth - shallowest) /
                                                    static_cast<double>(deepest - shallowest)
                                              : 0;
    svg += "<path fill=\"" + svg_shade(share) + "\" d=\"";
    char command = 'M';
    for (const geometry::Vec2d& p : cells[i].outline) {
      svg += command + frame.x(p[0]) + " " + frame.y(p[1]);
      command = 'L';
    }
    svg += "Z\"/>\n";
  }
  svg += "</g>\n<g fill=\"#d95f02\">\n";

  const double reach = near_plane * box.extent()[box.widest_axis()];
  std::vector<std::size_t> close;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::abs(points[i][axis] - offset) <= reach) close.push_back(i);
  const std::size_t drawn = std::min(close.size(), most_points);
  for (std::size_t i = 0; i < drawn; ++i) {
    const Vec3f& p = points[close[i * close.size() / drawn]];
    svg += "<circle r=\"1.5\" cx=\"" + frame.x(p[frame.u]) + "\" cy=\"" + frame.y(p[frame.v]) + "\"/>\n";
  }
  return svg + "</g>\n</svg>\n";
}

void write_pictures(const std::vector<Method>& methods, std::span<const Vec3f> points,
                    const std::string& dataset, const std::string& folder) {
  const Box3f box = DoubleScan(points).box();
  if (box.empty()) throw std::runtime_error("nothing to draw: " + dataset + " has no finite point");
  std::filesystem::create_directories(folder);
  const int axis = shortest_axis(box);
  const double offset = box.centre()[axis];
  std::string plane{"xyz"[axis]};
  plane += " = " + svg_number(offset);
  if (const DensityPicture density = density_picture(points, box, axis, offset); !density.svg.empty())
    save(folder, "knn_" + dataset + "_density", density.svg,
         {{"title", "density at " + plane},
          {"caption", "Points per unit volume, by the distance to the 16th nearest: from " +
                          svg_figure(density.least) + " (light) to " + svg_figure(density.most) +
                          " (dark), logarithmic."},
          {"dataset", dataset},
          {"method", ""},
          {"kind", "density"}});
  for (const Method& method : methods) {
    if (method.info.source != Source::ours || method.info.family == "brute" || !method.build) continue;
    const Knobs& knobs = method.info.build_knobs.front();
    const auto cells = method.build({.points = points, .finite = false}, knobs)->slice(axis, offset);
    if (cells.empty()) continue;
    save(folder, "knn_" + dataset + "_" + method.info.name, slice_svg(points, cells, box, axis, offset),
         {{"title", method.info.name + ": " + std::to_string(cells.size()) + " cells cut at " + plane},
          {"caption", slice_caption(cells, knobs)},
          {"dataset", dataset},
          {"method", method.info.name},
          {"kind", "slice"}});
  }
}

}  // namespace treeline::bench::knn
