// The boundary of the space that a mesh keeps from a light: shadow volumes, before anybody looks at them.
//
// Sources: Crow 1977; extrusion to points at infinity after Everitt and Kilgard 2002; signed edges after Kim,
// Kim and Lim 2008. Method: a casting triangle, turned to face the light, is the front cap of a volume that
// widens away from it without end. Edges between casting triangles cancel by direction; what remains of an
// edge, with its sign and multiplicity, is extruded as a side. Of a closed part of the mesh the triangles
// that face the light cast, of any other part all do, so that open meshes and those where many faces meet at
// an edge have right volumes too. A point is in shadow if the volumes around it do not add up to 0. Cost:
// adjacency, O(n log n), and two caps a casting triangle; on finely divided bodies some 0.7 n^0.8 sides.
// Known weakness: one point of light, hard shadows. A closed part that is inside out casts from the faces
// that the light leaves it by, and is lit in front of those.
#pragma once

#include <numeric>

#include "geometry/adjacency.hpp"
#include "shading/shadow/light_view.hpp"

namespace treeline::shading::shadow {

/// Which triangles cast shadows.
enum class Casters {
  automatic,     ///< as said above
  light_facing,  ///< the textbook's: right for closed meshes alone
  all
};

struct VolumeOptions {
  Casters casters = Casters::automatic;
  bool front_caps = true, back_caps = true;
  double extrusion = INFINITY;  ///< how far sides reach from their edges, in world units, > 0
};

/// A point, or with w = 0 a direction: the point at infinity that it leads to.
struct Homogeneous {
  Vec3d at;
  double w = 1;
};

class VolumeBoundary {
 public:
  /// A flat, convex face, corner after corner so that cross(second - first, third - first) points out of the
  /// volume. It counts as many times as its multiplicity says.
  struct Face {
    std::array<std::uint32_t, 4> corners;  ///< of points()
    int size = 3, multiplicity = 1;
  };

  /// Area lights shine from their middle. Vertices at one place are one; triangles that are not finite, or
  /// name a vertex twice, cast nothing. Throws InvalidScene for a light that is none, an extrusion that is
  /// not positive, and a face that names no vertex.
  explicit VolumeBoundary(const Scene& scene, const VolumeOptions& options = {});

  const std::vector<Homogeneous>& points() const { return points_; }
  const std::vector<Face>& faces() const { return faces_; }
  std::size_t casters() const { return casters_; }
  /// Edges that were extruded, whatever their multiplicity.
  std::size_t silhouette_edges() const { return edges_; }
  std::size_t bytes() const { return points_.size() * sizeof(Homogeneous) + faces_.size() * sizeof(Face); }

 private:
  using Corners = geometry::Adjacency::Face;

  void weld(const geometry::Mesh3f& mesh);
  void turn(const Light& light, Casters which);
  std::vector<std::uint8_t> in_closed_parts(const geometry::Adjacency& adjacency) const;
  void extrude_points(const Light& light, double extrusion);
  std::uint32_t extruded(std::uint32_t v) const {
    return together_ ? vertex_count_ : vertex_count_ + v;  // all parallel ways lead to one point
  }

