// BspTree of a solid: points, views and rays.
//
// A point goes down to its leaf, down both sides of a plane that it lies in: what it meets, inside, outside
// or both, is where it is. Painter's order takes the far side of each plane first (Fuchs, Kedem and Naylor
// 1980); a ray the near one, with a slack in doubtful cases, and tests the faces of the planes it crosses.
// All walk with stacks of their own.
#pragma once

#include "accel/batch.hpp"
#include "accel/bsp_solid/parts.hpp"
#include "accel/ray_checks.hpp"
#include "geometry/intersect_triangle.hpp"
#include "geometry/ray.hpp"

namespace treeline::accel {

/// What a solid's tree is built over, and its arithmetic: solid::ExactSpace, or solid::RoundedSpace<T> to see
/// why.
template <class Space = solid::ExactSpace>
struct Solid {};

enum class Location { inside, outside, on };

struct SolidStats {
  std::size_t faces = 0;       ///< of the source that have an area
  std::size_t flat_faces = 0;  ///< left out
  std::size_t moved = 0;       ///< vertices that were not on the grid
  std::size_t fragments = 0;   ///< pieces in the tree
  std::size_t nodes = 0, leaves = 0, inside_leaves = 0, depth = 0;
  std::size_t contradictions = 0;     ///< leaves whose faces disagree; the exact build refuses them
  std::uint64_t whole = 0, wide = 0;  ///< signs decided in 128 and in 256 bits
};

template <class Space>
class BspTree<Solid<Space>> {
  using Pieces = solid::Pieces<Space>;
  using Node = solid::Node;

 public:
  using Vec3d = geometry::Vec3d;
  using Point = Vec3d;
  using Piece = solid::Piece;

  /// Throws NotASolid for a mesh that is not closed or not oriented, for one that is inside out (its volume
  /// is negative) or has a part that is, for one whose faces run through each other, and for parts in one
  /// another that face the same way; InvalidInput for any other that it cannot take: not finite, empty.
  /// Vertices that no face names do not matter. See build.hpp for what escapes.
  template <class T>
  explicit BspTree(const geometry::Mesh<T>& mesh, const SolidOptions& options = {});
  /// Of convex polygons that bound a solid: piece i has face = i and is called names[i].
  BspTree(Pieces&& polygons, std::vector<Piece> source, std::vector<Id> names, const SolidOptions& options);

  Location locate(const Vec3d& point) const;
  bool contains(const Vec3d& point) const { return locate(point) != Location::outside; }
  void contains(std::span<const Vec3d> points, std::span<std::uint8_t> out, int threads) const {
    if (points.size() != out.size()) throw InvalidInput("solid: as many answers as points are needed");
    parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) out[i] = contains(points[i]) ? 1 : 0;
    });
  }

  /// Calls paint(face, corners) for every piece, far ones first: none hides one that comes later. Throws
  /// InvalidInput for an eye that is not finite.
  template <class Paint>
  void paint(const Vec3d& eye, const Paint& paint) const;

  /// The nearest hit of a ray; ties: any. Hits are found in double. Throws InvalidInput as all trees do for a
  /// ray that is none.
  Hit<double> closest_hit(const geometry::Rayd& ray) const;

  /// Zero where a double cannot hold it, of extents below some 1e-108.
  double volume() const;
  const SolidStats& stats() const { return stats_; }
  const SolidGrid& grid() const { return pieces_.space.grid; }
  std::size_t size() const { return source_.size(); }

  // What merging needs.
  const Pieces& pieces() const { return pieces_; }
  const std::vector<Piece>& source() const { return source_; }
  const std::vector<Id>& names() const { return names_; }
  const std::vector<Node>& nodes() const { return tree_.nodes; }
  std::uint32_t root() const { return tree_.root; }

 private:
  void build(const SolidOptions& options);
  /// Of the tetrahedron that whole numbers span with the origin.
  static solid::Int128 six_volumes(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    std::int64_t x[3], p[3], q[3];
    for (int k = 0; k < 3; ++k)
      x[k] = std::int64_t(a[k]), p[k] = std::int64_t(b[k] - a[k]), q[k] = std::int64_t(c[k] - a[k]);
    solid::Int128 sum = 0;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      sum += solid::Int128(x[k]) * (p[i] * q[j] - p[j] * q[i]);
    }
    return sum;
  }
  /// Of the polygons, by the divergence theorem: exactly where their corners are vertices, else from corners
  /// rounded to double.
  long double volume_in_steps() const;
  Vec3d position(const typename Space::Corner& c) const { return grid().position(Vec3d(c.at)); }
  void hit_face(const Piece& face, const geometry::Watertight::Prepared<double>& test,
                const geometry::Rayd& ray, Hit<double>& best) const;

  Pieces pieces_;
  std::vector<Piece> source_;
  std::vector<Id> names_;  // the faces of the mesh that they are
  solid::SolidTree tree_;
  SolidStats stats_;
};

