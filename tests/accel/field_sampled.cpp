// Distance fields sampled from meshes: against every face looked at and winding numbers, and laws that need
// no truth.
#include <map>

#include "tests/accel/field_common.hpp"

namespace treeline::accel::field::test {
namespace {

const std::map<std::string, Mesh3f>& meshes() {
  static const std::map<std::string, Mesh3f> all{
      {"sphere", accel::test::sphere<float>(3)},
      {"box", turned_box({1, 0.6, 0.4})},
      {"plate", turned_box({1, 0.8, 0.02})},
      {"nested", nested(2)},
      {"far", accel::test::sphere<float>(2, {1000, -2000, 500}, 3)},
      {"needle", turned_box({1, 0.004, 0.004})}};
  return all;
}

TEST(SampledField, SamplesAreTheDistances) {
  for (const auto& [name, mesh] : meshes()) {
    const Tree tree(mesh);
    const auto s = sample_mesh<BrickSamples>(mesh, tree, options(24));
    const Lattice& l = s.lattice();
    EXPECT_TRUE(s.report().certain()) << name;
    Pcg32 random(3);
    std::size_t known = 0;
    for (int n = 0; n < 4000; ++n) {
      const int i = int(random.below(std::uint32_t(l.samples(0)))),
                j = int(random.below(std::uint32_t(l.samples(1)))),
                k = int(random.below(std::uint32_t(l.samples(2))));
      const double value = s.value(i, j, k), truth = true_distance(mesh, l.position(i, j, k));
      if (std::abs(value) < double(float(s.widths().far))) {
        ASSERT_NEAR(value, truth, s.widths().rounding) << name << " " << i << " " << j << " " << k;
        ++known;
      } else {
        ASSERT_GE(std::abs(truth), s.widths().far - s.widths().rounding) << name;
        ASSERT_EQ(value < 0, truth < 0) << name << " " << i << " " << j << " " << k;
      }
    }
    EXPECT_GT(known, 100u) << name;
  }
}

TEST(SampledField, DenseEqualsBricksBitForBit) {
  for (const auto& [name, mesh] : meshes()) {
    const Tree tree(mesh);
    const auto bricks = sample_mesh<BrickSamples>(mesh, tree, options(20));
    const auto dense = sample_mesh<DenseSamples>(mesh, tree, options(20, 3, 3));  // threads, too
    ASSERT_EQ(bricks.lattice(), dense.lattice());
    ASSERT_EQ(bricks.table(), dense.table()) << name;
    for (int k = 0; k < dense.lattice().samples(2); ++k)
      for (int j = 0; j < dense.lattice().samples(1); ++j)
        for (int i = 0; i < dense.lattice().samples(0); ++i)
          ASSERT_EQ(std::bit_cast<std::uint32_t>(bricks.value(i, j, k)),
                    std::bit_cast<std::uint32_t>(dense.value(i, j, k)))
              << name << " " << i << " " << j << " " << k;
    const Trilinear a(bricks);
    const Trilinear b(dense);
    const Tricubic c(bricks);
    const Tricubic d(dense);
    Pcg32 random(4);
    const Box3d around = dense.lattice().cells_of({-1, -1, -1}, {5, 5, 5});
    for (int n = 0; n < 20000; ++n) {
      const Vec3d p = in_box(random, around);
      ASSERT_EQ(a.distance(p), b.distance(p));
      ASSERT_EQ(c.distance(p), d.distance(p));
      ASSERT_EQ(c.gradient(p), d.gradient(p));
    }
  }
}

/// A look-up is off by no more than it says; what is not known is no less; and in the band all is known.
template <class Field>
void expect_bounds(const std::string& name, const Mesh3f& mesh, const Field& field, int count,
                   std::uint64_t seed) {
  Pcg32 random(seed);
  const Lattice& l = field.samples().lattice();
  const double band = field.samples().widths().band, pad = 12 * l.spacing;
  Box3d around = field.bounds();
  around.low -= Vec3d::filled(pad), around.high += Vec3d::filled(pad);
  int known = 0;
  for (int n = 0; n < count; ++n) {
    // Half of them near the surface: where a face is, and a few cells away.
    Vec3d p = in_box(random, around);
    if (n % 2) {
      const Triangle3d t(mesh.triangle(random.below(std::uint32_t(mesh.size()))));
      const double a = random.uniform(), b = random.uniform() * (1 - a);
      p = t.a + (t.b - t.a) * a + (t.c - t.a) * b;
      for (int k = 0; k < 3; ++k) p[k] += random.uniform(-4.0, 4.0) * l.spacing;
    }
    const FieldSample s = field.sample(p);
    const double truth = true_distance(mesh, p);
    if (s.known) {
      ++known;
      ASSERT_LE(std::abs(s.distance - truth), s.error) << name << ": " << p[0] << " " << p[1] << " " << p[2];
    } else {
      ASSERT_GT(std::abs(truth), band) << name;
      ASSERT_LE(std::abs(s.distance), std::abs(truth)) << name;
      ASSERT_EQ(s.distance < 0, truth < 0) << name;
    }
    ASSERT_LE(s.clearance(), std::abs(truth)) << name;
  }
  EXPECT_GT(known, count / 8) << name;
}

TEST(SampledField, ErrorsAreWithinTheirBounds) {
  std::uint64_t seed = 0;
  for (const auto& [name, mesh] : meshes()) {
    const Tree tree(mesh);
    const auto s = sample_mesh<BrickSamples>(mesh, tree, options(name == "plate" ? 30 : 17));
    // 10^5 points where looking at every face is cheap.
    const int count = mesh.size() < 20 ? 100000 : 4000;
    expect_bounds(name, mesh, Trilinear(s), count, ++seed);
    expect_bounds(name, mesh, Tricubic(s), count / 4, ++seed);
  }
}

TEST(SampledField, EverywhereKnown) {
  const Mesh3f mesh = turned_box({1, 0.6, 0.4});
  const auto s =
      sample_mesh<DenseSamples>(mesh, Tree(mesh), options(17, std::numeric_limits<double>::infinity()));
  EXPECT_EQ(s.report().known_samples, s.lattice().sample_count());
  const Trilinear field(s);
  EXPECT_TRUE(field.sample({}).known);
  EXPECT_LE(std::abs(field.distance({}) + 0.4), field.sample({}).error);
  Pcg32 random(5);
  for (int n = 0; n < 50000; ++n) {
    const Vec3d p = in_box(random, s.lattice().cells_of({0, 0, 0}, s.lattice().bricks));
    const FieldSample f = field.sample(p);
    const double truth = true_distance(mesh, p);
    if (f.known)
      ASSERT_LE(std::abs(f.distance - truth), f.error);
    else
      ASSERT_LE(f.distance, truth);
  }
}

/// Largest error near a sphere, between its mesh and the sphere itself nothing to speak of.
template <template <class> class Field>
double error_at(int resolution, double band, double* bound = nullptr) {
  // Edges of up to 0.02: the mesh stays within 0.02² / 6 = 7e-5 of the sphere.
  static const Mesh3f mesh = accel::test::sphere<float>(7);
  static const Tree tree(mesh);
  const auto s = sample_mesh<BrickSamples>(mesh, tree, options(resolution, band, 2));
  const Field<BrickSamples> field(s);
  Pcg32 random(6);
  const Sphere truth;
  double worst = 0;
  if (bound != nullptr) *bound = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3d p = normalized(in_box(random, {{-1, -1, -1}, {1, 1, 1}})) * random.uniform(0.9, 1.1);
    const FieldSample f = field.sample(p);
    EXPECT_TRUE(f.known);
    worst = std::max(worst, std::abs(f.distance - truth.distance(p)));
    if (bound != nullptr) *bound = std::max(*bound, f.error);
  }
  return worst;
}

// Theory: trilinear h² / 8 times the second derivatives, which are 1 / radius: 2 h² / 8; cubic h³ or better.
TEST(SampledField, ErrorsFallAsTheoryHasIt) {
  const double coarse = error_at<Trilinear>(16, 3), fine = error_at<Trilinear>(32, 3);
  EXPECT_NEAR(coarse / fine, 4, 0.6);
  const double h = 2.0 / 32;
  EXPECT_LT(fine, 1.2 * h * h / 4 / 0.9);
  EXPECT_GT(error_at<Tricubic>(5, 3) / error_at<Tricubic>(10, 3), 7);
}

// The bound's constant depends on the width of the band alone, so that it falls as fast.
TEST(SampledField, BoundsFallWithTheSquareOfTheSpacing) {
  double coarse, fine;
  error_at<Trilinear>(16, 3, &coarse), error_at<Trilinear>(32, 6, &fine);
  EXPECT_LT(coarse, 0.5 * 0.866 * 2.0 / 16);  // half of what any 1-Lipschitz function has
  EXPECT_GT(coarse / fine, 3);
}

template <class Field>
void expect_gradient(const Field& field, double far) {
  Pcg32 random(8);
  const double e = 1e-6;
  int smooth = 0;
  for (int n = 0; n < 5000; ++n) {
    const Vec3d p = normalized(in_box(random, {{-1, -1, -1}, {1, 1, 1}})) * random.uniform(1 - far, 1 + far);
    const Vec3d gradient = field.gradient(p);
    Vec3d forward, backward;
    for (int k = 0; k < 3; ++k) {
      Vec3d step{};
      step[k] = e;
      forward[k] = (field.distance(p + step) - field.distance(p)) / e;
      backward[k] = (field.distance(p) - field.distance(p - step)) / e;
    }
    if (distance(forward, backward) > 1e-3) continue;  // a cell's side
    ++smooth;
    ASSERT_LT(distance(gradient, (forward + backward) * 0.5), 1e-3);
    ASSERT_LE(length(gradient), field.lipschitz());
    ASSERT_NEAR(length(gradient), 1, 0.05);
  }
  EXPECT_GT(smooth, 4900);
}

TEST(SampledField, GradientsAreTheLimitsOfDifferences) {
  const Mesh3f mesh = accel::test::sphere<float>(5);
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(24));
  expect_gradient(Trilinear(s), 0.15);
  expect_gradient(Tricubic(s), 0.15);
  EXPECT_EQ(Trilinear(s).gradient({50, 0, 0}), Vec3d{});
}

