// Exact predicates, one file a family: decided without an error for any finite input, and as a rule at the
// price of plain double. Each file states its conventions. Numbers must be finite, and denormals must not be
// flushed to zero by the thread that asks.
#pragma once

#include "geometry/exact/orientation.hpp"
#include "geometry/exact/ray_triangle.hpp"
#include "geometry/exact/three_planes.hpp"
#include "geometry/exact/triangle_box.hpp"
#include "geometry/exact/triangle_distance.hpp"
