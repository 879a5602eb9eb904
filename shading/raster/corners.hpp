// The corners of as many triangles as a register has lanes, and the texels that these may cover.
#pragma once

#include <string>

#include "shading/raster/clip.hpp"

namespace treeline::shading::raster {

struct TexelBox {
  int x0, y0, x1, y1;  ///< both ends included
};

/// Vertices, and three of them for each face.
struct Corners {
  std::span<const Vertex> vertices;
  std::span<const geometry::Mesh3f::Face> faces;
};

/// Throws InvalidScene for the first of the faces that names a vertex that there is none of.
inline void check_indices(const Corners& corners, std::size_t first, std::size_t count) {
  const auto limit = std::uint32_t(corners.vertices.size());
  bool good = true;
  for (std::size_t i = first; i < first + count; ++i)
    for (const std::uint32_t v : corners.faces[i]) good &= v < limit;
  if (good) return;
  for (std::size_t i = first; i < first + count; ++i)
    for (const std::uint32_t v : corners.faces[i])
      if (v >= limit)
        throw InvalidScene("face " + std::to_string(i) + " names vertex " + std::to_string(v) +
                           " of a mesh of " + std::to_string(limit));
}

/// Rounded to 8 bits below the texel.
inline Ints snapped(Ints fixed) { return (fixed + 128) >> 8; }

/// Corners of one triangle a lane.
struct CornerRegisters {
  Ints x[3], y[3], numerator[3], denominator[3];  ///< as in Vertex, floats as their bits
  Ints snapped_x[3], snapped_y[3];

  /// face(lane) is the number of that face.
  template <class Face>
  CornerRegisters(const Corners& corners, const Face& face) {
    const std::int32_t* record[3][lanes];
    for (int lane = 0; lane < lanes; ++lane) {
      const auto& f = corners.faces[face(lane)];
      for (std::size_t k = 0; k < 3; ++k)
        record[k][lane] = reinterpret_cast<const std::int32_t*>(corners.vertices.data() + f[k]);
    }
    for (int k = 0; k < 3; ++k) {
      Ints fields[4];
      load_records(record[k], fields);
      x[k] = fields[0], y[k] = fields[1], numerator[k] = fields[2], denominator[k] = fields[3];
      snapped_x[k] = snapped(x[k]), snapped_y[k] = snapped(y[k]);
    }
  }

  /// One bit a lane, of those that must be clipped first.
  std::uint32_t outside() const {
    const Ints mark = ints(Vertex::outside);
    return negative((x[0] == mark) | (x[1] == mark) | (x[2] == mark));
  }
  void swap_where(Ints mask, int a, int b) {
    for (Ints* v : {x, y, numerator, denominator, snapped_x, snapped_y}) {
      const Ints t = mask ? v[b] : v[a];
      v[b] = mask ? v[a] : v[b], v[a] = t;
    }
  }
};

/// The texels of a box whose centres are not outside the box of the corners.
struct Covered {
  Ints width, height;  ///< of all of the corners' box, in 1/256 texel
  Ints x0, x1, y0, y1;
  Ints start_x, start_y;  ///< of those of the map; where depth is reckoned from, whatever the box

  Covered(const CornerRegisters& c, const TexelBox& box) {
    const auto lowest = [](const Ints* v) { return least(v[0], least(v[1], v[2])); };
    const auto highest = [](const Ints* v) { return largest(v[0], largest(v[1], v[2])); };
    const Ints left = lowest(c.snapped_x), right = highest(c.snapped_x), top = lowest(c.snapped_y),
               bottom = highest(c.snapped_y);
    width = right - left, height = bottom - top;
    start_x = largest((left + 127) >> 8, Ints{}), start_y = largest((top + 127) >> 8, Ints{});
    x0 = largest(start_x, ints(box.x0)), x1 = least((right - 128) >> 8, ints(box.x1));
    y0 = largest(start_y, ints(box.y0)), y1 = least((bottom - 128) >> 8, ints(box.y1));
  }
  /// One bit a lane, of those that cover no centre.
  std::uint32_t nothing() const { return negative((x1 - x0) | (y1 - y0)); }
};

}  // namespace treeline::shading::raster
