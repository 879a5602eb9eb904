// BSP trees of meshes as solids: exact, with no epsilon; points, views, rays, and the merging of two.
#pragma once

#include "accel/bsp_solid/merge.hpp"
#include "accel/bsp_solid/rounded_space.hpp"
#include "accel/bsp_solid/tree.hpp"
