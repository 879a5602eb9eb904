// KD trees: over points and over triangles.
#pragma once

#include "accel/kd_tree/points.hpp"
#if __has_include("accel/kd_tree/triangles.hpp")
#include "accel/kd_tree/triangles.hpp"
#endif
