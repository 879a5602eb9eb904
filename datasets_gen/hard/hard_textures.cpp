#include "datasets_gen/hard/hard_textures.hpp"

#include <limits>

#include "datasets_gen/portable.hpp"

namespace treeline::datasets {
namespace {

using shading::Image;

template <class Make>
Image image(int width, int height, int channels, const Make& make) {
  Image r(width, height, channels);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c) r(x, y, c) = static_cast<float>(make(x, y, c));
  return r;
}
Image levels(std::uint64_t seed, int width, int height, int channels, std::uint64_t top) {
  std::uint64_t i = 0;
  return image(width, height, channels, [&](int, int, int) {
    return static_cast<float>(Draws(seed, i++).below(top + 1)) / static_cast<float>(top);
  });
}

}  // namespace

std::vector<HardTexture> hard_textures() {
  const std::string mean = "every mean is that of brute force in double";
  constexpr double most = double(std::numeric_limits<float>::max());
  std::vector<HardTexture> all;
  const auto add = [&](std::string name, std::string source, std::string law,
                       std::function<Image()> make) -> HardTexture& {
    all.push_back({.name = std::move(name),
                   .source = std::move(source),
                   .law = std::move(law),
                   .make = std::move(make)});
    return all.back();
  };
  add("texture_1x1", "derivation: no texel has a neighbour", "every mean is the texel",
      [] { return Image(1, 1, 3, 0.25f); });
  add("texture_1x300", "derivation: one side has no pyramid", mean, [] { return levels(1, 1, 300, 1, 255); });
  add("texture_257x3", "derivation: no multiple of any register, tile or level", mean,
      [] { return levels(2, 257, 3, 4, 255); });
  add("texture_cancellation",
      "derivation: of sums of mean m a float table loses ulp(m x y) √(h/6)/(w h) over w x h texels at (x, y)",
      "sums that grow with the table do not spoil small regions",
      [] { return levels(3, 2048, 2048, 1, 255); })
      .independent = true;
  // A depth and its square: what shadow maps ask of tables.
  add("texture_plane_moments",
      "derivation: in float sums of z² up to 2.5e5 are kept to 1/64; a variance of 5e-7 over 9² texels is a "
      "difference of them",
      "the variance over a region of a plane is that of its steps",
      [] {
        return image(1024, 1024, 2, [](int x, int y, int c) {
          const float z = static_cast<float>((x + 0.5) / 4096 + (y + 0.5) / 8192 + 0.3);
          return c == 0 ? z : z * z;
        });
      })
      .moments = true;
  add("texture_halves", "derivation: a table less the mean sums what differs from it", mean,
      [] { return image(700, 500, 1, [](int x, int, int) { return x < 350 ? 0.0 : 1.0; }); });
  add("texture_white", "derivation: the largest sum of 16-bit levels; above 65536 texels 32 bits wrap",
      "every mean is 1", [] { return Image(600, 500, 1, 1.0f); });
  add("texture_checkers", "derivation: every second texel; levels of a pyramid are grey", mean,
      [] { return image(256, 256, 1, [](int x, int y, int) { return (x + y) % 2; }); });
  add("texture_16_bits", "derivation: levels that 8 bits cannot tell apart", mean,
      [] { return levels(4, 300, 200, 1, 65535); });
  add("texture_below_levels", "derivation: values that no 16-bit level is near", mean,
      [] { return image(128, 128, 1, [](int x, int y, int) { return 1e-7 * (x + 3 * y); }); });
  add("texture_negative", "derivation: signed distances and normals are textures, too", mean, [] {
    return image(200, 200, 3,
                 [](int x, int y, int c) { return 40.0 * sincos_turns(0.016 * x + 0.2 * c).sin - 3.0 * y; });
  });
  add("texture_huge_values", "derivation: sums beyond the range of float", "a mean, or a refusal", [] {
    return image(64, 64, 1, [](int x, int y, int) { return (x * y) % 3 == 0 ? 0.9 * most : 0.0; });
  }).expect = Expect::answers_or_refuses;
  add("texture_denormal", "derivation: a range that has no float for its steps",
      "a mean to half a level of [0, 1]",
      [] { return image(40, 40, 1, [](int x, int y, int) { return 1e-42 * ((x + y) % 5); }); });
  const auto with = [](float odd) {
    return [odd] {
      Image r = levels(5, 90, 70, 3, 255);
      r(61, 33, 1) = odd;
      return r;
    };
  };
  const std::string or_refused = "a refusal, or a mean where the texel is not";
  add("texture_nan", "derivation: one texel spoils every sum behind it", or_refused,
      with(std::numeric_limits<float>::quiet_NaN()))
      .expect = Expect::answers_or_refuses;
  add("texture_infinity", "derivation: the same", or_refused, with(std::numeric_limits<float>::infinity()))
      .expect = Expect::answers_or_refuses;
  return all;
}

}  // namespace treeline::datasets
