// The footprints that are asked for: each query set is of one kind and size, in random order and, called
// …_sorted, in the order of a picture.
#pragma once

#include <string>
#include <vector>

#include "bench/region_average/method.hpp"

namespace treeline::bench::region_average {

struct FootprintSet {
  std::string name;
  std::vector<Footprint> footprints;  ///< none: the set asks for a build
  bool boxes = true;                  ///< all are boxes along the axes
  bool rebuilds() const { return footprints.empty(); }
};

/// `each` footprints a set, inside of the texture where they fit; the last set is "build".
std::vector<FootprintSet> make_sets(int width, int height, std::size_t each, std::uint64_t seed);
/// Of whole texels alone: single ones and squares of 16².
std::vector<FootprintSet> make_whole_sets(int width, int height, std::size_t each, std::uint64_t seed);
/// For hard cases: boxes of all kinds, boxes that reach or lie outside, points and lines, other shapes.
std::vector<FootprintSet> make_hard_sets(int width, int height, std::size_t each, std::uint64_t seed);

}  // namespace treeline::bench::region_average
