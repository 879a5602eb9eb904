#include "bench/region_average/queries.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/random.hpp"

namespace treeline::bench::region_average {
namespace {

namespace texture = shading::texture;
using geometry::Pcg32;

/// Moved inside, where it fits.
Footprint inside(Footprint f, int width, int height) {
  const texture::Box b = texture::bounding_box(f);
  const auto shift = [](double low, double high, double n) {
    if (high - low >= n) return 0.5 * n - 0.5 * (low + high);
    return low < 0 ? -low : high > n ? n - high : 0.0;
  };
  f.x += shift(b.x0, b.x1, width), f.y += shift(b.y0, b.y1, height);
  return f;
}

/// As a picture asks: strips of eight rows of texels, from left to right.
std::vector<Footprint> sorted(std::vector<Footprint> all) {
  std::ranges::sort(all, {}, [](const Footprint& f) { return std::pair(std::floor(f.y / 8), f.x); });
  return all;
}

Footprint square(double x, double y, double side) {
  return texture::box_footprint({x - 0.5 * side, y - 0.5 * side, x + 0.5 * side, y + 0.5 * side});
}
/// Of whole texels, with corners at multiples of the side.
Footprint aligned(double x, double y, int side) {
  const double left = std::floor(x / side) * side, top = std::floor(y / side) * side;
  return texture::box_footprint({left, top, left + side, top + side});
}

}  // namespace

std::vector<FootprintSet> make_sets(int width, int height, std::size_t each, std::uint64_t seed) {
  std::vector<FootprintSet> sets;
  std::uint64_t stream = 40;
  const auto add = [&](const char* name, bool boxes, bool in_order, auto&& make) {
    Pcg32 random(seed, stream++);
    FootprintSet set{name, {}, boxes};
    for (std::size_t i = 0; i < each; ++i) {
      const double x = random.uniform(0.0, double(width)), y = random.uniform(0.0, double(height));
      set.footprints.push_back(inside(make(x, y, random), width, height));
    }
    sets.push_back(set);
    if (in_order) sets.push_back({set.name + "_sorted", sorted(std::move(set.footprints)), boxes});
  };
  add("texel", true, false, [](double x, double y, Pcg32&) { return aligned(x, y, 1); });
  add("square4", true, false, [](double x, double y, Pcg32&) { return square(x, y, 4); });
  add("aligned16", true, false, [](double x, double y, Pcg32&) { return aligned(x, y, 16); });
  add("square24", true, true, [](double x, double y, Pcg32&) { return square(x, y, 24); });
  add("oblong", true, true, [](double x, double y, Pcg32& random) {
    const bool flat = random.below(2) == 0;
    const double a = flat ? 32 : 2, b = flat ? 2 : 32;
    return texture::box_footprint({x - a, y - b, x + a, y + b});
  });
  add("rotated", false, true, [](double x, double y, Pcg32& random) {
    return texture::rotated_box(x, y, 16, 4, random.uniform(0.0, 2 * std::numbers::pi));
  });
  add("disc", false, true, [](double x, double y, Pcg32&) { return texture::disc_footprint(x, y, 12); });
  add("gaussian", false, true,
      [](double x, double y, Pcg32&) { return texture::gaussian_footprint(x, y, 6, 6); });
  sets.push_back({"build", {}});
  return sets;
}

std::vector<FootprintSet> make_whole_sets(int width, int height, std::size_t each, std::uint64_t seed) {
  auto sets = make_sets(width, height, each, seed);
  std::erase_if(sets, [](const FootprintSet& s) { return s.name != "texel" && s.name != "aligned16"; });
  return sets;
}

std::vector<FootprintSet> make_hard_sets(int width, int height, std::size_t each, std::uint64_t seed) {
  std::vector<FootprintSet> sets{{"boxes", {}}, {"outside", {}}, {"points", {}}, {"shapes", {}, false}};
  Pcg32 random(seed, 60);
  const auto size = [&](double most) { return std::exp2(random.uniform(-4.0, std::log2(most))); };
  for (std::size_t i = 0; i < each; ++i) {
    const double x = random.uniform(0.0, double(width)), y = random.uniform(0.0, double(height));
    const double a = size(width), b = size(height), turn = random.uniform(0.0, 7.0);
    switch (i % 4) {
      case 0:
        sets[0].footprints.push_back(aligned(x, y, 1));
        break;
      case 1:  // thin: within a column of texels
        sets[0].footprints.push_back(texture::box_footprint({x, y, x + 0.01, y + b}));
        break;
      case 2:
        sets[0].footprints.push_back(texture::box_footprint(
            {std::floor(x), std::floor(y), std::floor(x) + std::ceil(a), std::floor(y) + std::ceil(b)}));
        break;
      default:
        sets[0].footprints.push_back(texture::box_footprint({x - a, y - b, x + a, y + b}));
    }
    const double far = i % 8 == 0 ? 1e6 : 40;
    const double u = random.uniform(-far, width + far), v = random.uniform(-far, height + far);
    sets[1].footprints.push_back(texture::box_footprint({u - a, v - b, u + a, v + b}));
    sets[2].footprints.push_back(texture::box_footprint({x, y, i % 2 ? x : x + a, y}));
    const double r = std::min({a, b, 60.0});
    sets[3].footprints.push_back(i % 3 == 0   ? texture::rotated_box(x, y, r, 0.3 * r, turn)
                                 : i % 3 == 1 ? texture::disc_footprint(x, y, r)
                                              : texture::gaussian_footprint(x, y, 0.3 * r, 0.5 * r));
  }
  return sets;
}

}  // namespace treeline::bench::region_average
