// KD trees: over points, over rows and over triangles.
#pragma once

#include "accel/kd_tree/points.hpp"
#include "accel/kd_tree/rows.hpp"
#include "accel/kd_tree/triangles.hpp"
