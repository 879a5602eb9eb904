// Forests of randomised trees: over rows.
#pragma once

#include "accel/forest/rows.hpp"
