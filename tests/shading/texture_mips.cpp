// Mip chains and what probes make of them: levels against plain means, squares that they know exactly, and
// the errors on a mask that make a bias and probes worth while.
#include "tests/shading/texture_common.hpp"

namespace treeline::shading::texture {
namespace {

TEST(TextureMips, LevelsAreMeansOverTheirShareOfTheTexture) {
  for (const auto& [w, h, n] : {std::array{64, 32, 1},
                                {256, 256, 2},
                                {64, 64, 4},
                                {48, 96, 3},
                                {37, 21, 1},
                                {1, 9, 4},
                                {255, 100, 2}}) {
    const Image image = random_levels(w, h, n);
    const MipChain chain(image);
    const BruteForce brute(image);
    EXPECT_EQ(chain.level(chain.levels() - 1).width, 1);
    EXPECT_EQ(chain.level(chain.levels() - 1).height, 1);
    for (int l = 0; l < chain.levels(); ++l) {
      const auto& level = chain.level(l);
      const double sx = double(w) / level.width, sy = double(h) / level.height;
      // Where a side is odd a level's texels overlap those of the level before: their means are not those of
      // the texture's own area from the second such level on.
      if (l > 1 && ((w & (w - 1)) || (h & (h - 1)))) break;
      for (int y = 0; y < level.height; ++y)
        for (int x = 0; x < level.width; ++x) {
          const auto truth = mean_of(brute, box_footprint({x * sx, y * sy, (x + 1) * sx, (y + 1) * sy}));
          for (int c = 0; c < n; ++c)
            ASSERT_NEAR(double(chain.texel(level, x, y)[c]), double(truth[std::size_t(c)]), 1e-6)
                << w << " " << l << " " << x << " " << y;
        }
    }
  }
}

TEST(TextureMips, ABatchIsAnsweredAsItsFootprintsAreOneByOne) {
  const Image image = random_levels(200, 120, 2);
  const Trilinear trilinear(image, best_bias);
  std::vector<Footprint> asked;
  for (int i = 0; i < 300; ++i)  // more than are looked up together, and no multiple of it
    asked.push_back(rotated_box(0.7 * i, 0.4 * i, 0.1 * i, 0.03 * i, 0.37 * i));
  std::vector<float> all(2 * asked.size()), one(2);
  means(trilinear, asked, all);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    trilinear.mean(asked[i], one.data());
    EXPECT_EQ(one[0], all[2 * i]) << i;
    EXPECT_EQ(one[1], all[2 * i + 1]) << i;
  }
}

// Levels of more than half a MiB, which most here are looked up in, are too large for the caches: places are
// found first and read afterwards. Each must be what it is by itself.
/// By registers, where the finest level that a block reads is up to 8 MiB; of larger ones, all places of a
/// block are fetched first.
TEST(TextureMips, BlocksOfLookUpsAreThoseOneByOne) {
  for (const auto& [width, height, large] : {std::tuple(701, 503, false), {1511, 1409, true}})
    for (const int n : {1, 2, 3, 4}) {
      const auto chain = std::make_shared<const MipChain>(random_levels(width, height, n));
      ASSERT_EQ(sizeof(float) * std::size_t(width * height * n) > std::size_t{1} << 23, large);
      geometry::Pcg32 random(8);
      std::vector<Footprint> asked;
      for (int i = 0; i < 1000; ++i) {
        const double size =
            std::exp2(random.uniform(-3.0, 10.0)) * (i % 16 ? 1 : 1e-3);  // some of a texel's size
        asked.push_back(rotated_box(random.uniform(-50.0, width + 50.0), random.uniform(-50.0, height + 50.0),
                                    size, random.uniform(0.1, 1.0) * size, random.uniform(0.0, 7.0)));
      }
      for (const double bias : {0.0, best_bias}) {
        std::vector<float> found(asked.size() * std::size_t(n)), alone(found.size());
        means(Trilinear(chain, bias), asked, found);
        with_channels(n, [&](auto channels) {
          for (std::size_t i = 0; i < asked.size(); ++i)
            mip::add_trilinear<channels>(*chain, float(asked[i].x), float(asked[i].y),
                                         0.5f * mip::log2_of(mip::longer_squared(asked[i])) + float(bias), 1,
                                         alone.data() + i * std::size_t(n));
        });
        EXPECT_EQ(found, alone) << width << ' ' << n << ' ' << bias;
      }
    }
}

TEST(TextureMips, LogarithmsAreNear) {
  for (int e = -20; e < 30; ++e) {
    EXPECT_EQ(mip::log2_of(std::ldexp(1.0f, e)), static_cast<float>(e));
    for (int i = 1; i < 1000; ++i) {
      const float x = std::ldexp(1 + 0.001f * static_cast<float>(i), e);
      EXPECT_NEAR(double(mip::log2_of(x)), std::log2(double(x)), 7e-7 + 1e-7 * std::abs(e)) << x;
    }
  }
}

TEST(TextureMips, OddSidesLoseNoWeight) {
  const Image image = random_levels(117, 53, 1);
  const MipChain chain(image);
  double whole = 0;
  for (const float v : image.values) whole += double(v);
  whole /= double(image.values.size());
  for (int l = 0; l < chain.levels(); ++l) {
    const auto& level = chain.level(l);
    double sum = 0;
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x) sum += double(chain.texel(level, x, y)[0]);
    EXPECT_NEAR(sum / (level.width * level.height), whole, 1e-6) << l;
  }
}

