#include "datasets_gen/scenes/parts.hpp"

#include <algorithm>
#include <map>

#include "datasets_gen/meshes/geodesic.hpp"

namespace treeline::datasets {

void Parts::grid(std::size_t columns, std::size_t rows, const std::function<Vec3d(double, double)>& at) {
  const std::size_t first = mesh.vertices.size();
  for (std::size_t j = 0; j <= rows; ++j)
    for (std::size_t i = 0; i <= columns; ++i)
      mesh.vertices.push_back(rounded(at(double(i) / double(columns), double(j) / double(rows))));
  const auto index = [&](std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>(first + j * (columns + 1) + i);
  };
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      mesh.faces.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh.faces.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
}

void Parts::sheet(const Vec3d& corner, const Vec3d& u, const Vec3d& v, std::size_t faces) {
  // Cells as square as they can be.
  const double cells = std::max(1.0, 0.5 * double(faces));
  const double shape = std::sqrt(dot_portable(u, u) / dot_portable(v, v));
  const double columns = std::max(1.0, std::floor(std::sqrt(cells * shape) + 0.5));
  const double rows = std::max(1.0, std::floor(cells / columns + 0.5));
  grid(std::size_t(columns), std::size_t(rows),
       [&](double s, double t) { return sum(corner, sum(scaled(u, s), scaled(v, t))); });
}

void Parts::floor(double side, std::size_t faces, const Height& height) {
  const std::size_t cells = std::max<std::size_t>(1, std::size_t(std::sqrt(0.5 * double(faces)) + 0.5));
  grid(cells, cells, [&](double s, double t) {
    const double x = (t - 0.5) * side, z = (s - 0.5) * side;  // z before x: the normal is up
    return Vec3d{x, height ? height(x, z) : 0, z};
  });
}

void Parts::box(const Vec3d& low, const Vec3d& high, std::size_t cells) {
  std::map<std::array<std::size_t, 3>, std::uint32_t> placed;
  const auto vertex = [&](const std::array<std::size_t, 3>& at) {
    const auto [it, is_new] = placed.try_emplace(at, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) {
      Vec3d p;
      for (int k = 0; k < 3; ++k) {
        const double s = double(at[std::size_t(k)]) / double(cells);
        p[k] = low[k] * (1 - s) + high[k] * s;  // the corners themselves at 0 and 1
      }
      mesh.vertices.push_back(rounded(p));
    }
    return it->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true})
      for (std::size_t i = 0; i < cells; ++i)
        for (std::size_t j = 0; j < cells; ++j) {
          const auto at = [&](std::size_t s, std::size_t t) {
            std::array<std::size_t, 3> p{};
            p[axis] = upper ? cells : 0, p[(axis + 1) % 3] = i + s, p[(axis + 2) % 3] = j + t;
            return vertex(p);
          };
          std::uint32_t a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
          if (!upper) std::swap(b, d);
          mesh.faces.push_back({a, b, c}), mesh.faces.push_back({a, c, d});
        }
}

void Parts::sphere(const Job& job, const Vec3d& centre, double radius, std::size_t faces) {
  const Geodesic geodesic(Geodesic::frequency(double(faces)));
  const std::size_t f = std::size_t(Geodesic::frequency(double(faces)));
  const std::size_t vertex = mesh.vertices.size(), face = mesh.faces.size();
  mesh.vertices.resize(vertex + Geodesic::vertices(f)), mesh.faces.resize(face + Geodesic::faces(f));
  geodesic.write(job, mesh, vertex, face, false, 1,
                 [&](const Vec3d& d) { return sum(centre, scaled(d, radius)); });
}

void Parts::add(const geometry::Mesh3f& other) {
  const auto shift = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& f : other.faces) mesh.faces.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
}

std::size_t box_cells(std::size_t faces) {
  return std::max<std::size_t>(1, std::size_t(std::sqrt(double(faces) / 12) + 0.5));
}

}  // namespace treeline::datasets