TEST(SampledField, OpenMeshesAreTold) {
  Mesh3f mesh = accel::test::sphere<float>(4);
  const Vec3d hole = normalized(Vec3d{1, 2, 0.5});
  std::erase_if(mesh.faces, [&](const auto& f) { return dot(Vec3d(mesh.vertices[f[0]]), hole) > 0.8; });
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(40));
  EXPECT_FALSE(s.report().closed);
  EXPECT_GT(s.report().sign_conflicts, 0u);  // somewhere across the hole
  EXPECT_FALSE(s.report().certain());
  // Both are the hole's doing: signs away from it are right.
  const Lattice& l = s.lattice();
  const auto along = [&](int i, int j, int k) { return dot(normalized(l.position(i, j, k)), hole); };
  const auto& first = s.report().first_conflict;
  EXPECT_GT(along(first[0], first[1], first[2]), 0.5);
  for (int k = 0; k < l.samples(2); ++k)
    for (int j = 0; j < l.samples(1); ++j)
      for (int i = 0; i < l.samples(0); ++i)
        if (const double r = length(l.position(i, j, k)); along(i, j, k) < 0.4 && std::abs(r - 1) > 0.01) {
          ASSERT_EQ(s.value(i, j, k) < 0, r < 1) << i << " " << j << " " << k;
        }
}

