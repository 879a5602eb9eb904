// Summed-area tables: their entries against plain loops, exactness where it is promised, the law by which
// floats lose digits, the same bits for any number of threads, and what is refused.
#include "tests/shading/texture_common.hpp"

namespace treeline::shading::texture {
namespace {

struct Size {
  int width, height, channels;
};
/// Smaller and larger than registers and tiles, and no multiples of them.
constexpr Size sizes[] = {{1, 1, 1},   {1, 7, 4},    {5, 1, 3},      {16, 16, 1}, {17, 3, 2},
                          {31, 66, 3}, {100, 70, 4}, {1100, 131, 1}, {700, 70, 3}};

/// Sums of levels by a plain loop.
std::vector<std::int64_t> plain_sums(const Image& image) {
  const int w = image.width, h = image.height, n = image.channels;
  std::vector<std::int64_t> s(static_cast<std::size_t>((w + 1) * (h + 1) * n));
  const auto at = [&](int x, int y, int c) -> std::int64_t& {
    return s[static_cast<std::size_t>((y * (w + 1) + x) * n + c)];
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (int c = 0; c < n; ++c)
        at(x + 1, y + 1, c) =
            at(x, y + 1, c) + at(x + 1, y, c) - at(x, y, c) + std::llround(double(image(x, y, c)) * 65535);
  return s;
}

TEST(TextureTables, EntriesAreThoseOfAPlainLoop) {
  for (const Size& z : sizes) {
    const Image image = random_levels(z.width, z.height, z.channels);
    const auto expected = plain_sums(image);
    const SatInt64 wide(image);
    const SatUint32 narrow(image);
    const SatDouble doubles(image);
    const SatFloat floats(image);
    std::size_t i = 0;
    for (int y = 0; y <= z.height; ++y)
      for (int x = 0; x <= z.width; ++x)
        for (int c = 0; c < z.channels; ++c, ++i) {
          ASSERT_EQ(wide.table().at(x, y)[c], expected[i]) << x << " " << y << " " << c << " of " << z.width;
          ASSERT_EQ(narrow.table().at(x, y)[c], static_cast<std::uint32_t>(expected[i]));
          const double value = double(expected[i]) / 65535;
          ASSERT_NEAR(doubles.table().at(x, y)[c], value, 1e-7 * (1 + value));  // what float makes of a level
          ASSERT_NEAR(double(floats.table().at(x, y)[c]), value, 3e-6 * (1 + value));
        }
  }
}

TEST(TextureTables, ThreadsGiveTheSameBits) {
  for (const Size& z : {Size{1100, 331, 1}, Size{700, 170, 3}, Size{600, 200, 4}, Size{3000, 65, 2}}) {
    const Image image = random_levels(z.width, z.height, z.channels);
    const auto same = [&](const auto& one, const auto& many) {
      for (int y = 0; y <= z.height; ++y)
        for (int i = 0; i <= z.width * z.channels; ++i)
          if (one.table().at(0, y)[i] != many.table().at(0, y)[i]) return false;
      return true;
    };
    for (const int threads : {2, 3, 8}) {
      EXPECT_TRUE(same(SatFloat(image), SatFloat(image, threads)));
      EXPECT_TRUE(same(SatDouble(image), SatDouble(image, threads)));
      EXPECT_TRUE(same(SatCentred(image), SatCentred(image, threads)));
      EXPECT_TRUE(same(SatInt64(image), SatInt64(image, threads)));
      EXPECT_TRUE(same(SatUint32(image), SatUint32(image, threads)));
    }
  }
}

TEST(TextureTables, BuiltAnewTheyAreThoseOfTheNewTexture) {
  SatFloat table(random_levels(50, 40, 3, 1));
  for (const Size& z : {Size{50, 40, 3}, Size{20, 90, 1}}) {
    const Image other = random_levels(z.width, z.height, z.channels, 2);
    table.rebuild(other);
    const SatFloat fresh(other);
    for (int y = 0; y <= z.height; ++y)
      for (int i = 0; i < (z.width + 1) * z.channels; ++i)
        ASSERT_EQ(table.table().at(0, y)[i], fresh.table().at(0, y)[i]);
  }
}

/// Boxes whose borders are anywhere, some across the border of the texture.
std::vector<Box> some_boxes(int width, int height, int n) {
  geometry::Pcg32 random(8);
  std::vector<Box> r;
  for (int k = 0; k < n; ++k) {
    double x = random.uniform(-9.0, width + 9.0), y = random.uniform(-9.0, height + 9.0);
    double w = std::exp2(random.uniform(-3.0, 6.0)), h = std::exp2(random.uniform(-3.0, 6.0));
    if (k % 4 == 0) x = std::floor(x), y = std::floor(y), w = std::ceil(w), h = std::ceil(h);  // whole texels
    r.push_back({x, y, x + w, y + h});
  }
  return r;
}

TEST(TextureTables, ExactTypesAreWithinOneUlpOfBruteForce) {
  for (const Size& z : {Size{300, 200, 1}, Size{120, 90, 3}, Size{64, 200, 4}}) {
    const Image image = random_levels(z.width, z.height, z.channels);
    const BruteForce brute(image);
    const SatInt64 wide(image);
    const SatUint32 narrow(image);
    const SatDouble doubles(image);
    for (const Box& b : some_boxes(z.width, z.height, 500)) {
      const Footprint f = box_footprint(b);
      const auto truth = mean_of(brute, f), a = mean_of(wide, f), n = mean_of(narrow, f),
                 d = mean_of(doubles, f);
      for (std::size_t c = 0; c < truth.size(); ++c) {
        EXPECT_NEAR(double(a[c]), double(truth[c]), ulp_at(truth[c]));
        EXPECT_NEAR(double(n[c]), double(truth[c]), ulp_at(truth[c]));
        EXPECT_NEAR(double(d[c]), double(truth[c]), ulp_at(truth[c]));
      }
    }
  }
}

TEST(TextureTables, WrappingSumsAreExactBeyondTheirRange) {
  // White: every sum is the largest there is. Blocks of more than 65536 texels are summed in pieces.
  const Image white(700, 600, 1, 1.0f);
  const SatUint32 table(white);
  geometry::Pcg32 random(2);
  for (int k = 0; k < 200; ++k) {
    const double x = random.uniform(-50.0, 600.0), y = random.uniform(-50.0, 500.0);
    const Footprint f = box_footprint({x, y, x + random.uniform(1.0, 800.0), y + random.uniform(1.0, 800.0)});
    EXPECT_NEAR(double(mean_of(table, f)[0]), 1.0, 0x1p-23);
  }
  const Image image = random_levels(700, 600, 1, 3);
  const SatUint32 narrow(image);
  const SatInt64 wide(image);
  for (const Box& b :
       {Box{0, 0, 700, 600}, Box{3.5, 2.25, 690.5, 598}, Box{100, 100, 356, 356}, Box{100, 100, 356, 357}})
    EXPECT_NEAR(double(mean_of(narrow, box_footprint(b))[0]), double(mean_of(wide, box_footprint(b))[0]),
                0x1p-23);
}

TEST(TextureTables, AConstantAndAPlaneKeepTheirMean) {
  const Image flat(90, 70, 1, 0.625f);
  const Image tilted = plane(256, 256, 1.0 / 512, 1.0 / 1024, 0.125);
  const SatDouble a(flat), b(tilted);
  const SatFloat c(flat);
  const SatCentred d(flat);
  for (const Box& box : some_boxes(90, 70, 200)) {
    const Footprint f = box_footprint(box);
    EXPECT_EQ(mean_of(a, f)[0], 0.625f);
    EXPECT_NEAR(double(mean_of(c, f)[0]), 0.625,
                4 * 0x1p-23 * 0.625 * 6300 / ((box.x1 - box.x0) * (box.y1 - box.y0)));
    EXPECT_EQ(mean_of(d, f)[0], 0.625f);  // less its mean it is nothing
  }
  geometry::Pcg32 random(4);
  for (int k = 0; k < 200;
       ++k) {  // boxes around texel centres or corners: symmetric, so their mean is the plane there
    const double x = 128 + 0.5 * random.below(40), y = 128 + 0.5 * random.below(40);
    const Footprint f = box_footprint({x - 7.5, y - 4.5, x + 7.5, y + 4.5});
    EXPECT_NEAR(double(mean_of(b, f)[0]), x / 512 + y / 1024 + 0.125, 1e-6);
  }
}

TEST(TextureTables, TilesAddUpToTheWhole) {
  const Image image = random_levels(96, 96, 4, 6);
  const SatInt64 table(image);
  std::vector<double> sums(4);
  geometry::Pcg32 random(1);
  std::vector<double> xs{0, 96}, ys{0, 96};
  for (int k = 0; k < 9; ++k)
    xs.push_back(random.uniform(0.0, 96.0)), ys.push_back(random.uniform(0.0, 96.0));
  std::ranges::sort(xs), std::ranges::sort(ys);
  for (std::size_t j = 0; j + 1 < ys.size(); ++j)
    for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
      const auto m = mean_of(table, box_footprint({xs[i], ys[j], xs[i + 1], ys[j + 1]}));
      for (std::size_t c = 0; c < 4; ++c) sums[c] += double(m[c]) * (xs[i + 1] - xs[i]) * (ys[j + 1] - ys[j]);
    }
  const auto whole = mean_of(table, box_footprint({0, 0, 96, 96}));
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(sums[c] / (96 * 96), double(whole[c]), 1e-6);
}

TEST(TextureTables, FloatsLoseWhatTheLawSays) {
  // In the last quarter a single texel is off by about 0.4 ulp of the sums there. Entries near each other
  // round alike: over a larger box the error falls more slowly than its texels grow, up to five times as
  // slowly at 16².
  const int n = 2048;
  const Image image = random_levels(n, n, 1);
  const SatFloat floats(image);
  const SatInt64 exact(image);
  const SatCentred centred(image);
  geometry::Pcg32 random(7);
  for (const int side : {1, 4, 16}) {
    double sum = 0, middle = 0;
    const int queries = 4000;
    for (int k = 0; k < queries; ++k) {
      const double x = n / 2 + random.below(n / 2 - 16), y = n / 2 + random.below(n / 2 - 16);
      const Footprint f = box_footprint({x, y, x + side, y + side});
      const double truth = double(mean_of(exact, f)[0]);
      const double a = double(mean_of(floats, f)[0]) - truth, b = double(mean_of(centred, f)[0]) - truth;
      sum += a * a, middle += b * b;
    }
    const double law = 0.4 * 0.125 / (side * side);  // the largest sums are below 2^21
    const double rms = std::sqrt(sum / queries), near = std::sqrt(middle / queries);
    EXPECT_GT(rms, 0.4 * law) << side;
    EXPECT_LT(rms, (side == 1 ? 2.5 : 5) * law) << side;
    EXPECT_LT(near, rms / 100) << side;  // sums of what is left grow with the square root
  }
}

/// The largest error of the variance of a plane over 9 x 9 texels in the last quarter, which is (a² + b²) 80
/// / 12.
template <class Sat>
double variance_error(int n) {
  const double a = 1.0 / 8192, b = 1.0 / 16384;
  Image moments(n, n, 2);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const float z = static_cast<float>(a * x + b * y + 0.25);  // a float as it is
      moments(x, y, 0) = z, moments(x, y, 1) = static_cast<float>(double(z) * double(z));
    }
  const Sat table(moments);
  const double variance = (a * a + b * b) * 80 / 12;
  double worst = 0;
  for (int y = n / 2; y + 9 < n; y += 13)
    for (int x = n / 2; x + 9 < n; x += 13) {
      double m[most_channels] = {};
      table.box_mean(Box{double(x), double(y), x + 9.0, y + 9.0}, m);
      worst = std::max(worst, std::abs(m[1] - m[0] * m[0] - variance));
    }
  return worst;
}

TEST(TextureTables, VariancesNeedDouble) {
  EXPECT_LT(variance_error<SatDouble>(1024), 5e-8);  // what float makes of the squares themselves
  EXPECT_GT(variance_error<SatFloat>(1024), 5e-5);
  EXPECT_GT(variance_error<SatFloat>(1024), 100 * variance_error<SatDouble>(1024));
  EXPECT_LT(variance_error<SatCentred>(1024), 0.5 * variance_error<SatFloat>(1024));
}

TEST(TextureTables, OtherRangesAreRoundedToTheirLevels) {
  Image image = random_levels(60, 60, 2, 3);
  for (float& v : image.values) v = 1000 * v * v - 300;
  const SatInt64 table(image);
  const SatUint32 narrow(image);
  const BruteForce brute(image);
  const double step = table.sums().levels.step();
  EXPECT_NEAR(step, 1000.0 / 65535, 1e-4);
  for (const Box& b : some_boxes(60, 60, 200)) {
    const Footprint f = box_footprint(b);
    const auto truth = mean_of(brute, f), a = mean_of(table, f), c = mean_of(narrow, f);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR(double(a[k]), double(truth[k]), 0.52 * step + 1e-4);
      EXPECT_EQ(a[k], c[k]);
    }
  }
}

