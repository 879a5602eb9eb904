// A mesh that moves: the same faces with other vertices, frame after frame; and the query sets that ask what
// an index is worth after refitting it, and after building it anew.
//
// Problem: animation moves vertices every frame. Refitting keeps the structure and updates the boxes in it,
// many
//   times faster than a build; but the structure was made for other places, and rays pay for it.
// The motion: a twist about the vertical axis through the middle. What was together stays together, but boxes
//   that were flat turn and grow.
// Sets: frame<k>_refit and frame<k>_rebuilt, the same rays in the camera's order and at random by halves.
//   query_ns is the tracing alone, ray_update_s of the row what the update took.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/ray/queries.hpp"
#include "geometry/mesh.hpp"

namespace treeline::bench::ray {

/// Frames shown; the turn from bottom to top is 0.1 rad a frame.
std::vector<std::size_t> moving_frames(bool quick);

/// The mesh as it is `frame` frames later.
geometry::Mesh3f twisted(const geometry::Mesh3f& mesh, std::size_t frame);

/// Appends the sets over meshes frames[0], frames[1], …, which are numbers 1, 2, … of the block.
void add_moving_sets(std::vector<RaySet>& sets, const std::vector<geometry::Mesh3f>& meshes,
                     const std::vector<std::size_t>& frames, std::size_t count, std::uint64_t seed);

}  // namespace treeline::bench::ray
