// Indexed triangle meshes: corners shared by index. No claim of closedness; see adjacency.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/triangle.hpp"

namespace treeline::geometry {

template <class T>
struct Mesh {
  using Face = std::array<std::uint32_t, 3>;

  std::vector<Vec<T, 3>> vertices;
  std::vector<Face> faces;

  std::size_t size() const { return faces.size(); }
  Triangle<T> triangle(std::size_t i) const {
    const Face& f = faces[i];
    return {vertices[f[0]], vertices[f[1]], vertices[f[2]]};
  }
  Box<T, 3> box() const {
    Box<T, 3> b;
    for (const auto& p : vertices) b.grow(p);
    return b;
  }
};

using Mesh3f = Mesh<float>;
using Mesh3d = Mesh<double>;

/// The triangles of a mesh by value, in the order of its faces.
template <class T>
std::vector<Triangle<T>> triangles_of(const Mesh<T>& mesh) {
  std::vector<Triangle<T>> r(mesh.size());
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = mesh.triangle(i);
  return r;
}

}  // namespace treeline::geometry
