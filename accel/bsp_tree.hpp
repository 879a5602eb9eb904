// BSP trees: over points, exact and with overlaps (approximate), over rows and over triangles.
#pragma once

#include "accel/bsp_tree/points.hpp"
#include "accel/bsp_tree/rows.hpp"
#include "accel/bsp_tree/spill_points.hpp"
#include "accel/bsp_tree/triangles.hpp"
