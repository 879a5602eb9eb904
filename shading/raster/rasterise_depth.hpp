// Depth maps by rasterisation.
//
// Problem: what a light sees first (and next) through the centre of each texel of its map.
// Source: Williams 1978 (shadow maps); Pineda 1988 (edge functions); tiles and registers of triangles as in
// Abrash 2009, Rasterization on Larrabee.
//
// Cost: a pass over the vertices and one over the faces; 16 bytes a vertex, 4 a texel and layer. Several
// threads first sort the faces by tile, for 12 bytes a pair of a face and a tile, so that no two draw into
// the same one.
//
// Accuracy: corners are rounded to 1/256 of a texel to decide what is covered, so that a texel whose centre
// is nearer than that to an edge may go to the other side of it; all that shares a corner rounds it alike,
// and of triangles that share an edge exactly one covers a centre on it: closed surfaces have no holes.
// Depth is that of the triangle's plane at the centre, off by a few roundings of float, and kept within the
// depths of its corners.
//
// Known weakness: what covers no texel's centre is not there, as in every map of samples.
#pragma once

#include <memory>

#include "accel/batch.hpp"
#include "shading/raster/bins.hpp"
#include "shading/raster/tile.hpp"
#include "shading/shadow/depth_map.hpp"

namespace treeline::shading::raster {

struct DepthOptions {
  int layers = 1;                ///< 2: also the next depth behind the first, of any surface
  Facing facing = Facing::both;  ///< which faces are drawn
  int threads = 1;               ///< the map does not depend on it
};

/// What became of the faces; none of it is an error.
struct DepthWork {
  std::size_t broken = 0;      ///< left out, with a corner that is not finite
  std::size_t clipped = 0;     ///< in front of the near plane, or far beside the map, in part or whole
  std::size_t references = 0;  ///< of several threads: pairs of a face and a tile that it may cover
};

/// What one map leaves to the next: on one thread, a map of the same mesh and size then asks for no memory.
class DepthScratch {
 public:
  /// Not filled.
  std::span<Vertex> vertices(std::size_t n) {
    if (n > room_) vertices_ = std::make_unique_for_overwrite<Vertex[]>(n), room_ = n;
    return {vertices_.get(), n};
  }
  std::vector<std::uint32_t> hard;
  std::vector<Vertex> cut;

 private:
  std::unique_ptr<Vertex[]> vertices_;
  std::size_t room_ = 0;
};

/// Calls f(i) for each i below n.
template <class F>
void each(std::size_t n, int threads, const F& f) {
  accel::parallel_ranges(n * accel::batch_chunk, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin / accel::batch_chunk; i < end / accel::batch_chunk; ++i) f(i);
  });
}

/// Throws InvalidScene for a view that is none, and sides out of range.
inline void check_view(const shadow::LightView& view, int width, int height, int layers, int threads) {
  const auto refuse = [](const std::string& what) { throw InvalidScene("depth map: " + what); };
  if (width < 1 || height < 1 || width > largest_side || height > largest_side)
    refuse(std::to_string(width) + " × " + std::to_string(height) + " texels; each side must be from 1 to " +
           std::to_string(largest_side));
  if (layers != 1 && layers != 2) refuse(std::to_string(layers) + " layers; there are 1 or 2");
  if (threads < 1) refuse("threads is " + std::to_string(threads) + "; it must be at least 1");
  if (!is_finite(view.origin) || !is_finite(view.right) || !is_finite(view.down) || !is_finite(view.forward))
    refuse("the view is not finite");
  if (!(view.half_width > 0 && view.half_height > 0 && view.half_width < INFINITY &&
        view.half_height < INFINITY))
    refuse("the view has no width or height");
  if (!(view.near < view.far && view.far - view.near < INFINITY) || (view.perspective && !(view.near > 0)))
    refuse("the view's near plane must be before its far plane, and in perspective beyond the light");
}