TEST(TextureMips, ThreadsGiveTheSameBits) {
  for (const int n : {1, 3, 4}) {
    const Image image = random_levels(517, 640, n);
    const MipChain one(image), many(image, 4);
    for (int l = 0; l < one.levels(); ++l) {
      const auto& level = one.level(l);
      for (int y = 0; y < level.height; ++y)
        for (int i = 0; i < level.width * n; ++i)
          ASSERT_EQ(one.texel(level, 0, y)[i], many.texel(level, 0, y)[i]);
    }
  }
}

TEST(TextureMips, SquaresOfWholeLevelsAreExact) {
  const Image image = random_levels(256, 256, 1);
  const Trilinear mips(image);
  const BruteForce brute(image);
  for (int side = 1; side <= 256; side *= 2)
    for (int y = 0; y < 256; y += std::max(side, 32))
      for (int x = 0; x < 256; x += std::max(side, 32)) {
        const Footprint f = box_footprint({double(x), double(y), double(x + side), double(y + side)});
        EXPECT_NEAR(double(mean_of(mips, f)[0]), double(mean_of(brute, f)[0]), 1e-6) << side;
      }
}

TEST(TextureMips, AConstantStaysAndAPlaneKeepsItsValueInside) {
  const Image flat(77, 50, 3, 0.3f), tilted = plane(256, 256, 1.0 / 512, -1.0 / 1024, 0.5);
  geometry::Pcg32 random(2);
  const Trilinear a(flat), b(tilted, best_bias);
  const MultiProbe c(flat), d(tilted, 4);
  const Anisotropic e(flat), g(tilted);
  for (int k = 0; k < 300; ++k) {
    const double turn = random.uniform(0.0, 7.0);
    const Footprint anywhere = rotated_box(random.uniform(-20.0, 100.0), random.uniform(-20.0, 70.0),
                                           random.uniform(0.2, 30.0), random.uniform(0.2, 30.0), turn);
    EXPECT_NEAR(double(mean_of(a, anywhere)[1]), 0.3, 1e-6);
    EXPECT_NEAR(double(mean_of(c, anywhere)[2]), 0.3, 1e-6);
    EXPECT_NEAR(double(mean_of(e, anywhere)[0]), 0.3, 1e-6);
    // Every probe's kernel is symmetric, so that a plane keeps its value, away from the border.
    const double x = random.uniform(100.0, 156.0), y = random.uniform(100.0, 156.0);
    const Footprint inside = rotated_box(x, y, random.uniform(0.5, 12.0), random.uniform(0.5, 12.0), turn);
    const double truth = x / 512 - y / 1024 + 0.5;
    EXPECT_NEAR(double(mean_of(b, inside)[0]), truth, 2e-6);
    EXPECT_NEAR(double(mean_of(d, inside)[0]), truth, 2e-6);
    EXPECT_NEAR(double(mean_of(g, inside)[0]), truth, 2e-6);
  }
}