TEST(SampledField, ClosednessGoesByPositions) {
  Mesh3f mesh = accel::test::sphere<float>(2);
  EXPECT_TRUE(is_closed_cycle(mesh));
  Mesh3f soup;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const auto t = mesh.triangle(i);
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    soup.vertices.insert(soup.vertices.end(), {t.a, t.b, t.c});
    soup.faces.push_back({first, first + 1, first + 2});
  }
  EXPECT_TRUE(is_closed_cycle(soup));
  std::swap(soup.faces[5][0], soup.faces[5][1]);
  EXPECT_FALSE(is_closed_cycle(soup));
  mesh.faces.pop_back();
  EXPECT_FALSE(is_closed_cycle(mesh));
}

/// What the message of a refusal must say.
template <class F>
void expect_refusal(F&& f, const std::string& words) {
  try {
    f();
    ADD_FAILURE() << "not refused: " << words;
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

TEST(SampledField, RefusesWhatItCannotHold) {
  const Mesh3f mesh = accel::test::sphere<float>(1);
  const Tree tree(mesh);
  const auto with = [&](auto&& change) {
    FieldOptions o;
    change(o);
    return [&, o] { sample_mesh<BrickSamples>(mesh, tree, o); };
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(with([](auto& o) { o.resolution = 0; }), "resolution is 0");
  expect_refusal(with([](auto& o) { o.resolution = -3; }), "resolution is -3");
  expect_refusal(with([&](auto& o) { o.spacing = nan; }), "spacing is nan");
  expect_refusal(with([](auto& o) { o.spacing = -1; }), "spacing is -1");
  expect_refusal(with([&](auto& o) { o.band = nan; }), "band is nan");
  expect_refusal(with([](auto& o) { o.band = 0; }), "band is 0");
  expect_refusal(with([](auto& o) { o.threads = 0; }), "threads is 0");
  for (const int support : {0, 3, -1})
    expect_refusal(with([=](auto& o) { o.support = static_cast<Support>(support); }),
                   "support is " + std::to_string(support));
  expect_refusal(with([](auto& o) { o.spacing = 1e-30; }), "no room for more than 2^20");
  expect_refusal(with([](auto& o) { o.spacing = 1e300; }), "the spacing 1e+300");
  expect_refusal(with([](auto& o) { o.spacing = 1e39; }), "beyond single precision");
  expect_refusal(with([](auto& o) { o.resolution = 1 << 19; }), "bytes");
  expect_refusal(with([](auto& o) { o.max_bytes = 100000; }), "max_bytes is 100000");
  // Dense: 1024³ samples and more.
  expect_refusal([&] { sample_mesh<DenseSamples>(mesh, tree, options(1024)); }, "bytes");
  const Mesh3f huge = accel::test::sphere<float>(1, {}, 3e38f);
  const Tree over_huge(huge);
  expect_refusal([&] { sample_mesh<BrickSamples>(huge, over_huge, options(16)); }, "coordinate is 3e+38");
  const Mesh3f none;
  const Tree empty(none);
  expect_refusal([&] { sample_mesh<BrickSamples>(none, empty); }, "no triangles");
  Mesh3f point;
  point.vertices = {{1, 1, 1}}, point.faces = {{0, 0, 0}};
  const Tree degenerate(point);
  expect_refusal([&] { sample_mesh<BrickSamples>(point, degenerate); }, "single point");
  FieldOptions narrow;
  narrow.support = Support::trilinear;
  const auto s = sample_mesh<BrickSamples>(mesh, tree, narrow);
  EXPECT_NO_THROW(Trilinear{s});
  expect_refusal([&] { Tricubic{s}; }, "tricubic");
}

TEST(SampledField, NaNIsAnsweredByNaN) {
  const Mesh3f mesh = accel::test::sphere<float>(2);
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(16));
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    Vec3d p{};
    p[k] = nan;
    EXPECT_TRUE(std::isnan(Trilinear(s).distance(p)));
    EXPECT_EQ(Trilinear(s).sample(p).clearance(), 0);
    p[k] = inf;
    EXPECT_EQ(Tricubic(s).distance(p), inf);
  }
}

TEST(SampledField, LowerBoundsAreFiniteWhereverThePointIs) {
  const Mesh3f mesh = accel::test::sphere<float>(2);
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(16));
  const Trilinear field(s);
  for (const double far : {1e100, 1e154, 1e155, 1e200, 1e308}) {
    const double found = field.distance({far, 0, 0});
    EXPECT_LE(found, far);
    EXPECT_GE(found, far * (1 - 1e-14));
  }
  EXPECT_LT(field.distance({1e308, -1.7e308, 1.7e308}), std::numeric_limits<double>::infinity());
  EXPECT_GT(field.distance({1e308, -1.7e308, 1.7e308}), 1.7e308);
}