namespace detail {

/// Draws faces with corners that need no clipping; the numbers of the others are added to `hard`.
inline void draw_faces(const Frame& frame, const Target& target, const Corners& corners,
                       const DepthOptions& options, std::vector<std::uint32_t>& hard, DepthWork& work) {
  if (options.threads == 1) {
    const auto draw = target.second ? (frame.perspective ? draw_map<true, true> : draw_map<false, true>)
                                    : (frame.perspective ? draw_map<true, false> : draw_map<false, false>);
    return draw(target, {0, 0, frame.width - 1, frame.height - 1}, corners, options.facing, hard);
  }
  const Tiles tiles(frame.width, frame.height);
  const std::size_t n = corners.faces.size();
  // Enough for all threads; each with room for so many references at a time.
  const std::size_t runs = std::min<std::size_t>(4 * std::size_t(options.threads), n / 4096 + 1);
  const std::size_t most = std::max<std::size_t>(std::size_t(1) << 22, tiles.count()) / runs;
  std::vector<Bin> bins(runs);
  std::vector<std::size_t> next(runs);
  std::vector<std::vector<std::uint32_t>> hard_of(runs);
  const auto end_of = [&](std::size_t run) { return n * (run + 1) / runs; };
  for (std::size_t run = 0; run < runs; ++run) next[run] = n * run / runs;
  const auto draw = target.second ? (frame.perspective ? draw_tile<true, true> : draw_tile<false, true>)
                                  : (frame.perspective ? draw_tile<true, false> : draw_tile<false, false>);
  for (bool more = true; more;) {
    each(runs, options.threads, [&](std::size_t run) {
      bins[run].fill(frame, tiles, corners, next[run], end_of(run), most, hard_of[run]);
    });
    each(tiles.count(), options.threads, [&](std::size_t tile) {
      const int x = int(tile) % tiles.columns * tile_side, y = int(tile) / tiles.columns * tile_side;
      const TexelBox bounds{x, y, std::min(x + tile_side, frame.width) - 1,
                            std::min(y + tile_side, frame.height) - 1};
      for (const Bin& bin : bins) draw(target, bounds, corners, bin.of_tile(tile), options.facing);
    });
    more = false;
    for (std::size_t run = 0; run < runs; ++run)
      more = more || next[run] < end_of(run), work.references += bins[run].size();
  }
  for (const auto& one : hard_of) hard.insert(hard.end(), one.begin(), one.end());
}

}  // namespace detail

/// Draws the map of a mesh over what `map` holds. Throws InvalidScene for a face that names a vertex that the
/// mesh does not have, a view that is none, sides beyond 16384 texels, and layers or threads out of range;
/// std::bad_alloc where there is no room. If it throws the map is of no use.
inline void rasterise_depth(const geometry::Mesh3f& mesh, const shadow::LightView& view, int width,
                            int height, shadow::DepthMap& map, DepthScratch& scratch,
                            const DepthOptions& options = {}, DepthWork* work = nullptr) {
  check_view(view, width, height, options.layers, options.threads);
  constexpr std::size_t limit = std::size_t(1) << 29;  // of what 32-bit offsets reach
  if (mesh.vertices.size() > limit || mesh.faces.size() > limit)
    throw InvalidScene("depth map: a mesh of more than 2^29 vertices or faces");
  const Frame frame(view, width, height);
  map.view = view, map.width = width, map.height = height;
  Target target{nullptr, nullptr, (std::size_t(width) + 15) / 16 * 16};
  const std::size_t texels = target.stride * std::size_t(height);
  map.first.assign(texels, 1.0f), target.first = map.first.data();
  map.second.assign(options.layers == 2 ? texels : 0, 1.0f);
  if (options.layers == 2) target.second = map.second.data();

  const std::span<Vertex> vertices = scratch.vertices(mesh.vertices.size());
  accel::parallel_ranges(vertices.size(), options.threads, [&](std::size_t begin, std::size_t end) {
    place_vertices(frame, std::span(mesh.vertices).subspan(begin, end - begin), vertices.data() + begin);
  });
  DepthWork done;
  std::vector<std::uint32_t>& hard = scratch.hard;
  hard.clear();
  detail::draw_faces(frame, target, {vertices, mesh.faces}, options, hard, done);

  std::vector<Vertex>& cut = scratch.cut;
  cut.clear();
  for (const std::uint32_t face : hard) {
    std::array<ClipCorner, 3> triangle;
    bool finite = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.faces[face][k];
      finite = finite && is_finite(mesh.vertices[v]);
      triangle[k] = clip_corner(frame, mesh.vertices[v], vertices[v]);
    }
    ++(finite ? done.clipped : done.broken);
    if (finite) clip_triangle(frame, triangle, cut);
  }
  if (!cut.empty()) {
    std::vector<geometry::Mesh3f::Face> faces(cut.size() / 3);
    for (std::uint32_t f = 0; f < faces.size(); ++f) faces[f] = {3 * f, 3 * f + 1, 3 * f + 2};
    detail::draw_faces(frame, target, {cut, faces}, options, hard, done);
  }
  if (work) *work = done;

  for (auto* layer : {&map.first, &map.second}) {
    if (layer->empty() || target.stride == std::size_t(width)) continue;
    for (std::size_t y = 1; y < std::size_t(height); ++y)
      std::copy_n(layer->begin() + std::ptrdiff_t(y * target.stride), width,
                  layer->begin() + std::ptrdiff_t(y * std::size_t(width)));
    layer->resize(std::size_t(width) * std::size_t(height));
  }
}

/// The map of a mesh, as above.
inline shadow::DepthMap rasterise_depth(const geometry::Mesh3f& mesh, const shadow::LightView& view,
                                        int width, int height, const DepthOptions& options = {},
                                        DepthWork* work = nullptr) {
  shadow::DepthMap map;
  DepthScratch scratch;
  rasterise_depth(mesh, view, width, height, map, scratch, options, work);
  return map;
}

}  // namespace treeline::shading::raster
