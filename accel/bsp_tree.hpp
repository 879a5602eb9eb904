// BSP trees: over points, over rows and over triangles.
#pragma once

#include "accel/bsp_tree/points.hpp"
#include "accel/bsp_tree/rows.hpp"
#include "accel/bsp_tree/triangles.hpp"