// Of two fields that are off by something, too: where neither is known, the distance less the error is a
// bound.
TEST(SampledField, WhatIsMadeOfSampledFieldsKeepsItsBounds) {
  const Mesh3f mesh = turned_box({1, 0.6, 0.4});
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(17));
  const Trilinear field(s);
  const Sphere ball{{0.8, 0, 0}, 0.5};
  const Union both{field, ball};
  const Difference without{field, ball};
  Pcg32 random(12);
  int unknown_with_error = 0;
  for (int n = 0; n < 40000; ++n) {
    const Vec3d p = in_box(random, {{-2, -2, -2}, {2, 2, 2}});
    const double a = true_distance(mesh, p), b = ball.distance(p);
    const FieldSample u = both.sample(p), d = without.sample(p);
    if (u.known) {
      ASSERT_LE(std::abs(u.distance - std::min(a, b)), u.error);
    } else if (std::abs(u.distance) > u.error) {
      ASSERT_EQ(u.distance < 0, std::min(a, b) < 0);
    }
    ASSERT_LE(u.clearance(), std::abs(std::min(a, b)));
    ASSERT_LE(d.clearance(), std::abs(std::max(a, -b)));
    unknown_with_error += !u.known && u.error > 0;
  }
  EXPECT_GT(unknown_with_error, 1000);
}

