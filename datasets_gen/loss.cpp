#include "datasets_gen/loss.hpp"

#include <fmt/format.h>

#include "accel/bvh/triangles.hpp"
#include "accel/self_intersections.hpp"

namespace treeline::datasets {
namespace {

using geometry::Mesh3f;

double area_of(const Mesh3f& mesh) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.size(); ++f)
    if (const geometry::Triangle3d t(mesh.triangle(f)); is_finite(t)) sum += t.area();
  return sum;
}

double volume_of(const geometry::MeshCheck& check) {
  return check.closed && check.oriented ? check.volume : std::numeric_limits<double>::quiet_NaN();
}

/// By how much, in per cent of what there was.
std::string change(double before, double after) {
  return before != 0 ? fmt::format("{:+.3g} %", 100 * (after - before) / before) : "none before";
}

}  // namespace

Loss loss(const Mesh3f& given, const Mesh3f& left, int threads) {
  const geometry::MeshCheck before = geometry::check_mesh(given, 0), after = geometry::check_mesh(left, 0);
  Loss r{.parts = before.components,
         .parts_left = after.components,
         .area = area_of(given),
         .area_left = area_of(left),
         .volume = volume_of(before),
         .volume_left = volume_of(after)};
  r.crossings = accel::self_intersections(left, after.sound_faces, {.kept = 0, .threads = threads}).count;
  std::vector<bool> used(given.vertices.size());
  for (const auto& face : given.faces)
    for (const std::uint32_t v : face) used[v] = true;
  std::vector<geometry::Vec3f> asked;
  geometry::Box3f box;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] && is_finite(given.vertices[v])) asked.push_back(given.vertices[v]), box.grow(asked.back());
  if (asked.empty()) return r;
  r.diagonal = length(geometry::Vec3d(box.high) - geometry::Vec3d(box.low));
  using Tree = accel::Bvh<accel::Triangles<float>>;
  typename Tree::Options options;
  options.non_finite = accel::NonFinite::drop;
  const Tree tree(left, options);
  std::vector<accel::ClosestPoint<float>> found(asked.size());
  tree.closest_point(asked, std::numeric_limits<float>::infinity(), found, threads);
  for (std::size_t i = 0; i < found.size(); ++i)
    r.farthest =
        std::max(r.farthest, found[i] ? length(geometry::Vec3d(asked[i]) - geometry::Vec3d(found[i].point))
                                      : std::numeric_limits<double>::infinity());
  return r;
}

std::string as_text(const Loss& loss) {
  std::string out =
      fmt::format("  vertices given lie up to {:.3g} off the faces left, {:.2g} % of the diagonal\n",
                  loss.farthest, loss.diagonal > 0 ? 100 * loss.farthest / loss.diagonal : 0.0);
  out += fmt::format("  area {:.6g}, {}\n", loss.area_left, change(loss.area, loss.area_left));
  if (std::isfinite(loss.volume) && std::isfinite(loss.volume_left))
    out += fmt::format("  volume {:.6g}, {}\n", loss.volume_left, change(loss.volume, loss.volume_left));
  else if (std::isfinite(loss.volume))
    out += "  no longer closed and oriented\n";
  if (loss.parts_left != loss.parts)
    out += fmt::format("  {} of {} parts that hang together by edges\n", loss.parts_left, loss.parts);
  if (loss.crossings > 0)
    out += fmt::format("  {} pairs of faces cross or overlap after the decimation\n", loss.crossings);
  return out;
}

}  // namespace treeline::datasets
