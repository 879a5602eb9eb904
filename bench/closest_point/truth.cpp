#include "bench/closest_point/truth.hpp"

#include <algorithm>
#include <array>

#include "accel/batch.hpp"
#include "geometry/exact/triangle_distance.hpp"

namespace treeline::bench::closest_point {
namespace {

using accel::Id;
using geometry::Mesh3f;
using geometry::Triangle3d;
using geometry::Vec3d;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A run of triangles' boxes, small enough to stay in the first caches over many queries.
struct Tile {
  static constexpr std::size_t capacity = 128;
  std::array<std::array<float, capacity>, 3> low, high;
  geometry::Box3d whole;  // holds those of finite triangles
  std::size_t size = 0;

  void load(const Mesh3f& mesh, std::size_t first) {
    size = std::min(capacity, mesh.size() - first);
    whole = {};
    for (std::size_t i = 0; i < size; ++i) {
      const geometry::Triangle3f t = mesh.triangle(first + i);
      const bool finite = geometry::is_finite(t);
      const auto box = t.box();
      if (finite) whole.grow(Vec3d(box.low)), whole.grow(Vec3d(box.high));
      for (int k = 0; k < 3; ++k) {  // what is not finite is infinitely far
        low[static_cast<std::size_t>(k)][i] = finite ? box.low[k] : std::numeric_limits<float>::infinity();
        high[static_cast<std::size_t>(k)][i] = finite ? box.high[k] : std::numeric_limits<float>::infinity();
      }
    }
  }
};

/// distance2[i] to box i, off by a few roundings.
void measure(const Tile& tile, const Vec3d& q, std::array<double, Tile::capacity>& distance2) {
  const double x = q[0], y = q[1], z = q[2];
  const auto larger = [](double a, double b) { return a > b ? a : b; };
  for (std::size_t i = 0; i < tile.size; ++i) {
    const double dx = larger(larger(double(tile.low[0][i]) - x, x - double(tile.high[0][i])), 0.0);
    const double dy = larger(larger(double(tile.low[1][i]) - y, y - double(tile.high[1][i])), 0.0);
    const double dz = larger(larger(double(tile.low[2][i]) - z, z - double(tile.high[2][i])), 0.0);
    distance2[i] = dx * dx + dy * dy + dz * dz;
  }
}

/// To the box of them all: at most what measure() says of any of them, but for roundings.
double distance2_to_all(const Tile& tile, const Vec3d& q) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double d = std::max({tile.whole.low[k] - q[k], q[k] - tile.whole.high[k], 0.0});
    sum += d * d;
  }
  return sum;
}

/// One query's search: those that may be nearest, and how far the nearest is at most.
class Search {
 public:
  explicit Search(const Vec3d& query) : query_(query) {}

  void try_face(const Mesh3f& mesh, Id face) {
    const Triangle3d t(mesh.triangle(face));
    const auto bracket = geometry::distance_bracket(query_, t);
    if (bracket.low > high_) return;
    if (bracket.high < high_) {
      high_ = bracket.high;
      // Far more than the roundings of a distance to a box.
      limit2_ = high_ < 1e150 ? high_ * high_ * (1 + 1e-9) + 1e-300 : infinity;
    }
    candidates_.push_back({bracket.low, face});
  }
  bool may_win(double box_distance2) const { return box_distance2 <= limit2_; }

  TrueClosest nearest(const Mesh3f& mesh) const {
    TrueClosest best;
    for (const Candidate& c : candidates_) {
      if (c.low > high_) continue;
      const geometry::Triangle3f t = mesh.triangle(c.face);
      if (best && t == mesh.triangle(best.primitive)) {  // one of a pile of copies
        best.primitive = std::min(best.primitive, c.face);
        continue;
      }
      const double distance2 = geometry::exact_distance2(query_, Triangle3d(t));
      if (distance2 < best.distance2 || (distance2 == best.distance2 && c.face < best.primitive))
        best = {distance2, c.face};
    }
    return best;
  }

 private:
  struct Candidate {
    double low;
    Id face;
  };

  Vec3d query_;
  double high_ = infinity, limit2_ = infinity;
  std::vector<Candidate> candidates_;
};

void closest_of(const Mesh3f& mesh, std::span<const geometry::Vec3f> queries, std::span<TrueClosest> out) {
  std::vector<Search> searches;
  for (const auto& q : queries) searches.emplace_back(Vec3d(q));
  constexpr std::size_t stride = 64;  // between the triangles of the sample
  for (std::size_t f = 0; f < mesh.size(); f += stride) {
    if (!geometry::is_finite(mesh.triangle(f))) continue;
    for (std::size_t i = 0; i < queries.size(); ++i)
      if (geometry::is_finite(queries[i])) searches[i].try_face(mesh, static_cast<Id>(f));
  }
  Tile tile;
  std::array<double, Tile::capacity> distance2;
  for (std::size_t first = 0; first < mesh.size(); first += Tile::capacity) {
    tile.load(mesh, first);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (!geometry::is_finite(queries[i])) continue;
      if (!searches[i].may_win(distance2_to_all(tile, Vec3d(queries[i])))) continue;
      measure(tile, Vec3d(queries[i]), distance2);
      for (std::size_t k = 0; k < tile.size; ++k)
        if (searches[i].may_win(distance2[k]) && tile.low[0][k] < std::numeric_limits<float>::infinity())
          searches[i].try_face(mesh, static_cast<Id>(first + k));
    }
  }
  for (std::size_t i = 0; i < queries.size(); ++i) out[i] = searches[i].nearest(mesh);
}

}  // namespace

std::vector<TrueClosest> true_closest(const Mesh3f& mesh, std::span<const geometry::Vec3f> queries,
                                      int threads) {
  std::vector<TrueClosest> out(queries.size());
  accel::parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
    closest_of(mesh, queries.subspan(begin, end - begin), std::span(out).subspan(begin, end - begin));
  });
  return out;
}

}  // namespace treeline::bench::closest_point
