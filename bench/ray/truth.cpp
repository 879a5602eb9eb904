#include "bench/ray/truth.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <array>

#include "geometry/exact/ray_triangle.hpp"

namespace treeline::bench::ray {
namespace {

using accel::Id;
using geometry::Mesh3f;
using geometry::Rayd;
using geometry::Vec3d;
bool finite(const Rayd& r) {
  return geometry::is_finite(r.origin) && geometry::is_finite(r.direction) && !std::isnan(r.t_min) &&
         !std::isnan(r.t_max) && geometry::length2(r.direction) > 0;
}

/// Updates best if the ray hits the face nearer (or as near, with a lower id).
void try_face(const Mesh3f& mesh, Id face, const Rayd& ray, TrueHit& best) {
  const geometry::Triangle3f triangle = mesh.triangle(face);
  if (!geometry::is_finite(triangle)) return;
  const geometry::Triangle3d exact{Vec3d(triangle.a), Vec3d(triangle.b), Vec3d(triangle.c)};
  const auto t = geometry::exact_hit<double>(ray, exact);
  if (t && (*t < best.t || (*t == best.t && face < best.primitive))) best = {*t, face};
}

/// A run of triangles as nine arrays of doubles, small enough to stay in the first caches over many rays.
struct Tile {
  static constexpr std::size_t capacity = RunBoxes::run;
  std::array<std::array<double, capacity>, 9> x;
  std::size_t size = 0;

  void load(const Mesh3f& mesh, std::size_t first) {
    size = std::min(capacity, mesh.size() - first);
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t corner = 0; corner < 3; ++corner)
        for (int axis = 0; axis < 3; ++axis)
          x[3 * corner + axis][i] = mesh.vertices[mesh.faces[first + i][corner]][axis];
  }
};

/// Bound on the rounding of a triple product d·(p×q) in double: six terms of at most |d|·m², each rounded at
/// most ten times, counting the subtraction of the origin.
constexpr double triple_product_error = 64 * 0x1p-53;

/// maybe[i] = 0 where the edge signs of triangle i are certain and mixed. NaN stays a maybe.
void filter(const Tile& tile, const Rayd& ray, std::array<std::uint8_t, Tile::capacity>& maybe) {
  const double ox = ray.origin[0], oy = ray.origin[1], oz = ray.origin[2];
  const double dx = ray.direction[0], dy = ray.direction[1], dz = ray.direction[2];
  const double scale = triple_product_error * std::max({std::abs(dx), std::abs(dy), std::abs(dz)});
  const auto larger = [](double a, double b) { return a > b ? a : b; };
  const auto smaller = [](double a, double b) { return a < b ? a : b; };
  for (std::size_t i = 0; i < tile.size; ++i) {
    const double ax = tile.x[0][i] - ox, ay = tile.x[1][i] - oy, az = tile.x[2][i] - oz;
    const double bx = tile.x[3][i] - ox, by = tile.x[4][i] - oy, bz = tile.x[5][i] - oz;
    const double cx = tile.x[6][i] - ox, cy = tile.x[7][i] - oy, cz = tile.x[8][i] - oz;
    const double u = dx * (by * cz - bz * cy) + dy * (bz * cx - bx * cz) + dz * (bx * cy - by * cx);
    const double v = dx * (cy * az - cz * ay) + dy * (cz * ax - cx * az) + dz * (cx * ay - cy * ax);
    const double w = dx * (ay * bz - az * by) + dy * (az * bx - ax * bz) + dz * (ax * by - ay * bx);
    double m = larger(larger(std::abs(ax), std::abs(ay)), std::abs(az));
    m = larger(m, larger(larger(std::abs(bx), std::abs(by)), std::abs(bz)));
    m = larger(m, larger(larger(std::abs(cx), std::abs(cy)), std::abs(cz)));
    const double bound = scale * m * m;
    const double low = smaller(smaller(u, v), w), high = larger(larger(u, v), w);
    maybe[i] = !((low < -bound) & (high > bound));
  }
}

void closest_of(const Mesh3f& mesh, const RunBoxes& boxes, std::span<const geometry::Rayf> rays,
                std::span<TrueHit> out) {
  std::vector<Rayd> wide_rays;
  for (const auto& r : rays)
    wide_rays.push_back({Vec3d(r.origin), Vec3d(r.direction), double(r.t_min), double(r.t_max)});
  Tile tile;
  std::array<std::uint8_t, Tile::capacity> maybe;
  for (std::size_t run = 0; run < boxes.size(); ++run) {
    const std::size_t first = run * RunBoxes::run;
    tile.load(mesh, first);
    for (std::size_t r = 0; r < rays.size(); ++r) {
      if (!finite(wide_rays[r]) || !boxes.may_pass(run, wide_rays[r], 0)) continue;
      filter(tile, wide_rays[r], maybe);
      for (std::size_t i = 0; i < tile.size; ++i)
        if (maybe[i]) try_face(mesh, static_cast<Id>(first + i), wide_rays[r], out[r]);
    }
  }
}

/// Is the triangle surely farther than this from the ray's line? Seen along the ray, the line is a point:
/// then it is that far outside of one of the triangle's sides. What is seen edge-on is not sure.
bool surely_beside(const geometry::Triangle3f& triangle, const Rayd& ray, double distance) {
  const Vec3d& d = ray.direction;
  const Vec3d corners[3] = {Vec3d(triangle.a) - ray.origin, Vec3d(triangle.b) - ray.origin,
                            Vec3d(triangle.c) - ray.origin};
  double m = 0, sides[3], sum = 0;
  for (const Vec3d& p : corners) m = std::max({m, std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
  const double bound =
      triple_product_error * std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])}) * m * m;
  for (int i = 0; i < 3; ++i)
    sum += sides[i] = geometry::dot(d, geometry::cross(corners[(i + 1) % 3], corners[(i + 2) % 3]));
  if (!(std::abs(sum) > 3 * bound)) return false;
  for (int i = 0; i < 3; ++i) {
    const double length = geometry::length(geometry::cross(corners[(i + 2) % 3] - corners[(i + 1) % 3], d));
    if ((sum > 0 ? -sides[i] : sides[i]) > distance * length + 2 * bound) return true;
  }
  return false;
}

