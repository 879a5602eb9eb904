// Textures: what their names promise, and images through files.
#include "files_common.hpp"

#include <cmath>
#include <map>

#include "datasets_gen/textures/independent.hpp"

namespace treeline::datasets {
namespace {

using shading::Image;

double mean(const Image& image) {
  double sum = 0;
  for (const float v : image.values) sum += double(v);
  return sum / double(image.values.size());
}

TEST(Textures, AreSquareAndHashedWithTheirSides) {
  Dataset d = generate("noise", 10'000, 1);
  EXPECT_EQ(d.image.width, 100);
  EXPECT_EQ(d.image.height, 100);
  EXPECT_EQ(d.image.channels, 1);
  Dataset other = d;
  other.image.width = 50, other.image.height = 200;
  EXPECT_NE(d.hash(), other.hash());
  other = d;
  other.image.values[77] = std::nextafter(other.image.values[77], 2.0f);
  EXPECT_NE(d.hash(), other.hash());
  EXPECT_EQ(generate("marble", 1000, 1).image.channels, 4);
  EXPECT_EQ(generate("noise", 1 << 24, 1).size(), std::size_t{1} << 24);  // larger than clouds may be
  EXPECT_THROW(generate("noise", (std::size_t{1} << 26) + 1, 1), std::invalid_argument);
  EXPECT_THROW(generate("noise+hole_2", 10'000, 1), std::invalid_argument);
}

TEST(Textures, HoldLevelsWhereTheySaySo) {
  for (const char* name : {"noise", "checkers", "mask", "star", "marble"})
    for (const float v : generate(name, 20'000, 3).image.values) {
      const float level = std::floor(v * 255 + 0.5f);
      ASSERT_EQ(level / 255.0f, v) << name;
    }
}

TEST(Textures, NoiseIsUniform) {
  const Image image = generate("noise", 1 << 18, 1).image;
  const double n = double(image.values.size());
  EXPECT_LT(std::abs(mean(image) - 0.5), 4 * std::sqrt(1 / 12.0 / n));
}

/// How a pixel's first channel goes with that (dx, dy) away: the correlation, in deviations of what
/// independent pixels have.
double correlation(const Image& image, int dx, int dy) {
  double sum = 0, squares = 0, n = 0, all = 0, count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) all += double(image(x, y)), ++count;
  const double middle = all / count;
  for (int y = 0; y + dy < image.height; ++y)
    for (int x = 0; x + dx < image.width; ++x) {
      const double a = double(image(x, y)) - middle, b = double(image(x + dx, y + dy)) - middle;
      sum += a * b, squares += a * a, ++n;
    }
  return sum / squares * std::sqrt(n);
}

TEST(Textures, PixelsAreIndependentWhereTheRecipeSaysSo) {
  int independent = 0;
  for (const Recipe& recipe : recipes()) {
    if (recipe.kind != Kind::image) {
      EXPECT_FALSE(pixels_are_independent(recipe.name)) << recipe.name;
      continue;
    }
    const Image image = generate(recipe.name, 1 << 18, 1).image;
    double most = 0;
    for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {1, 1}, {7, 0}, {0, 7}})
      most = std::max(most, std::abs(correlation(image, dx, dy)));
    EXPECT_EQ(pixels_are_independent(recipe.name), most < 4) << recipe.name << " " << most;
    for (const float v : image.values) EXPECT_GE(v, 0.0f);
    independent += pixels_are_independent(recipe.name);
  }
  EXPECT_GE(independent, 1);
  EXPECT_FALSE(pixels_are_independent("noise.png"));
}

TEST(Textures, RampIsAPlane) {
  const Image image = generate("ramp", 256 * 256, 1).image;
  EXPECT_NEAR(mean(image), 0.5, 1e-6);
  for (int y = 1; y < 255; ++y)
    for (int x = 1; x < 255; ++x) ASSERT_NEAR(image(x - 1, y) + image(x + 1, y), 2 * image(x, y), 3e-7);
  EXPECT_GT(image(255, 0) - image(0, 0), 0.25f);
  EXPECT_GT(image(0, 255) - image(0, 0), 0.25f);
}

TEST(Textures, MaskIsBlackAndWhiteInPiecesLargerThanAPixel) {
  const Image image = generate("mask", 1 << 18, 1).image;
  EXPECT_GT(mean(image), 0.1);
  EXPECT_LT(mean(image), 0.5);
  std::size_t edges = 0;
  for (std::size_t i = 1; i < image.values.size(); ++i) {
    ASSERT_TRUE(image.values[i] == 0 || image.values[i] == 1);
    edges += image.values[i] != image.values[i - 1];
  }
  EXPECT_GT(edges, image.values.size() / 100);
  EXPECT_LT(edges, image.values.size() / 4);
}

TEST(Textures, CheckersHaveTheirWidths) {
  const Image image = generate("checkers", 512 * 512, 1).image;
  for (int x = 1; x < 128; ++x)
    ASSERT_NE(image(x, 5), image(x - 1, 5));  // the first board's squares: one pixel
  int edges = 0;
  for (int x = 385; x < 512; ++x) edges += image(x, 500) != image(x - 1, 500);  // the last one's: 64
  EXPECT_GE(edges, 1);
  EXPECT_LE(edges, 3);
}

TEST(Textures, StarHasEveryFrequency) {
  const Image image = generate("star", 512 * 512, 1).image;
  const auto changes = [&](int y, int from, int to) {
    double sum = 0;
    for (int x = from; x < to; ++x) sum += std::abs(double(image(x, y)) - double(image(x - 1, y)));
    return sum / (to - from);
  };
  EXPECT_GT(changes(256, 490, 511), 0.5);  // rings: at the border almost every pixel is another
  EXPECT_LT(changes(256, 386, 396), 0.5);
  EXPECT_GT(changes(356, 240, 272), 0.15);  // spokes, some six pixels apart here
  EXPECT_LT(changes(356, 240, 272), 0.45);
}

class Images : public FolderTest {};

TEST_F(Images, AreReadBackBitForBit) {
#ifndef TREELINE_HAVE_OPENIMAGEIO
  GTEST_SKIP();
#endif
  for (const char* name : {"noise", "ramp", "mask", "marble"})
    for (const std::string extension : {"png", "exr"}) {
      const Dataset made = generate(name, 2500, 5);
      const auto path = folder() / (name + ("." + extension));
      if (extension == "png" && std::string(name) == "ramp") {
        EXPECT_THROW(write(made, path), FileError);  // its floats are between the levels
        EXPECT_FALSE(std::filesystem::exists(path));
        continue;
      }
      write(made, path);
      std::ifstream in(path, std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(in), {}};
      const std::string undated("capDate\0string\0\0\0\0\0", 19);  // EXR: a text of no characters
      EXPECT_EQ(bytes.find("capDate"), bytes.find(undated)) << path << ": equal images are equal files";
      EXPECT_EQ(bytes.find("tIME"), std::string::npos) << path;
      const Dataset again = read(path);
      EXPECT_EQ(again.kind, Kind::image);
      EXPECT_EQ(again.hash(), made.hash()) << path;
      EXPECT_EQ(again.name, path.filename());
      EXPECT_THROW(write(made, path), FileError);  // exists already
    }
  Dataset fine = generate("noise", 2500, 5);
  for (std::size_t i = 0; i < fine.image.values.size(); ++i) fine.image.values[i] = float(i * 26) / 65535.0f;
  write(fine, folder() / "fine.png");
  EXPECT_EQ(read(folder() / "fine.png").hash(), fine.hash());  // 16 bits
  EXPECT_THROW(write(fine, folder() / "fine.ply"), FileError);
  EXPECT_THROW(write(fine, folder() / "fine.jpg"), FileError);
}

TEST_F(Images, ThatAreNoneAreRefusedInWords) {
#ifndef TREELINE_HAVE_OPENIMAGEIO
  GTEST_SKIP();
#endif
  const auto said = [&](const std::filesystem::path& path) {
    try {
      read(path);
    } catch (const FileError& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  for (const char* name : {"text.png", "text.exr", "text.jpg", "text.hdr", "text.tif"})
    EXPECT_NE(said(put(name, "this is no image at all, whatever its name may say\n")).find(name),
              std::string::npos)
        << name;
  EXPECT_NE(said(put("empty.png", "")).find("empty"), std::string::npos);
  EXPECT_NE(said(folder() / "absent.exr").find("no such file"), std::string::npos);
  const Dataset made = generate("noise", 40'000, 1);
  write(made, folder() / "whole.png");
  std::ifstream in(folder() / "whole.png", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(said(put("half.png", bytes.substr(0, bytes.size() / 2))), "accepted");
  Dataset odd = generate("ramp", 2500, 1);
  odd.image(31, 7) = NAN, odd.image(3, 9) = INFINITY;
  write(odd, folder() / "odd.exr");
  const std::string why = said(folder() / "odd.exr");
  EXPECT_NE(why.find("pixel (31, 7)"), std::string::npos) << why;
  EXPECT_NE(why.find("of 2 such"), std::string::npos) << why;
  // A header that asks for more than there may be.
  std::string huge = "P6\n60000 60000\n255\n";
  EXPECT_NE(said(put("huge.ppm", huge + std::string(100, 'x'))).find("2^28"), std::string::npos)
      << said(folder() / "huge.ppm");
}

}  // namespace
}  // namespace treeline::datasets
