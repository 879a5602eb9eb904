// Small closed meshes for tests, built here so that tests of the geometry need nothing else.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"
#include "geometry/random.hpp"
#include "geometry/sampling.hpp"

namespace treeline::test {

using namespace treeline::geometry;

template <class T>
Mesh<T> octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

/// Splits each face into four; place says where an edge's middle goes.
template <class T, class Place>
Mesh<T> subdivided(const Mesh<T>& mesh, const Place& place) {
  Mesh<T> r{mesh.vertices, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [it, fresh] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(r.vertices.size()));
    if (fresh) r.vertices.push_back(place((mesh.vertices[a] + mesh.vertices[b]) * T(0.5)));
    return it->second;
  };
  for (const auto& [a, b, c] : mesh.faces) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    r.faces.insert(r.faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return r;
}

/// A sphere of 8·4^levels faces around the origin; all of it is in general position but the octahedron's
/// corners.
template <class T>
Mesh<T> sphere(int levels) {
  Mesh<T> r = octahedron<T>();
  for (int i = 0; i < levels; ++i) r = subdivided(r, [](const Vec<T, 3>& p) { return normalized(p); });
  return r;
}

/// The cube [-1, 1]^3 in a grid of exactly coplanar faces: 48·4^levels of them.
template <class T>
Mesh<T> cube(int levels) {
  Mesh<T> r = {
      {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}},
      {{0, 2, 1},
       {0, 3, 2},
       {4, 5, 6},
       {4, 6, 7},
       {0, 1, 5},
       {0, 5, 4},
       {2, 3, 7},
       {2, 7, 6},
       {1, 2, 6},
       {1, 6, 5},
       {3, 0, 4},
       {3, 4, 7}}};
  for (int i = 0; i <= levels; ++i) r = subdivided(r, [](const Vec<T, 3>& p) { return p; });
  return r;
}

/// A sphere whose corners lie at random radii in [0.5, 1]: star-shaped around the origin, with needles.
template <class T>
Mesh<T> spiky(int levels, std::uint64_t seed) {
  Mesh<T> r = sphere<T>(levels);
  Pcg32 random(seed);
  for (auto& p : r.vertices) p = p * random.uniform<T>(T(0.5), T(1));
  return r;
}

/// The sphere squeezed to a sheet of thickness 2·thin.
template <class T>
Mesh<T> sheet(int levels, T thin) {
  Mesh<T> r = sphere<T>(levels);
  for (auto& p : r.vertices) p[2] *= thin;
  return r;
}

/// A torus around z of radii 1 and 0.3, with 2·n·m faces; its core circle lies inside.
template <class T>
Mesh<T> torus(std::uint32_t n, std::uint32_t m) {
  Mesh<T> r;
  constexpr double turn = 2 * std::numbers::pi;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const double a = turn * i / n, b = turn * j / m, d = 1 + 0.3 * std::cos(b);
      r.vertices.push_back(Vec<T, 3>(Vec3d{d * std::cos(a), d * std::sin(a), 0.3 * std::sin(b)}));
      const std::uint32_t i1 = (i + 1) % n, j1 = (j + 1) % m;
      r.faces.push_back({i * m + j, i1 * m + j, i1 * m + j1});
      r.faces.push_back({i * m + j, i1 * m + j1, i * m + j1});
    }
  return r;
}

template <class T>
Mesh<T> moved(Mesh<T> mesh, const Vec<T, 3>& by, T scale = 1) {
  for (auto& p : mesh.vertices) p = p * scale + by;
  return mesh;
}

template <class T>
Vec<T, 3> random_vec(Pcg32& random, T low = -1, T high = 1) {
  Vec<T, 3> r;
  for (int i = 0; i < 3; ++i) r[i] = random.uniform<T>(low, high);
  return r;
}

}  // namespace treeline::test
