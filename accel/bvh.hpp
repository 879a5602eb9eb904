// Bounding volume hierarchies: over points and over triangles.
#pragma once

#if __has_include("accel/bvh/points.hpp")
#include "accel/bvh/points.hpp"
#endif
#if __has_include("accel/bvh/triangles.hpp")
#include "accel/bvh/triangles.hpp"
#endif
