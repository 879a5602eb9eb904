// Depth maps by casting a ray through the centre of each texel: any tree, the same convention as
// rasterise_depth(). Cost: a ray a texel and layer. Known weakness: rays hit both triangles of an edge, at
// depths that rounding may tell apart, so that the second layer is looked for a little behind the first.
#pragma once

#include "accel/concepts.hpp"
#include "geometry/tolerances.hpp"
#include "shading/raster/rasterise_depth.hpp"

namespace treeline::shading::raster {

struct CastOptions {
  int layers = 1;  ///< 2: also the next depth behind the first
  int threads = 1;
};

/// The ray through the centre of a texel, from the near plane at t = 0 to the far plane at t = 1: t is depth.
template <class T>
geometry::Ray<T> texel_ray(const shadow::LightView& view, int width, int height, int x, int y) {
  const double across = (x + 0.5) / width, down = (y + 0.5) / height;
  const Vec3d from = view.at({across, down, 0}), to = view.at({across, down, 1});
  return {geometry::Vec<T, 3>(from), geometry::Vec<T, 3>(to - from), T(0), T(1)};
}

/// How far behind the first depth the second is looked for: the slack of a hit (geometry::tolerance) on
/// either side, for a reach of the ray and what lies beside it.
template <class T>
inline constexpr T second_slack = T(4) * geometry::tolerance::hit_slack<T>;

/// What one map leaves to the next: some megabytes.
template <class T>
struct CastScratch {
  std::vector<geometry::Ray<T>> rays;
  std::vector<accel::Hit<T>> hits;
};

/// Draws the map of what is in the index over what `map` holds. Throws InvalidScene as rasterise_depth()
/// does.
template <accel::RayIndex Index>
void cast_depth(const Index& index, const shadow::LightView& view, int width, int height,
                shadow::DepthMap& map, CastScratch<typename Index::Scalar>& scratch,
                const CastOptions& options = {}) {
  using T = typename Index::Scalar;
  check_view(view, width, height, options.layers, options.threads);
  map.view = view, map.width = width, map.height = height;
  const std::size_t texels = std::size_t(width) * std::size_t(height);
  map.first.assign(texels, 1.0f);
  map.second.assign(options.layers == 2 ? texels : 0, 1.0f);

  // Blocks of so many rays: a few megabytes.
  const std::size_t block = std::min<std::size_t>(texels, std::size_t(1) << 16);
  auto& [rays, hits] = scratch;
  rays.resize(block), hits.resize(block);
  for (std::size_t begin = 0; begin < texels; begin += block) {
    const std::size_t count = std::min(block, texels - begin);
    for (std::size_t i = 0; i < count; ++i)
      rays[i] = texel_ray<T>(view, width, height, int((begin + i) % std::size_t(width)),
                             int((begin + i) / std::size_t(width)));
    const std::span<const geometry::Ray<T>> asked(rays.data(), count);
    const std::span<accel::Hit<T>> told(hits.data(), count);
    index.closest_hit(asked, told, options.threads);
    for (std::size_t i = 0; i < count; ++i)
      if (told[i]) map.first[begin + i] = std::min(1.0f, float(told[i].t));
    if (options.layers == 1) continue;
    for (std::size_t i = 0; i < count; ++i)
      rays[i].t_min = told[i] ? std::min(T(1), T(told[i].t) + second_slack<T>) : T(1);
    index.closest_hit(asked, told, options.threads);
    for (std::size_t i = 0; i < count; ++i)
      if (told[i]) map.second[begin + i] = std::min(1.0f, float(told[i].t));
  }
}

/// The map of what is in the index, as above.
template <accel::RayIndex Index>
shadow::DepthMap cast_depth(const Index& index, const shadow::LightView& view, int width, int height,
                            const CastOptions& options = {}) {
  shadow::DepthMap map;
  CastScratch<typename Index::Scalar> scratch;
  cast_depth(index, view, width, height, map, scratch, options);
  return map;
}

}  // namespace treeline::shading::raster
