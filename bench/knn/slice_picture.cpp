#include "bench/knn/slice_picture.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "bench/knn/double_scan.hpp"

namespace treeline::bench::knn {
namespace {

constexpr double longer_side = 640;        // of the picture, in pixels
constexpr double near_plane = 0.005;       // points drawn: this share of the box's widest side from the plane
constexpr std::size_t most_points = 4000;  // drawn, evenly spread: more only make the file large
constexpr std::size_t most_cells = 20000;  // drawn: beyond, outlines are finer than a pixel

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", x);
  return text;
}

// From light to dark with depth: a single hue, readable without colour vision.
std::string colour(std::size_t depth, std::size_t shallowest, std::size_t deepest) {
  const double share = deepest > shallowest ? static_cast<double>(depth - shallowest) /
                                                  static_cast<double>(deepest - shallowest)
                                            : 0;
  const auto mix = [&](int light, int dark) {
    return std::to_string(static_cast<int>(light + share * (dark - light)));
  };
  return "rgb(" + mix(237, 33) + "," + mix(248, 102) + "," + mix(251, 172) + ")";
}

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
  std::string x(double value) const { return number((value - left) * scale); }
  std::string y(double value) const { return number((top - value) * scale); }
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

}  // namespace

std::string slice_svg(std::span<const Vec3f> points, const std::vector<accel::SliceCell>& cells,
                      const Box3f& box, int axis, double offset) {
  const Frame frame(box, axis);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-2 -2 " + number(frame.width + 4) +
                    " " + number(frame.height + 4) + "\">\n<g stroke=\"#444\" stroke-width=\"0.4\">\n";
  std::size_t shallowest = SIZE_MAX, deepest = 0;
  for (const auto& c : cells)
    shallowest = std::min(shallowest, c.depth), deepest = std::max(deepest, c.depth);
  for (std::size_t i = 0; i < std::min(cells.size(), most_cells); ++i) {
    svg += "<path fill=\"" + colour(cells[i].depth, shallowest, deepest) + "\" d=\"";
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

void write_slice_pictures(const std::vector<Method>& methods, std::span<const Vec3f> points,
                          const std::string& dataset, const std::string& folder) {
  const Box3f box = DoubleScan(points).box();
  if (box.empty()) throw std::runtime_error("nothing to draw: " + dataset + " has no finite point");
  std::filesystem::create_directories(folder);
  const std::filesystem::path index_path = std::filesystem::path(folder) / "pictures.jsonl";
  const int axis = shortest_axis(box);
  const double offset = box.centre()[axis];
  for (const Method& method : methods) {
    if (method.info.source != Source::ours || method.info.family == "brute") continue;
    const Knobs& knobs = method.info.build_knobs.front();
    const auto cells = method.build({.points = points, .finite = false}, knobs)->slice(axis, offset);
    if (cells.empty()) continue;
    const std::string file = file_name("knn_" + dataset + "_" + method.info.name);
    const std::filesystem::path path = std::filesystem::path(folder) / file;
    auto out = opened(path, std::ios::out);
    out << slice_svg(points, cells, box, axis, offset);
    if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
    Knobs entry = {{"file", file},
                   {"title", method.info.name + ": " + std::to_string(cells.size()) + " cells cut at " +
                                 "xyz"[axis] + " = " + number(offset)},
                   {"dataset", dataset},
                   {"method", method.info.name},
                   {"kind", "slice"}};
    auto index = opened(index_path, std::ios::app);
    index << entry.dump() << '\n';
    if (!index.flush()) throw std::runtime_error("cannot write " + index_path.string());
  }
}

}  // namespace treeline::bench::knn