// A blend wider than the band takes distances for what they are not where one of them is a lower bound only.
TEST(SampledField, SmoothUnionsKeepTheirBoundsWhereADistanceIsNotKnown) {
  const Mesh3f mesh = turned_box({1, 0.6, 0.4});
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(17));
  const Trilinear field(s);
  const Sphere ball{{0.3, 0, 2}, 0.5};
  const SmoothUnion both{field, ball, 2.0};
  Pcg32 random(13);
  int off = 0, certain = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3d p = in_box(random, {{-2, -2, -2}, {2, 2, 3}});
    const double a = true_distance(mesh, p), b = ball.distance(p),
                 near = std::max(2 - std::abs(a - b), 0.0) / 2;
    const double truth = std::min(a, b) - 0.5 * near * near;
    const FieldSample f = both.sample(p);
    ASSERT_EQ(f.distance, both.distance(p));
    ASSERT_LE(f.clearance(), std::abs(truth) * (1 + 1e-14));
    if (f.clearance() > 0) {
      ASSERT_EQ(f.distance < 0, truth < 0);
    }
    off += (f.distance < 0) != (truth < 0), certain += f.clearance() > 0;
  }
  EXPECT_GT(off, 100);
  EXPECT_GT(certain, 10000);
}

/// By how much the gradient changes across the lattice's planes, at most and on the average, in the band.
template <class Field>
std::pair<double, double> gradient_jump(const Field& field) {
  const Lattice& l = field.samples().lattice();
  Pcg32 random(14);
  double most = 0, sum = 0;
  int count = 0;
  while (count < 5000) {
    Vec3d p = normalized(in_box(random, {{-1, -1, -1}, {1, 1, 1}})) * random.uniform(0.9, 1.1);
    const int axis = static_cast<int>(random.below(3));
    p[axis] = l.origin[axis] + l.spacing * std::round((p[axis] - l.origin[axis]) / l.spacing);
    Vec3d before = p, after = p;
    before[axis] -= 1e-9, after[axis] += 1e-9;
    if (!field.sample(before).known || !field.sample(after).known) continue;
    const double jump = distance(field.gradient(before), field.gradient(after));
    most = std::max(most, jump), sum += jump, ++count;
  }
  return {most, sum / count};
}

// Across cells and bricks alike: a tricubic look-up's gradient is continuous, a trilinear one's is not.
TEST(SampledField, TricubicGradientsAreContinuous) {
  const Mesh3f mesh = accel::test::sphere<float>(4);
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(24));
  EXPECT_LT(gradient_jump(Tricubic(s)).first, 1e-6);  // 2e-9 times second derivatives of some tens
  EXPECT_GT(gradient_jump(Trilinear(s)).second, 1e-3);
}

TEST(SampledField, AnInsidePolicyOfOnesOwn) {
  const Mesh3f mesh = nested(2);
  const Tree tree(mesh);
  const InsideBy sign([&](const Vec3f& p) { return winding(mesh, Vec3d(p)) > 0.5; });
  const auto a = sample_mesh<DenseSamples>(mesh, tree, sign, options(20));
  const auto b = sample_mesh<DenseSamples>(mesh, tree, options(20));
  for (int k = 0; k < b.lattice().samples(2); ++k)
    for (int j = 0; j < b.lattice().samples(1); ++j)
      for (int i = 0; i < b.lattice().samples(0); ++i) ASSERT_EQ(a.value(i, j, k), b.value(i, j, k));
}

}  // namespace
}  // namespace treeline::accel::field::test