static_assert(VolumeIndex<BspTree<Solid<>>>);

// ---- build ---------------------------------------------------------------------------------------------

namespace solid {
template <class T>
SolidGrid grid_of(const geometry::Mesh<T>& mesh, const SolidOptions& options) {
  check(options);
  geometry::Box<double, 3> box;
  for (std::size_t f = 0; f < mesh.size(); ++f)
    for (const std::uint32_t corner : mesh.faces[f]) {
      if (corner >= mesh.vertices.size())
        throw InvalidInput("solid: face " + std::to_string(f) + " names vertex " + std::to_string(corner) +
                           " of " + std::to_string(mesh.vertices.size()));
      if (!is_finite(mesh.vertices[corner]))
        throw InvalidInput("solid: vertex " + std::to_string(corner) + " is not finite");
      box.grow(geometry::Vec3d(mesh.vertices[corner]));
    }
  if (mesh.faces.empty()) throw InvalidInput("solid: the mesh has no faces");
  return options.grid.spacing > 0 ? options.grid : SolidGrid::over(box);
}
}  // namespace solid

template <class Space>
template <class T>
BspTree<Solid<Space>>::BspTree(const geometry::Mesh<T>& mesh, const SolidOptions& options)
    : pieces_(solid::grid_of(mesh, options)) {
  const geometry::Adjacency adjacency(mesh);
  const auto refuse = [](std::size_t n, const char* what) {
    if (n > 0) throw NotASolid("solid: the mesh is not the boundary of a solid: " + std::to_string(n) + what);
  };
  refuse(adjacency.boundary_edges(), " edges have one face only");
  refuse(adjacency.misoriented_edges(), " edges have faces that run the same way");
  refuse(adjacency.closed() ? 0 : 1, " or more edges have an odd number of faces");
  std::vector<typename Space::Corner> vertices(mesh.vertices.size());
  std::vector<bool> named(mesh.vertices.size());
  for (const auto& face : mesh.faces)
    for (const std::uint32_t i : face) {
      if (named[i]) continue;
      named[i] = true, vertices[i] = pieces_.space.vertex(Vec3d(mesh.vertices[i]));
      if (!Space::is_in_reach(vertices[i]))
        throw InvalidInput("solid: vertex " + std::to_string(i) + " is beyond the grid's reach");
      stats_.moved += position(vertices[i]) != Vec3d(mesh.vertices[i]);
    }
  std::vector<solid::PlaneId> plane_of(mesh.size(), solid::no_plane);
  for (Id f = 0; f < mesh.size(); ++f) {
    const auto& v = mesh.faces[f];
    const auto facing = pieces_.space.plane_through(vertices[v[0]], vertices[v[1]], vertices[v[2]]);
    plane_of[f] = facing.plane;
    if (facing.plane == solid::no_plane) {
      ++stats_.flat_faces;
      continue;
    }
    source_.push_back({facing.plane, static_cast<Id>(source_.size()),
                       static_cast<std::uint32_t>(pieces_.corners.size()), 3, facing.flip});
    names_.push_back(f);
    for (const auto i : v) pieces_.corners.push_back(vertices[i]);
  }
  if constexpr (Space::is_exact)
    for (const Piece& p : source_)
      for (int i = 0; i < 3; ++i) {
        const auto across = adjacency.neighbour(names_[p.face], i);
        if (across != geometry::Adjacency::none)
          pieces_.corners[p.first + static_cast<std::uint32_t>(i)].twin = plane_of[across];
      }
  if (const long double v = volume_in_steps(); !(v > 0))
    throw NotASolid(std::string("solid: the mesh ") + (v < 0 ? "is inside out" : "has no volume"));
  build(options);
  if constexpr (Space::is_exact)
    if (!options.may_cross_itself) solid::PartsCheck(pieces_, source_, names_)(tree_.pieces, adjacency);
}