TEST(TextureTables, RotatedDiscsAndBellsGetTheBoxOfTheirVariances) {
  const Box turned = fitted_box(rotated_box(10, 20, 6, 2, std::numbers::pi / 2));
  EXPECT_NEAR(turned.x1 - turned.x0, 4, 1e-9);
  EXPECT_NEAR(turned.y1 - turned.y0, 12, 1e-9);
  const Box oblique = fitted_box(rotated_box(0, 0, 6, 2, std::numbers::pi / 4));
  EXPECT_NEAR(oblique.x1, std::sqrt(0.5 * (36 + 4)), 1e-9);
  EXPECT_NEAR(fitted_box(disc_footprint(0, 0, 4)).x1, std::sqrt(3 * 16 / 4.0), 1e-9);
  EXPECT_NEAR(fitted_box(gaussian_footprint(0, 0, 4, 1)).x1, std::sqrt(3 * 0.97333692 * 16), 1e-6);
}

template <class Make>
std::string refusal(Make&& make) {
  try {
    make();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "accepted";
}

TEST(TextureTables, WhatHasNoSumsIsRefused) {
  Image image = random_levels(20, 10, 3);
  image(7, 4, 2) = NAN;
  for (const auto& said : {refusal([&] { SatFloat t(image); }), refusal([&] { SatDouble t(image); }),
                           refusal([&] { SatCentred t(image); }), refusal([&] { SatInt64 t(image); }),
                           refusal([&] { SatUint32 t(image); }), refusal([&] { BruteForce t(image); }),
                           refusal([&] { Trilinear t(image); })})
    EXPECT_NE(said.find("texel (7, 4), channel 2"), std::string::npos) << said;
  image(7, 4, 2) = INFINITY;
  EXPECT_NE(refusal([&] { SatUint32 t(image); }).find("texel (7, 4)"), std::string::npos);
  EXPECT_NE(refusal([&] { SatFloat t(Image(8, 8, 1, 3e38f)); }).find("range"), std::string::npos);
  EXPECT_EQ(refusal([&] { SatDouble t(Image(8, 8, 1, 3e38f)); }), "accepted");
  EXPECT_EQ(refusal([&] { SatInt64 t(Image(8, 8, 1, 3e38f)); }), "accepted");
  double mean[most_channels] = {};  // of one value there are no levels between
  SatInt64(Image(8, 8, 1, 5.0f)).box_mean(Box{1.0, 1.5, 4.0, 5.0}, mean);
  EXPECT_EQ(mean[0], 5);
  SatUint32(Image(8, 8, 1, 6.0f)).box_mean(Box{1.0, 1.5, 4.0, 5.0}, mean);
  EXPECT_EQ(mean[0], 6);
  EXPECT_NE(refusal([&] { SatFloat t(Image(0, 8, 1)); }).find("0 x 8"), std::string::npos);
  EXPECT_NE(refusal([&] { SatFloat t(Image(8, 8, 5)); }).find("5 channels"), std::string::npos);
  Image torn(8, 8, 1);
  torn.values.pop_back();
  EXPECT_NE(refusal([&] { SatFloat t(torn); }).find("63 values"), std::string::npos);
  EXPECT_NE(refusal([&] { SatFloat t(Image(8, 8, 1), 0); }).find("threads"), std::string::npos);
  const SatFloat table(Image(8, 8, 2));
  std::vector<float> room(3);
  const std::vector<Footprint> two(2);
  EXPECT_THROW(means(table, two, room), accel::InvalidInput);
}

TEST(TextureTables, BatchesAreTheSingleAnswersForAnyThreads) {
  const Image image = random_levels(200, 100, 3);
  const SatFloat table(image);
  std::vector<Footprint> asked;
  for (const Box& b : some_boxes(200, 100, 1000)) asked.push_back(box_footprint(b));
  std::vector<float> one(3000), many(3000);
  means(table, asked, one, 1);
  means(table, asked, many, 4);
  EXPECT_EQ(one, many);
  for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_EQ(one[3 * i + 1], mean_of(table, asked[i])[1]);
}

}  // namespace
}  // namespace treeline::shading::texture