/// Does the line of the ray pass the box within a distance? A millionth of all that is subtracted, and of the
/// distance, swallows the rounding of this test.
bool passes_box(const geometry::Box3d& box, const Rayd& ray, double distance) {
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    const double largest = std::max({std::abs(box.low[axis]), std::abs(box.high[axis]), std::abs(o)});
    const double margin = distance + 1e-6 * (distance + largest);
    const double low = box.low[axis] - margin - o, high = box.high[axis] + margin - o;
    if (d == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const double x = low / d, y = high / d;
    enter = std::max(enter, std::min(x, y)), leave = std::min(leave, std::max(x, y));
  }
  return enter <= leave;
}

}  // namespace

RunBoxes::RunBoxes(const Mesh3f& mesh) : boxes_((mesh.size() + run - 1) / run) {
  for (std::size_t f = 0; f < mesh.size(); ++f)
    if (const auto triangle = mesh.triangle(f); geometry::is_finite(triangle))
      for (const auto& corner : {triangle.a, triangle.b, triangle.c}) boxes_[f / run].grow(Vec3d(corner));
}

bool RunBoxes::may_pass(std::size_t i, const Rayd& ray, double distance) const {
  return !boxes_[i].empty() && passes_box(boxes_[i], ray, distance);
}

TrueHit exact_closest(const Mesh3f& mesh, std::span<const Id> faces, const Rayd& ray) {
  TrueHit best;
  if (finite(ray))
    for (const Id face : faces) try_face(mesh, face, ray, best);
  return best;
}

std::vector<TrueHit> true_closest(const Mesh3f& mesh, std::span<const geometry::Rayf> rays, int threads) {
  std::vector<TrueHit> out(rays.size());
  const RunBoxes boxes(mesh);
  if (threads <= 1) {
    closest_of(mesh, boxes, rays, out);
    return out;
  }
  tbb::task_arena arena(threads);
  arena.execute([&] {
    const std::size_t grain =
        std::max<std::size_t>(16, rays.size() / (4 * static_cast<std::size_t>(threads)));
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, rays.size(), grain),
        [&](const auto& range) {
          closest_of(mesh, boxes, rays.subspan(range.begin(), range.size()),
                     std::span(out).subspan(range.begin(), range.size()));
        },
        tbb::simple_partitioner());
  });
  return out;
}

std::vector<Id> faces_near(const Mesh3f& mesh, const RunBoxes& boxes, const Rayd& ray, double distance) {
  std::vector<Id> near;
  if (!finite(ray)) return near;
  for (std::size_t run = 0; run < boxes.size(); ++run) {
    if (!boxes.may_pass(run, ray, distance)) continue;
    const std::size_t end = std::min((run + 1) * RunBoxes::run, mesh.size());
    for (std::size_t f = run * RunBoxes::run; f < end; ++f) {
      const geometry::Triangle3f triangle = mesh.triangle(f);
      if (!geometry::is_finite(triangle)) continue;
      const auto box = triangle.box();
      if (passes_box({Vec3d(box.low), Vec3d(box.high)}, ray, distance) &&
          !surely_beside(triangle, ray, distance * (1 + 1e-6)))
        near.push_back(static_cast<Id>(f));
    }
  }
  return near;
}

}  // namespace treeline::bench::ray
