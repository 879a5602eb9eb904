// Bounding volume hierarchies: over points and over triangles, binary and wide.
#pragma once

#include "accel/bvh/points.hpp"
#include "accel/bvh/triangles.hpp"
#include "accel/bvh/wide_points.hpp"
#include "accel/bvh/wide_triangles.hpp"
