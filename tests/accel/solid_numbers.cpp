// Solids: volumes of whole numbers, sizes, rays and options at and out of range, and the integers that
// decide.
#include <gtest/gtest.h>

#include "accel/bsp_solid.hpp"
#include "tests/geometry/meshes.hpp"

namespace treeline::test {
namespace {

using namespace treeline::accel;

// A tetrahedron of a sixth of two on whole coordinates of 24 bits: in double its volume is rounding alone.
TEST(Solid, VolumesOfVerticesAreExact) {
  Mesh3d thin;
  thin.vertices = {{-8469008, -1795903, -12625725},
                   {9843560, -13449334, -1940666},
                   {-13651106, -7840006, 2658134},
                   {1213274, -13818509, 4510094}};
  thin.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  Mesh3d turned = thin;
  for (auto& f : turned.faces) std::swap(f[0], f[1]);
  SolidOptions options;
  options.grid.spacing = 1;
  const auto volume_of = [&](const Mesh3d& m) { return BspTree<Solid<>>(m, options).volume(); };
  double found = 0;
  int refused = 0;
  for (const Mesh3d& m : {thin, turned}) try {
      found = volume_of(m);
    } catch (const NotASolid&) {
      ++refused;
    }
  EXPECT_EQ(refused, 1);
  EXPECT_DOUBLE_EQ(found, 2.0 / 6);
}

// Of extents from 2^-890 to 2^890, whose volumes a double may not hold.
TEST(Solid, OfAnySizeAreTheSame) {
  Mesh3d turned = cube<double>(1);
  for (auto& f : turned.faces) std::swap(f[0], f[1]);
  for (const double scale : {0x1p-890, 1e-108, 1e-103, 1e100, 0x1p890}) {
    const BspTree<Solid<>> tree(moved(cube<double>(1), {}, scale));
    EXPECT_TRUE(tree.contains({0.4 * scale, -0.4 * scale, 0.3 * scale})) << scale;
    EXPECT_FALSE(tree.contains({0.4 * scale, -0.4 * scale, 1.3 * scale})) << scale;
    if (const double v = 8 * scale * scale * scale; std::isnormal(v)) {
      EXPECT_NEAR(tree.volume() / v, 1, 1e-6);
    }
    EXPECT_THROW(BspTree<Solid<>>(moved(turned, {}, scale)), NotASolid) << scale;
  }
}

TEST(Solid, RefusesOptionsOutOfRange) {
  const Mesh3d m = cube<double>(1);
  const auto told = [&](auto&& change) -> std::string {
    SolidOptions o;
    change(o);
    try {
      BspTree<Solid<>> tree(m, o);
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "taken";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(told([](auto& o) { o.sample = 0; }).find("sample is 0"), std::string::npos);
  EXPECT_NE(told([](auto& o) { o.candidates = -1; }).find("candidates is -1"), std::string::npos);
  EXPECT_NE(told([](auto& o) { o.axis_levels = -1; }).find("axis_levels is -1"), std::string::npos);
  EXPECT_NE(told([&](auto& o) { o.split_cost = nan; }).find("split_cost is"), std::string::npos);
  for (const double spacing : {0.1, -1.0, nan, std::numeric_limits<double>::infinity()})
    EXPECT_NE(told([&](auto& o) { o.grid.spacing = spacing; }).find("grid.spacing is"), std::string::npos);
  EXPECT_EQ(told([](auto& o) { o.grid.spacing = 0.125; }), "taken");
  Mesh3d wrong = m;
  wrong.faces[2][1] = 99;
  try {
    BspTree<Solid<>> tree(wrong, {});
    FAIL() << "taken";
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("face 2 names vertex 99"), std::string::npos);
  }
}

TEST(Solid, RaysOfAnyLengthAndNoOthers) {
  const BspTree<Solid<>> tree(sphere<double>(2));
  const Rayd ray{{-3, 0.1, 0.2}, {1, 0.1, 0}};
  const double t = tree.closest_hit(ray).t;
  for (const int exponent : {-1000, -665, 3, 665, 1000}) {
    Rayd other = ray;
    other.direction = ray.direction * std::ldexp(1.0, exponent);
    other.t_max = std::ldexp(2 * t, -exponent);
    EXPECT_EQ(tree.closest_hit(other).t, std::ldexp(t, -exponent)) << exponent;
    other.t_min = std::ldexp(3 * t, -exponent), other.t_max = INFINITY;
    EXPECT_FALSE(tree.closest_hit(other)) << exponent;
  }
  EXPECT_NEAR(tree.closest_hit({{-3, 0.1, 0.2}, {1e-200, 0, 0}}).t / 1e200, 2.025, 0.05);
  for (const Rayd& bad : {Rayd{{0, 0, 0}, {1, 0, 0}, NAN, 1}, Rayd{{0, 0, 0}, {1, 0, 0}, 0, NAN},
                          Rayd{{0, 0, 0}, {0, 0, 0}}, Rayd{{NAN, 0, 0}, {1, 0, 0}}})
    EXPECT_THROW(tree.closest_hit(bad), InvalidInput);
}

TEST(WideInteger, CalculatesLikeDyadics) {
  using solid::Int128;
  using solid::Int256;
  Pcg32 random(8);
  const auto number = [&](int bits) {
    const Int128 x = Int128(random.next64()) << 40 ^ Int128(random.next64());
    return (random.below(2) == 0 ? x : -x) >> (104 - bits);
  };
  const auto dyadic = [](Int128 x) {
    const bool negative = x < 0;
    solid::Unsigned128 u = negative ? -solid::Unsigned128(x) : solid::Unsigned128(x);
    Dyadic r, unit(1);
    for (; u != 0; u >>= 32, unit = unit * Dyadic(0x1p32))
      r += unit * Dyadic(double(static_cast<std::uint32_t>(u)));
    return negative ? -r : r;
  };
  for (int i = 0; i < 3000; ++i) {
    const Int128 a = number(90), b = number(100), c = number(50), d = i % 3 == 0 ? a : number(90),
                 e = i % 3 == 0 ? b : number(100);
    const Int256 x = (Int256(a) * b - Int256(d) * e) * c;
    const Dyadic y = (dyadic(a) * dyadic(b) - dyadic(d) * dyadic(e)) * dyadic(c);
    ASSERT_EQ(x.sign(), y.sign());
    ASSERT_EQ((-x + x).sign(), 0);
    if (y.sign() != 0) {
      const auto s = y.scaled();
      ASSERT_NEAR(x.rounded() / std::ldexp(s.digits, s.exponent), 1, 0x1p-50);
    }
  }
}

}  // namespace
}  // namespace treeline::test
