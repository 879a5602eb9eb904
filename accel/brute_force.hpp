// Brute force: over points and over triangles.
#pragma once

#if __has_include("accel/brute_force/points.hpp")
#include "accel/brute_force/points.hpp"
#endif
#if __has_include("accel/brute_force/triangles.hpp")
#include "accel/brute_force/triangles.hpp"
#endif
