// BSP trees: over points and over triangles.
#pragma once

#if __has_include("accel/bsp_tree/points.hpp")
#include "accel/bsp_tree/points.hpp"
#endif
#if __has_include("accel/bsp_tree/triangles.hpp")
#include "accel/bsp_tree/triangles.hpp"
#endif
