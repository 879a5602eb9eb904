// The tree that our methods cast their rays with.
#pragma once

#include "accel/bvh.hpp"
#include "shading/scene.hpp"

namespace treeline::bench::light_transport {

using Tree = accel::Bvh<accel::Triangles<float>, accel::Wide>;

/// Faces that are not finite stop no light.
std::unique_ptr<Tree> make_tree(const geometry::Mesh3f&);

}  // namespace treeline::bench::light_transport
