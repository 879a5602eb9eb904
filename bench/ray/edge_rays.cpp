#include "bench/ray/edge_rays.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>

#include "geometry/random.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::ray {
namespace {

using accel::Id;
using geometry::Mesh3f;
using geometry::Rayf;
using geometry::Triangle3d;
using geometry::Vec3d;
using geometry::Vec3f;

constexpr int draws = 16;               // targets tried for one ray
constexpr int points_of_edge = 8;       // of which the nearest one is taken
constexpr std::size_t most_faces = 64;  // around a vertex; beyond, it is passed over

/// Cosine to a face's normal below which a ray counts as grazing it: there t slides, another weakness than
/// leaks.
constexpr double grazing = 0.1;

/// How far the faces at an edge must reach to either side of it, in units of the largest coordinate: twice
/// what the judge moves rays by (judge.hpp).
constexpr double clearance = 64 * geometry::tolerance::unit_roundoff<float>;

/// The faces around each vertex, vertices at equal positions being one. Faces without an area and those that
/// are not finite are left out.
class Fans {
 public:
  using Corners = std::array<std::uint32_t, 3>;

  explicit Fans(const Mesh3f& mesh) : mesh_(mesh), vertex_(mesh.vertices.size()) {
    weld();
    first_.assign(mesh.vertices.size() + 1, 0);
    each_corner([&](std::uint32_t vertex, Id) { ++first_[vertex + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    faces_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    each_corner([&](std::uint32_t vertex, Id face) { faces_[next[vertex]++] = face; });
  }

  Corners corners(Id face) const {
    const auto& f = mesh_.faces[face];
    return {vertex_[f[0]], vertex_[f[1]], vertex_[f[2]]};
  }
  std::span<const Id> around(std::uint32_t vertex) const {
    return std::span(faces_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }
  /// A face that is usable, each as likely as the others; there must be one.
  Id draw(geometry::Pcg32& random) const {
    return faces_[random.below(static_cast<std::uint32_t>(faces_.size()))];
  }
  bool empty() const { return faces_.empty(); }
  Vec3d position(std::uint32_t vertex) const { return Vec3d(mesh_.vertices[vertex]); }

 private:
  bool usable(Id face) const {
    const Triangle3d t(mesh_.triangle(face));
    return geometry::is_finite(t) && geometry::length2(t.area_normal()) > 0;
  }
  void weld() {
    std::vector<std::uint32_t> order(vertex_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::iota(vertex_.begin(), vertex_.end(), 0u);
    std::erase_if(order, [&](std::uint32_t v) { return !geometry::is_finite(mesh_.vertices[v]); });
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      const Vec3f &p = mesh_.vertices[a], &q = mesh_.vertices[b];
      for (int axis = 0; axis < 3; ++axis)
        if (p[axis] != q[axis]) return p[axis] < q[axis];
      return a < b;
    };
    std::sort(order.begin(), order.end(), before);
    for (std::size_t i = 1; i < order.size(); ++i)
      if (mesh_.vertices[order[i]] == mesh_.vertices[order[i - 1]]) vertex_[order[i]] = vertex_[order[i - 1]];
  }
  template <class F>
  void each_corner(F f) const {
    for (Id face = 0; face < mesh_.size(); ++face)
      if (usable(face))
        for (const std::uint32_t vertex : corners(face)) f(vertex, face);
  }

  const Mesh3f& mesh_;
  std::vector<std::uint32_t> vertex_;  // that stands for each
  std::vector<std::uint32_t> first_;   // of faces_, by vertex
  std::vector<Id> faces_;
};

/// A vertex, or an edge between two.
struct Target {
  std::uint32_t from, to;  // equal: a vertex
  bool is_vertex() const { return from == to; }
  bool touches(const Fans::Corners& c) const {
    return std::ranges::count(c, from) && std::ranges::count(c, to);
  }
};

double largest(const Vec3d& p) { return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}); }

/// Do faces lie on both sides of an edge, as seen from the origin?
bool covers_edge(const Fans& fans, const Target& edge, const Vec3d& origin) {
  const Vec3d p = fans.position(edge.from), q = fans.position(edge.to);
  const Vec3d normal = geometry::cross(p - origin, q - origin);
  const double scale = std::max({largest(origin), largest(p), largest(q)});
  bool left = false, right = false;
  for (const Id face : fans.around(edge.from)) {
    const Fans::Corners c = fans.corners(face);
    if (!edge.touches(c)) continue;
    for (const std::uint32_t vertex : c) {
      if (vertex == edge.from || vertex == edge.to) continue;
      const Vec3d corner = fans.position(vertex);
      const double side = geometry::dot(normal, corner - origin);
      const double clear = clearance * std::max(scale, largest(corner)) * geometry::length(normal);
      left = left || side > clear, right = right || side < -clear;
    }
  }
  return left && right;
}

/// Do faces surround the target, as seen from the origin?
bool covers(const Fans& fans, const Target& target, const Vec3d& origin) {
  const auto faces = fans.around(target.from);
  if (faces.size() > most_faces) return false;
  if (!target.is_vertex()) return covers_edge(fans, target, origin);
  for (const Id face : faces)
    for (const std::uint32_t vertex : fans.corners(face))
      if (vertex != target.from && !covers_edge(fans, {target.from, vertex}, origin)) return false;
  return true;
}

/// From the origin through a point of the target, at t = 1; a direction of no length if there is none.
Rayf aim(const Fans& fans, const Target& target, const Vec3f& origin, double where) {
  const Vec3d o(origin), p = fans.position(target.from), way = fans.position(target.to) - p;
  if (target.is_vertex()) return {origin, Vec3f(p - o)};
  const Vec3d normal = geometry::cross(p - o, way);
  Rayf best{origin, {}};
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < points_of_edge; ++i) {
    const Vec3f direction(p + way * (where + 0.01 * i) - o);
    const double off = std::abs(geometry::dot(normal, Vec3d(direction)));
    if (off < least) least = off, best.direction = direction;
  }
  return best;
}

bool usable(const Rayf& ray) {
  return geometry::is_finite(ray.origin) && geometry::is_finite(ray.direction) &&
         geometry::length2(Vec3d(ray.direction)) > 0;
}

enum class Rank { elsewhere, seen, covered };  // what the ray meets first: the target, and safely so

struct Choice {
  Rayf ray;
  Rank rank;
};

/// Does the ray meet the target first, and not at a grazing angle?
bool meets(const Mesh3f& mesh, const Fans& fans, const Target& target, const Rayf& ray,
           const accel::Hit<float>& hit) {
  if (!hit || !target.touches(fans.corners(hit.primitive))) return false;
  const Vec3d n = Triangle3d(mesh.triangle(hit.primitive)).area_normal(), d(ray.direction);
  return std::abs(geometry::dot(n, d)) > grazing * geometry::length(n) * geometry::length(d);
}

/// The eye, and above and below the target, some sizes off of the largest face there, the farthest first:
/// nearer by, the t of a face that is long and thin is in doubt.
std::vector<Vec3f> viewpoints(const Mesh3f& mesh, const Fans& fans, const Target& target, double where,
                              const Vec3d& eye) {
  double size = 0;
  Vec3d normals;
  for (const Id face : fans.around(target.from)) {
    if (!target.touches(fans.corners(face))) continue;
    const Triangle3d t(mesh.triangle(face));
    normals += geometry::normalized(t.area_normal());
    size = std::max(
        {size, geometry::length(t.b - t.a), geometry::length(t.c - t.b), geometry::length(t.a - t.c)});
  }
  std::vector<Vec3f> points{Vec3f(eye)};
  const double length = geometry::length(normals);
  if (!(length > 0)) return points;
  const Vec3d place = fans.position(target.from) * (1 - where) + fans.position(target.to) * where;
  for (const double sizes : {4.0, 1.0, 0.25})
    for (const double side : {1.0, -1.0})
      points.push_back(Vec3f(place + normals * (side * sizes * size / length)));
  return points;
}

}  // namespace

std::vector<Rayf> edge_rays(const Mesh3f& mesh, const FirstHit& first_hit, const Vec3d& eye,
                            std::size_t count, std::uint64_t seed) {
  const Fans fans(mesh);
  std::vector<Rayf> rays;
  if (fans.empty()) return rays;
  geometry::Pcg32 random(seed, 4);
  for (std::size_t i = 0; i < count; ++i) {
    std::optional<Choice> best;
    for (int draw = 0; draw < draws && !(best && best->rank == Rank::covered); ++draw) {
      const Fans::Corners c = fans.corners(fans.draw(random));
      const std::uint32_t side = random.below(3);
      const double where = random.uniform(0.1, 0.8);
      const Target target{c[side], i % 2 == 1 ? c[side] : c[(side + 1) % 3]};
      for (const Vec3f& origin : viewpoints(mesh, fans, target, where, eye)) {
        const Rayf ray = aim(fans, target, origin, where);
        if (!usable(ray)) continue;
        const Rank hoped = covers(fans, target, Vec3d(ray.origin)) ? Rank::covered : Rank::seen;
        if (best && best->rank >= hoped) continue;  // no need to look
        const Rank rank = meets(mesh, fans, target, ray, first_hit(ray)) ? hoped : Rank::elsewhere;
        if (!best || rank > best->rank) best = Choice{ray, rank};
        if (rank == Rank::covered) break;
      }
    }
    if (best) rays.push_back(best->ray);
  }
  return rays;
}

}  // namespace treeline::bench::ray
