// Bounding volume hierarchies: over points and over triangles.
#pragma once

#include "accel/bvh/points.hpp"
#include "accel/bvh/triangles.hpp"
#include "accel/bvh/wide_points.hpp"
