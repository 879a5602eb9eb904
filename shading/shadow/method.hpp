// What all shadow methods share: the question they answer, and how a whole batch of it is asked.
//
// Visibility is the share of the light's area that a receiver sees: 1 lit, 0 in shadow. The cosine at the
// receiver is not part of it; a receiver that faces away from the light gets an answer in [0, 1], of which
// nothing is promised. A point that the map does not hold is lit.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <string>

#include "accel/batch.hpp"
#include "shading/shadow/depth_map.hpp"

namespace treeline::shading::shadow {

/// Methods are light to make: they refer to the maps that they are given, which must outlive them. They are
/// immutable, and safe to ask from many threads at once.
template <class M>
concept ShadowMethod = requires(const M& m, const Receiver& r) {
  { m.visibility(r) } -> std::same_as<float>;
  { m.bytes() } -> std::same_as<std::size_t>;  ///< of the maps that a query reads
};

namespace detail {
inline void check_room(std::size_t receivers, std::size_t answers) {
  if (receivers != answers)
    throw InvalidScene("there are " + std::to_string(receivers) + " receivers and room for " +
                       std::to_string(answers) + " answers");
}
}  // namespace detail

/// The visibility of each receiver, in their order; the answers do not depend on `threads`. Throws
/// InvalidScene if `out` is not as long as the receivers, accel::InvalidInput for threads < 1.
template <ShadowMethod M>
void shade(const M& method, std::span<const Receiver> receivers, int threads, std::span<float> out) {
  detail::check_room(receivers.size(), out.size());
  accel::parallel_ranges(receivers.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out[i] = method.visibility(receivers[i]);
  });
}

namespace detail {

/// Throws InvalidScene unless value is in [low, high]; NaN never is.
inline void check_knob(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw InvalidScene(std::string(name) + " is " + std::to_string(value) + "; it must be in [" +
                       std::to_string(low) + ", " + std::to_string(high) + "]");
}

/// Throws InvalidScene for a map whose arrays do not have its size.
inline void check_map(const DepthMap& map, bool needs_second = false) {
  if (map.width < 1 || map.height < 1)
    throw InvalidScene("the depth map has " + std::to_string(map.width) + " x " + std::to_string(map.height) +
                       " texels");
  const std::size_t n = std::size_t(map.width) * std::size_t(map.height);
  if (map.first.size() != n)
    throw InvalidScene("the depth map has " + std::to_string(n) + " texels and " +
                       std::to_string(map.first.size()) + " first depths");
  if ((needs_second || !map.second.empty()) && map.second.size() != n)
    throw InvalidScene("the depth map has " + std::to_string(n) + " texels and " +
                       std::to_string(map.second.size()) + " second depths");
}

}  // namespace detail
}  // namespace treeline::shading::shadow
