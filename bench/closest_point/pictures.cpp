#include "bench/closest_point/pictures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "accel/bvh.hpp"
#include "bench/closest_point/judge.hpp"
#include "bench/closest_point/queries.hpp"
#include "bench/ray/album.hpp"
#include "bench/ray/work_picture.hpp"

namespace treeline::bench::closest_point {
namespace {

using geometry::Vec3d;
using geometry::Vec3f;
using shading::Image;

constexpr int side = 96;        // queries
constexpr int zoom = 3;         // pixels a query, each way: trees that lose their way take 0.1 ms for one
constexpr double margin = 0.1;  // of the box's extent, on each side
constexpr int columns = 4;      // of panels
constexpr int samples = 64;     // pixels whose truth brute force must confirm
constexpr double off = 1e-6;    // of the diagonal
constexpr std::array<float, 3> astray{1.0f, 0.0f, 0.9f};

/// A slice square to the shortest side of the box, which shows most of the mesh.
Queries slice_of(const geometry::Box3d& box) {
  const Vec3d extent = box.extent();
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (extent[k] < extent[axis]) axis = k;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double half = (0.5 + margin) * std::max(extent[u], extent[v]);
  std::vector<Vec3f> points;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      Vec3d p = box.centre();
      p[u] += half * ((2 * x + 1.0) / side - 1), p[v] -= half * ((2 * y + 1.0) / side - 1);
      points.push_back(Vec3f(p));
    }
  return Queries(std::move(points));
}

/// By a tree over doubles, which must agree with brute force on a sample of pixels.
std::vector<TrueClosest> truth_of(const geometry::Mesh3f& mesh, const Queries& queries, int threads,
                                  double diagonal) {
  std::vector<geometry::Triangle3d> triangles;
  for (std::size_t f = 0; f < mesh.size(); ++f) triangles.emplace_back(mesh.triangle(f));
  using Tree = accel::Bvh<accel::Triangles<double>>;
  Tree::Options options;
  options.non_finite = accel::NonFinite::drop;
  const Tree tree(triangles, options);
  std::vector<accel::ClosestPoint<double>> found(queries.size());
  tree.closest_point(queries.doubles, std::numeric_limits<double>::infinity(), found, threads);
  std::vector<TrueClosest> truth;
  for (const auto& f : found) truth.push_back({f.distance2, f.primitive});
  std::vector<Vec3f> sample;
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < samples; ++i) {
    pixels.push_back((2 * i + 1) * queries.size() / (2 * samples));
    sample.push_back(queries.floats[pixels.back()]);
  }
  const auto witness = true_closest(mesh, sample, threads);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (std::abs(std::sqrt(truth[pixels[i]].distance2) - std::sqrt(witness[i].distance2)) > 1e-9 * diagonal)
      throw std::logic_error(
          fmt::format("the picture's truth disagrees with brute force at pixel {}", pixels[i]));
  return truth;
}

Image zoomed(const Image& image) {
  Image out(zoom * image.width, zoom * image.height, 3);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      std::copy_n(image.values.begin() + 3 * (std::ptrdiff_t{y / zoom} * image.width + x / zoom), 3,
                  out.values.begin() + 3 * (std::ptrdiff_t{y} * out.width + x));
  return out;
}

/// Dark where the mesh is near; bright, where the answer is off.
Image disagreement(const geometry::Mesh3f& mesh, const Queries& queries,
                   const std::vector<TrueClosest>& truth, const Answers& answers, std::size_t& count) {
  const Judge judge(mesh);
  Image image(side, side, 3);
  for (std::size_t p = 0; p < queries.size(); ++p) {
    const double near = std::sqrt(truth[p].distance2) / judge.diagonal();
    const auto grey = static_cast<float>(0.15 + 0.75 * std::min(1.0, 3 * near));
    const bool wrong =
        judge(queries.floats[p], truth[p], answers[p], {Claim::approximate, 0, true}).error > off;
    count += wrong;
    for (std::size_t c = 0; c < 3; ++c) image.values[3 * p + c] = wrong ? astray[c] : grey;
  }
  return image;
}

}  // namespace

void draw_pictures(const std::vector<Method>& methods, const std::string& dataset,
                   const geometry::Mesh3f& mesh, int threads, const std::string& folder) {
  ray::Album album("closest_point", dataset, folder);
  const geometry::Box3d box = box_of(mesh);
  const Queries queries = slice_of(box);
  const double diagonal = geometry::length(box.extent());
  const std::vector<TrueClosest> truth = truth_of(mesh, queries, threads, diagonal);
  std::vector<std::vector<accel::Work>> work;
  std::vector<std::string> trees;
  for (const Method& method : methods) {
    const MethodInfo& info = method.info;
    if (!method.names_triangles || mesh.size() > std::min(info.largest_n, info.quick_largest_n)) continue;
    const auto index = method.build(mesh, info.build_knobs.front(), threads);
    if (info.source == Source::ours && method.roundoff > 1e-10)
      if (auto visited = index->work_of_each(queries); !visited.empty()) {
        work.push_back(std::move(visited));
        trees.push_back(info.name);
      }
    Answers answers;
    for (const Knobs& knobs : info.query_knobs) {
      index->closest(queries, answers, knobs, threads);
      std::size_t count = 0;
      const Image image = disagreement(mesh, queries, truth, answers, count);
      if (count == 0) continue;
      std::string name = info.name;
      for (const auto& [key, value] : knobs.items()) {
        name += '_';
        name += value.is_string() ? value.get<std::string>() : value.dump();
      }
      const double share = 100.0 * static_cast<double>(count) / static_cast<double>(queries.size());
      album.add(
          name, zoomed(image),
          {.title = fmt::format("A slice: magenta where the answer is off by more than 1e-6 of the diagonal, "
                                "{:.2g} % of the pixels; the darker, the nearer the mesh",
                                share),
           .caption = "",
           .method = name,
           .kind = "disagreement"});
    }
  }
  if (!work.empty()) {
    const double most = ray::common_scale(work);
    std::vector<Image> panels;
    for (const auto& panel : work) panels.push_back(zoomed(ray::heat_map(panel, side, side, most)));
    album.add(
        "work", ray::beside(panels, columns),
        {.title = fmt::format("A slice, a query a pixel: nodes and triangles visited, from none, black, to "
                              "{:.0f}, white",
                              most),
         .caption = "",
         .method = fmt::format("{}", fmt::join(trees, ", ")),
         .kind = "work",
         .columns = std::min(columns, static_cast<int>(panels.size())),
         .panels = trees});
  }
}

}  // namespace treeline::bench::closest_point
