// The tree that our methods cast their rays with: the wide one, or among few triangles, waves of rays down a
// binary one.
#pragma once

#include <memory>

#include "accel/bvh/ray_waves.hpp"
#include "shading/scene.hpp"

namespace treeline::bench::light_transport {

using Tree = accel::RayWaves;

/// Faces that are not finite stop no light.
std::unique_ptr<Tree> make_tree(const geometry::Mesh3f&);

}  // namespace treeline::bench::light_transport
