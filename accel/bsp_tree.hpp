// BSP trees: over points and over triangles.
#pragma once

#include "accel/bsp_tree/points.hpp"
#include "accel/bsp_tree/triangles.hpp"
