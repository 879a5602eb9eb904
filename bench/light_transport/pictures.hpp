// Pictures of a room: converged, by each method from few samples, and how far these are off.
#pragma once

#include <string>

#include "bench/light_transport/method.hpp"

namespace treeline::bench::light_transport {

/// Of panels; a converged picture alone has four times as many.
inline constexpr int picture_pixels = 9'000;

/// `room` is taken in about so many pixels; `seed` is that of the paths. Adds files and their lines of
/// pictures.jsonl to the folder; in builds that cannot write PNG nothing is written. Throws
/// std::runtime_error naming what cannot be written.
void draw_pictures(const std::vector<Method>&, LitScene room, const std::string& dataset, std::uint64_t seed,
                   int pixels, int threads, const std::string& folder);

/// Radiance as a screen shows it: `exposure` times it, in sRGB, cut off at white.
shading::Image displayed(const shading::Image& radiance, float exposure);
/// That which brings the brightness of all but the brightest hundredth of the pixels to white, and of a room
/// whose mean is brighter than that, less.
float exposure_of(const shading::Image& radiance);

/// The camera's image with about so many pixels, in its shape.
void resize(shading::Camera&, int pixels);

}  // namespace treeline::bench::light_transport
