// The mean of a region of a texture, by every method.
#pragma once

#include "shading/texture/anisotropic.hpp"
#include "shading/texture/brute_force.hpp"
#include "shading/texture/multi_probe.hpp"
#include "shading/texture/nearest.hpp"
#include "shading/texture/sat_centred.hpp"
#include "shading/texture/sat_double.hpp"
#include "shading/texture/sat_float.hpp"
#include "shading/texture/sat_int64.hpp"
#include "shading/texture/sat_uint32.hpp"
#include "shading/texture/trilinear.hpp"
