// Which triangles touch which tile of the map. Several at a time: those that cover no texel's centre, for
// want of size or because they lie outside, fall out here; the rest is sorted by tile, so that what is drawn
// next stays in the cache whatever the order of the mesh.
#pragma once

#include <string>

#include "shading/raster/clip.hpp"

namespace treeline::shading::raster {

inline constexpr int
    tile_shift = 6,
    tile_side = 1 << tile_shift;  ///< texels; edge functions of any size fit into 32 bits within a tile

struct Tiles {
  int columns, rows;
  Tiles(int width, int height)
      : columns((width + tile_side - 1) / tile_side), rows((height + tile_side - 1) / tile_side) {}
  std::size_t count() const { return std::size_t(columns) * std::size_t(rows); }
};

/// Corners, and three of them for each face.
struct Corners {
  std::span<const Vertex> vertices;
  std::span<const geometry::Mesh3f::Face> faces;
};

/// Those of a run of faces that touch each tile.
class Bin {
 public:
  /// Looks at faces from `next` on, until the last or until so many references are kept; sets next. Faces
  /// that need clipping go into `hard`. Throws InvalidScene for a face that names a vertex that there is none
  /// of.
  void fill(const Frame& frame, const Tiles& tiles, const Corners& corners, std::size_t& next,
            std::size_t end, std::size_t most, std::vector<std::uint32_t>& hard);

  std::span<const std::uint32_t> of_tile(std::size_t tile) const {
    return std::span(sorted_).subspan(starts_[tile], starts_[tile + 1] - starts_[tile]);
  }
  std::size_t size() const { return references_.size(); }

 private:
  struct Reference {
    std::uint32_t tile, face;
  };
  void sort(std::size_t tiles);

  std::vector<Reference> references_;
  std::vector<std::uint32_t> starts_, sorted_;
};

/// The indices of a register of faces; of those beyond `end` the last one's.
struct FaceIndices {
  Ints face, v[3];

  FaceIndices(const Corners& corners, Ints numbers) : face(numbers) {
    const auto* base = reinterpret_cast<const std::int32_t*>(corners.faces.data());
    for (int k = 0; k < 3; ++k) v[k] = gathered(base + k, numbers * 3);
  }
};

/// A field of vertices: 0 x, 1 y, 2 numerator, 3 denominator.
inline Ints field(const Corners& corners, Ints vertex, int number) {
  return gathered(reinterpret_cast<const std::int32_t*>(corners.vertices.data()) + number, vertex * 4);
}

/// Rounded to 8 bits below the texel.
inline Ints snapped(Ints fixed) { return (fixed + 128) >> 8; }
/// First and last texel whose centre is not outside.
inline Ints first_texel(Ints low) { return (low + 127) >> 8; }
inline Ints last_texel(Ints high) { return (high - 128) >> 8; }

inline void Bin::fill(const Frame& frame, const Tiles& tiles, const Corners& corners, std::size_t& next,
                      std::size_t end, std::size_t most, std::vector<std::uint32_t>& hard) {
  references_.clear();
  const auto vertices = std::uint32_t(corners.vertices.size());
  for (; next < end && references_.size() < most; next += lanes) {
    const std::size_t count = std::min<std::size_t>(lanes, end - next);
    const FaceIndices f(corners, least(counting() + std::int32_t(next), ints(std::int32_t(end - 1))));
    const std::uint32_t wanted = all_lanes >> (std::size_t(lanes) - count);
    const Words limit = vertices - Words{};
    if (const std::uint32_t wrong = negative(
            (Ints)(((Words)f.v[0] >= limit) | ((Words)f.v[1] >= limit) | ((Words)f.v[2] >= limit)))) {
      const std::size_t face = next + std::size_t(__builtin_ctz(wrong));
      throw InvalidScene("face " + std::to_string(std::min(face, end - 1)) +
                         " names a vertex beyond the last of " + std::to_string(vertices));
    }
    Ints x[3], y[3];
    for (int k = 0; k < 3; ++k) x[k] = field(corners, f.v[k], 0), y[k] = field(corners, f.v[k], 1);
    const Ints outside = ints(Vertex::outside);
    const std::uint32_t clipped =
        negative((x[0] == outside) | (x[1] == outside) | (x[2] == outside)) & wanted;
    for (std::uint32_t left = clipped; left; left &= left - 1)
      hard.push_back(std::uint32_t(next) + std::uint32_t(__builtin_ctz(left)));
    for (int k = 0; k < 3; ++k) x[k] = snapped(x[k]), y[k] = snapped(y[k]);
    const Ints x0 = largest(first_texel(least(x[0], least(x[1], x[2]))), Ints{}),
               x1 = least(last_texel(largest(x[0], largest(x[1], x[2]))), ints(frame.width - 1)),
               y0 = largest(first_texel(least(y[0], least(y[1], y[2]))), Ints{}),
               y1 = least(last_texel(largest(y[0], largest(y[1], y[2]))), ints(frame.height - 1));
    std::uint32_t left = ~negative((x1 - x0) | (y1 - y0)) & wanted & ~clipped;
    if (left == 0) continue;
    const Ints tx0 = x0 >> tile_shift, tx1 = x1 >> tile_shift, ty0 = y0 >> tile_shift, ty1 = y1 >> tile_shift;
    for (; left; left &= left - 1) {
      const int k = __builtin_ctz(left);
      const auto face = std::uint32_t(next) + std::uint32_t(k);
      for (int row = ty0[k]; row <= ty1[k]; ++row)
        for (int column = tx0[k]; column <= tx1[k]; ++column)
          references_.push_back({std::uint32_t(row * tiles.columns + column), face});
    }
  }
  next = std::min(next, end);
  sort(tiles.count());
}

inline void Bin::sort(std::size_t tiles) {
  starts_.assign(tiles + 1, 0);
  for (const Reference& r : references_) ++starts_[r.tile + 1];
  for (std::size_t t = 0; t < tiles; ++t) starts_[t + 1] += starts_[t];
  sorted_.resize(references_.size());
  for (const Reference& r : references_) sorted_[starts_[r.tile]++] = r.face;
  // Each start is now the next one's.
  for (std::size_t t = tiles; t > 0; --t) starts_[t] = starts_[t - 1];
  starts_[0] = 0;
}

}  // namespace treeline::shading::raster
