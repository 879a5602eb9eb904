// KD trees: over points and over triangles.
#pragma once

#include "accel/kd_tree/points.hpp"
#include "accel/kd_tree/triangles.hpp"