  std::vector<Homogeneous> points_;
  std::vector<Face> faces_;
  std::vector<Corners> triangles_;
  std::uint32_t vertex_count_ = 0;
  std::size_t casters_ = 0, edges_ = 0;
  bool together_ = false;
};

inline VolumeBoundary::VolumeBoundary(const Scene& scene, const VolumeOptions& options) {
  const Light& light = scene.light;
  const bool directional = light.kind == LightKind::directional;
  const Vec3d& place = directional ? light.direction : light.position;
  if (!is_finite(place) || (directional && !(length(place) > 0)))
    throw InvalidScene(directional ? "the light has no direction" : "the light's position is not finite");
  if (!(options.extrusion > 0)) throw InvalidScene("extrusion must be positive");
  for (std::size_t f = 0; f < scene.mesh.size(); ++f)
    for (const std::uint32_t v : scene.mesh.faces[f])
      if (v >= scene.mesh.vertices.size())
        throw InvalidScene("face " + std::to_string(f) + " names vertex " + std::to_string(v) + " of " +
                           std::to_string(scene.mesh.vertices.size()));
  weld(scene.mesh);
  turn(light, options.casters);
  const geometry::Adjacency adjacency(triangles_, vertex_count_);
  extrude_points(light, options.extrusion);
  casters_ = triangles_.size();
  for (const Corners& t : triangles_) {
    if (options.front_caps) faces_.push_back({{t[0], t[1], t[2], 0}});
    if (options.back_caps && !together_)
      faces_.push_back({{extruded(t[2]), extruded(t[1]), extruded(t[0]), 0}});
  }
  for (const auto& edge : adjacency.edges()) {
    int sum = 0;
    for (const std::uint32_t h : adjacency.half_edges_of(edge))
      sum += triangles_[geometry::Adjacency::face_of(h)][h % 3] == edge.vertices[0] ? 1 : -1;
    if (sum == 0) continue;
    ++edges_;
    auto [a, b] = edge.vertices;
    if (sum < 0) std::swap(a, b);
    // Seen from outside, a side runs against the caps at its edges.
    faces_.push_back({{b, a, extruded(a), extruded(b)}, together_ ? 3 : 4, std::abs(sum)});
  }
  triangles_ = {};
}

inline void VolumeBoundary::weld(const geometry::Mesh3f& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size()), to(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto finite = [&](std::uint32_t v) { return is_finite(mesh.vertices[v]); };
  order.erase(std::remove_if(order.begin(), order.end(), [&](std::uint32_t v) { return !finite(v); }),
              order.end());
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const auto &p = mesh.vertices[i], &q = mesh.vertices[j];
    return std::lexicographical_compare(p.v, p.v + 3, q.v, q.v + 3);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || !(mesh.vertices[order[i]] == mesh.vertices[order[i - 1]]))
      points_.push_back({Vec3d(mesh.vertices[order[i]])});
    to[order[i]] = static_cast<std::uint32_t>(points_.size() - 1);
  }
  vertex_count_ = static_cast<std::uint32_t>(points_.size());
  for (const auto& f : mesh.faces) {
    if (!finite(f[0]) || !finite(f[1]) || !finite(f[2])) continue;
    const Corners t{to[f[0]], to[f[1]], to[f[2]]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles_.push_back(t);
  }
}

/// Keeps the triangles that cast, each so that it faces the light. One that is seen edge-on may go either
/// way: the boundary is closed all the same.
inline void VolumeBoundary::turn(const Light& light, Casters which) {
  std::vector<std::uint8_t> closed;
  if (which == Casters::automatic)
    closed = in_closed_parts(geometry::Adjacency(triangles_, vertex_count_));
  else
    closed.assign(triangles_.size(), which == Casters::light_facing);
  std::vector<Corners> kept;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    Corners t = triangles_[i];
    const Vec3d a = points_[t[0]].at, normal = cross(points_[t[1]].at - a, points_[t[2]].at - a);
    const Vec3d to_light = light.kind == LightKind::directional ? -light.direction : light.position - a;
    const bool faces = dot(normal, to_light) > 0;
    if (!faces && closed[i]) continue;
    if (!faces) std::swap(t[1], t[2]);
    kept.push_back(t);
  }
  triangles_ = std::move(kept);
}

/// A part is what hangs together by edges; closed, where as many faces run one way as the other at each.
inline std::vector<std::uint8_t> VolumeBoundary::in_closed_parts(const geometry::Adjacency& adjacency) const {
  std::vector<std::uint32_t> parent(triangles_.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::vector<std::uint32_t> open_at;
  for (const auto& edge : adjacency.edges()) {
    int sum = 0;
    const auto half_edges = adjacency.half_edges_of(edge);
    const std::uint32_t first = geometry::Adjacency::face_of(half_edges[0]);
    for (const std::uint32_t h : half_edges) {
      const std::uint32_t f = geometry::Adjacency::face_of(h);
      sum += triangles_[f][h % 3] == edge.vertices[0] ? 1 : -1;
      parent[root(f)] = root(first);
    }
    if (sum != 0) open_at.push_back(first);
  }
  std::vector<std::uint8_t> closed(triangles_.size(), 1);
  for (const std::uint32_t f : open_at) closed[root(f)] = 0;
  for (std::uint32_t f = 0; f < closed.size(); ++f) closed[f] = closed[root(f)];
  return closed;
}

inline void VolumeBoundary::extrude_points(const Light& light, double extrusion) {
  const bool directional = light.kind == LightKind::directional, endless = std::isinf(extrusion);
  together_ = directional && endless;
  if (together_) return points_.push_back({normalized(light.direction), 0});
  for (std::uint32_t v = 0; v < vertex_count_; ++v) {
    const Vec3d p = points_[v].at, way = directional ? light.direction : p - light.position;
    if (endless)
      points_.push_back({way, 0});
    else  // a vertex at the light has no way to go
      points_.push_back({length(way) > 0 ? p + normalized(way) * extrusion : p});
  }
}

}  // namespace treeline::shading::shadow
