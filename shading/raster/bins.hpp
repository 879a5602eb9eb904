// For several threads: which triangles touch which tile of the map. A register of triangles at a time: those
// that cover no texel's centre, for want of size or because they lie outside, fall out here; the rest is
// sorted by tile.
#pragma once

#include "shading/raster/corners.hpp"
#include "shading/raster/large.hpp"

namespace treeline::shading::raster {

struct Tiles {
  int columns, rows;
  Tiles(int width, int height)
      : columns((width + tile_side - 1) / tile_side), rows((height + tile_side - 1) / tile_side) {}
  std::size_t count() const { return std::size_t(columns) * std::size_t(rows); }
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

inline void Bin::fill(const Frame& frame, const Tiles& tiles, const Corners& corners, std::size_t& next,
                      std::size_t end, std::size_t most, std::vector<std::uint32_t>& hard) {
  references_.clear();
  for (; next < end && references_.size() < most; next += lanes) {
    const std::size_t count = std::min<std::size_t>(lanes, end - next);
    check_indices(corners, next, count);
    const CornerRegisters c(corners, [&](int lane) { return next + std::min(std::size_t(lane), count - 1); });
    const std::uint32_t wanted = all_lanes >> (std::size_t(lanes) - count), clipped = c.outside() & wanted;
    for (std::uint32_t left = clipped; left; left &= left - 1)
      hard.push_back(std::uint32_t(next) + std::uint32_t(__builtin_ctz(left)));
    const Covered box(c, {0, 0, frame.width - 1, frame.height - 1});
    std::uint32_t left = ~box.nothing() & wanted & ~clipped;
    if (left == 0) continue;
    const Ints x0 = box.x0 >> tile_shift, x1 = box.x1 >> tile_shift, y0 = box.y0 >> tile_shift,
               y1 = box.y1 >> tile_shift;
    for (; left; left &= left - 1) {
      const int k = __builtin_ctz(left);
      const auto face = std::uint32_t(next) + std::uint32_t(k);
      for (int row = y0[k]; row <= y1[k]; ++row)
        for (int column = x0[k]; column <= x1[k]; ++column)
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
