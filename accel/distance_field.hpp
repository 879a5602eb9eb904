// Distance fields: in closed form, and sampled from a mesh; look-ups in them, and rays.
#pragma once

#include "accel/field/analytic.hpp"
#include "accel/field/build.hpp"
#include "accel/field/sampled.hpp"
#include "accel/field/sphere_trace.hpp"