template <class Space>
BspTree<Solid<Space>>::BspTree(Pieces&& polygons, std::vector<Piece> source, std::vector<Id> names,
                               const SolidOptions& options)
    : pieces_(std::move(polygons)), source_(std::move(source)), names_(std::move(names)) {
  build(options);
}

template <class Space>
void BspTree<Solid<Space>>::build(const SolidOptions& options) {
  if constexpr (!Space::is_exact)
    pieces_.space.epsilon = static_cast<decltype(pieces_.space.epsilon)>(options.epsilon * SolidGrid::reach);
  tree_ = solid::SolidBuilder<Space>(pieces_, names_, options)(source_);
  stats_.faces = source_.size();
  stats_.fragments = tree_.pieces.size();
  stats_.nodes = tree_.nodes.size();
  stats_.leaves = tree_.leaves;
  stats_.inside_leaves = tree_.inside_leaves;
  stats_.depth = tree_.depth;
  stats_.contradictions = tree_.contradictions;
  if constexpr (Space::is_exact) stats_.whole = pieces_.space.whole, stats_.wide = pieces_.space.wide;
}

// ---- queries -------------------------------------------------------------------------------------------

template <class Space>
Location BspTree<Solid<Space>>::locate(const Vec3d& point) const {
  if (!is_finite(point)) throw InvalidInput("solid: a point is not finite");
  const Vec3d steps = grid().steps(point);
  std::vector<std::uint32_t> waiting;
  bool in = false, out = false;
  std::uint32_t at = tree_.root;
  for (;;) {
    while (!Node::is_leaf(at)) {
      const Node& node = tree_.nodes[at];
      const int s = pieces_.space.side(node.plane, steps, point);
      if (s == 0) waiting.push_back(node.child[0]);
      at = node.child[s >= 0];
    }
    (at == Node::inside ? in : out) = true;
    if (waiting.empty() || (in && out)) break;
    at = waiting.back(), waiting.pop_back();
  }
  return in && out ? Location::on : in ? Location::inside : Location::outside;
}

template <class Space>
template <class Paint>
void BspTree<Solid<Space>>::paint(const Vec3d& eye, const Paint& paint) const {
  if (!is_finite(eye)) throw InvalidInput("solid: the eye is not finite");
  struct Waiting {
    std::uint32_t node;
    bool far_side_done;
  };
  const Vec3d steps = grid().steps(eye);
  std::vector<Waiting> waiting{{tree_.root, false}};
  std::vector<Vec3d> outline;
  while (!waiting.empty()) {
    const auto [at, far_side_done] = waiting.back();
    waiting.pop_back();
    if (Node::is_leaf(at)) continue;
    const Node& node = tree_.nodes[at];
    const int near = pieces_.space.side(node.plane, steps, eye) >= 0;
    if (!far_side_done) {
      waiting.push_back({at, true}), waiting.push_back({node.child[1 - near], false});
      continue;
    }
    for (std::uint32_t i = 0; i < node.count; ++i) {
      const Piece& p = tree_.pieces[node.first + i];
      outline.clear();
      for (const auto& c : pieces_.of(p)) outline.push_back(position(c));
      paint(names_[p.face], std::span<const Vec3d>(outline));
    }
    waiting.push_back({node.child[near], false});
  }
}

/// Whole faces are tested, not their pieces: pieces have rounded corners, and rays would slip between them.
template <class Space>
void BspTree<Solid<Space>>::hit_face(const Piece& face, const geometry::Watertight::Prepared<double>& test,
                                     const geometry::Rayd& ray, Hit<double>& best) const {
  const auto corners = pieces_.of(face);
  const Vec3d a = position(corners[0]);
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const geometry::Triangle3d t{a, position(corners[i - 1]), position(corners[i])};
    if (const auto hit = test(t, ray.t_min, std::min(ray.t_max, best.t)))
      if (hit->t < best.t) best = {hit->t, names_[face.face], hit->u, hit->v};
  }
}

