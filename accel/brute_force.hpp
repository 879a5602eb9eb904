// Brute force: over points and over triangles.
#pragma once

#include "accel/brute_force/points.hpp"
#include "accel/brute_force/triangles.hpp"
