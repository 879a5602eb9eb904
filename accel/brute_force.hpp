// Brute force: over points, over rows and over triangles.
#pragma once

#include "accel/brute_force/points.hpp"
#include "accel/brute_force/rows.hpp"
#include "accel/brute_force/triangles.hpp"