/// Discs of random places and sizes in black and white.
Image blobs() {
  Image r(512, 512, 1);
  geometry::Pcg32 random(11);
  for (int k = 0; k < 900; ++k) {
    const double x = random.uniform(0.0, 512.0), y = random.uniform(0.0, 512.0),
                 radius = random.uniform(2.0, 12.0);
    for (int j = std::max(0, int(y - radius)); j < std::min(512.0, y + radius); ++j)
      for (int i = std::max(0, int(x - radius)); i < std::min(512.0, x + radius); ++i)
        if (std::hypot(i + 0.5 - x, j + 0.5 - y) < radius) r(i, j) = k % 2 ? 1.0f : 0.0f;
  }
  return r;
}

template <class A>
double rms(const A& averager, const BruteForce& brute, double a, double b) {
  geometry::Pcg32 random(12);
  double sum = 0;
  const int n = 1000;
  for (int k = 0; k < n; ++k) {
    const double x = random.uniform(40.0, 472.0), y = random.uniform(40.0, 472.0);
    const Footprint f = box_footprint({x - a, y - b, x + a, y + b});
    const double error = double(mean_of(averager, f)[0]) - double(mean_of(brute, f)[0]);
    sum += error * error;
  }
  return std::sqrt(sum / n);
}

TEST(TextureMips, ABiasHelpsAndProbesHalveWhatIsLeft) {
  const Image image = blobs();
  const BruteForce brute(image);
  const double plain = rms(Trilinear(image), brute, 12, 12),
               biased = rms(Trilinear(image, best_bias), brute, 12, 12),
               four = rms(MultiProbe(image, 2), brute, 12, 12),
               sixteen = rms(MultiProbe(image, 4), brute, 12, 12);
  EXPECT_LT(biased, 0.7 * plain);
  EXPECT_LT(four, 0.6 * biased);
  EXPECT_LT(sixteen, 0.7 * four);
}

TEST(TextureMips, RectanglesNeedProbesAlongTheirAxis) {
  const Image image = blobs();
  const BruteForce brute(image);
  const double square = rms(Trilinear(image, best_bias), brute, 32, 2),
               along = rms(Anisotropic(image), brute, 32, 2);
  EXPECT_LT(along, 0.1 * square);
  EXPECT_NEAR(rms(Anisotropic(image), brute, 2, 32), along, 0.5 * along);  // whichever axis is the longer one
}

TEST(TextureMips, OptionsOutOfRangeAreRefused) {
  const Image image(4, 4, 1);
  EXPECT_THROW(MultiProbe(image, 0), InvalidTexture);
  EXPECT_THROW(Anisotropic(image, 1000), InvalidTexture);
  EXPECT_THROW(MipChain(image, 0), accel::InvalidInput);
}

TEST(TextureMips, NothingIsReadOutsideAndNoSizeBreaks) {
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 300}, {3, 2}, {129, 1}}) {
    const Image image(w, h, 2, 0.5f);
    const Trilinear a(image);
    const MultiProbe b(image);
    const Anisotropic c(image);
    const Nearest d(image);
    const SatFloat e(image);
    const BruteForce g(image);
    for (const double size : {1e-9, 0.3, 5.0, 1000.0, 1e6})
      for (const double at : {-1e6, -3.0, 0.0, 0.5, 1.0, 1e6}) {
        const Footprint f = box_footprint({at - size, at - 2 * size, at + size, at + 2 * size});
        for (const float m : {mean_of(a, f)[1], mean_of(b, f)[1], mean_of(c, f)[1], mean_of(d, f)[1],
                              mean_of(e, f)[1], mean_of(g, f)[1]})
          EXPECT_NEAR(double(m), 0.5, 1e-4) << w << " " << h << " " << size << " " << at;
      }
  }
}

}  // namespace
}  // namespace treeline::shading::texture