template <class Space>
Hit<double> BspTree<Solid<Space>>::closest_hit(const geometry::Rayd& given) const {
  check_ray(given);
  // Of a direction of about 1 no product underflows; t is the given ray's times 2^exponent.
  const int exponent = std::ilogb(given.direction[largest_axis(given.direction)]);
  geometry::Rayd ray = given;
  for (int k = 0; k < 3; ++k) ray.direction[k] = std::scalbn(given.direction[k], -exponent);
  ray.t_min = std::scalbn(given.t_min, exponent), ray.t_max = std::scalbn(given.t_max, exponent);
  struct Waiting {
    std::uint32_t node;
    double t0, t1;
  };
  const geometry::Watertight::Prepared<double> test(ray);
  const Vec3d origin = grid().steps(ray.origin), direction = ray.direction / grid().spacing;
  const double size =
      std::max({std::abs(origin[0]), std::abs(origin[1]), std::abs(origin[2]), SolidGrid::reach});
  Hit<double> best;
  std::vector<Waiting> waiting{{tree_.root, ray.t_min, ray.t_max}};
  while (!waiting.empty()) {
    const auto [at, t0, t1] = waiting.back();
    waiting.pop_back();
    if (Node::is_leaf(at) || t0 > best.t) continue;
    const Node& node = tree_.nodes[at];
    const auto& plane = pieces_.space.planes[node.plane];
    const Vec3d normal(plane.rounded_normal);
    const double height = dot(normal, origin) - double(plane.rounded_offset), speed = dot(normal, direction);
    // How far the height may be off, generously: where the ray runs within it both sides are visited in full.
    const double slack = 64 * 0x1p-53 * 4 * length(normal) * size, t = -height / speed;
    const double width = std::abs(slack / speed) + 64 * 0x1p-53 * std::abs(t);
    const bool certain = std::isfinite(t) && std::isfinite(width);
    const std::uint32_t before = node.child[certain ? speed < 0 : height > 0],
                        after = node.child[certain ? speed > 0 : height <= 0];
    if (certain && t + width < t0) {
      waiting.push_back({after, t0, t1});
    } else if (certain && t - width > t1) {
      waiting.push_back({before, t0, t1});
    } else {
      for (std::uint32_t i = 0; i < node.count; ++i)
        hit_face(source_[tree_.pieces[node.first + i].face], test, ray, best);
      waiting.push_back({after, certain ? std::max(t0, t - width) : t0, t1});
      waiting.push_back({before, t0, certain ? std::min(t1, t + width) : t1});
    }
  }
  if (best) best.t = std::scalbn(best.t, -exponent);
  return best;
}

template <class Space>
long double BspTree<Solid<Space>>::volume_in_steps() const {
  solid::Int128 whole = 0;  // a term is below 2^80: differences have 26 bits
  long double sum = 0;
  for (const Piece& p : source_) {
    const auto c = pieces_.of(p);
    const Vec3d a(c[0].at);
    if constexpr (Space::is_exact)
      if (std::ranges::all_of(c, [](const auto& corner) { return corner.planes[0] == solid::no_plane; })) {
        for (std::size_t i = 2; i < c.size(); ++i)
          whole += six_volumes(a, Vec3d(c[i - 1].at), Vec3d(c[i].at));
        continue;
      }
    for (std::size_t i = 2; i < c.size(); ++i)
      sum += static_cast<long double>(dot(a, cross(Vec3d(c[i - 1].at) - a, Vec3d(c[i].at) - a)));
  }
  return (sum + static_cast<long double>(whole)) / 6;
}
template <class Space>
double BspTree<Solid<Space>>::volume() const {
  // Its powers leave the range of double before a volume does.
  const long double step = grid().spacing;
  return static_cast<double>(volume_in_steps() * step * step * step);
}

}  // namespace treeline::accel
