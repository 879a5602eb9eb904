#include "datasets_gen/meshes/geodesic.hpp"

#include <algorithm>

namespace treeline::datasets {
namespace {

constexpr double golden = 1.618033988749895;

constexpr std::array<Vec3d, 12> corners{{{-1, golden, 0},
                                         {1, golden, 0},
                                         {-1, -golden, 0},
                                         {1, -golden, 0},
                                         {0, -1, golden},
                                         {0, 1, golden},
                                         {0, -1, -golden},
                                         {0, 1, -golden},
                                         {golden, 0, -1},
                                         {golden, 0, 1},
                                         {-golden, 0, -1},
                                         {-golden, 0, 1}}};

// Counter-clockwise seen from outside.
constexpr std::array<std::array<std::size_t, 3>, 20> faces_of_icosahedron{
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

struct Edges {
  std::array<std::array<std::size_t, 2>, 30> ends;     // the lower corner first
  std::array<std::array<std::size_t, 12>, 12> number;  // by both corners, in either order
};

const Edges& edges() {
  static const Edges all = [] {
    Edges r{};
    std::size_t count = 0;
    for (const auto& f : faces_of_icosahedron)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t a = f[k], b = f[(k + 1) % 3];
        if (a > b) continue;  // its twin names it
        r.ends[count] = {a, b};
        r.number[a][b] = r.number[b][a] = count++;
      }
    return r;
  }();
  return all;
}

}  // namespace

std::size_t Geodesic::frequency(double n) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(n / 20) + 0.5));
}

Vec3d Geodesic::corner(std::size_t k) { return corners[k]; }
std::array<std::size_t, 3> Geodesic::face_corners(std::size_t face) { return faces_of_icosahedron[face]; }
std::array<std::size_t, 2> Geodesic::edge_corners(std::size_t edge) { return edges().ends[edge]; }

std::size_t Geodesic::edge_vertex(std::size_t from, std::size_t to, std::size_t steps) const {
  if (steps == 0) return from;
  if (steps == f_) return to;
  return 12 + edges().number[from][to] * (f_ - 1) + (from < to ? steps : f_ - steps) - 1;
}

std::size_t Geodesic::vertex(std::size_t face, std::size_t i, std::size_t j) const {
  const auto& [a, b, c] = faces_of_icosahedron[face];
  if (j == 0) return edge_vertex(a, b, i);
  if (i == 0) return edge_vertex(a, c, j);
  if (i + j == f_) return edge_vertex(b, c, j);
  const std::size_t inner = (f_ - 1) * (f_ - 2) / 2;
  return 12 + 30 * (f_ - 1) + face * inner + (j - 1) * (f_ - 1) - (j - 1) * j / 2 + i - 1;
}

}  // namespace treeline::datasets
