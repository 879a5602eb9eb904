// Bounding volume hierarchies: over points and over triangles, binary and wide, in every layout. Builders
// that a wide one over triangles takes in place of its own: accel/bvh/build_sweep.hpp, build_spatial.hpp,
// build_ploc.hpp, reinsertion.hpp.
#pragma once

#include "accel/bvh/points.hpp"
#include "accel/bvh/triangles.hpp"
#include "accel/bvh/wide_compact.hpp"
#include "accel/bvh/wide_points.hpp"
#include "accel/bvh/wide_triangles.hpp"
