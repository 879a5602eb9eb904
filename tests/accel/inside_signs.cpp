// Signed distances and the rules for broken meshes: closed forms, the exact oracle, refusals.
#include "accel/signed_distance.hpp"
#include "geometry/adjacency.hpp"
#include "tests/accel/inside_meshes.hpp"

namespace treeline::accel::test {
namespace {

using WideTree = Bvh<Triangles<float>, Wide>;
using geometry::Vec3d;

/// Signed distance to a box: closed form.
double box_distance(const Vec3d& p, const Vec3d& half) {
  Vec3d out;
  double deepest = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double d = std::abs(p[k]) - half[k];
    out[k] = std::max(d, 0.0), deepest = std::max(deepest, d);
  }
  return length(out) + std::min(deepest, 0.0);
}

template <class Tree>
class SignedDistances : public testing::Test {};
using Trees = testing::Types<Bvh<Triangles<float>>, KdTree<Triangles<float>>, BspTree<Triangles<float>>,
                             BruteForce<Triangles<float>>, WideTree, Bvh<Triangles<double>>,
                             BruteForce<Triangles<double>>>;
TYPED_TEST_SUITE(SignedDistances, Trees);

template <class Tree, class Sign>
void expect_box() {
  using T = typename Tree::Scalar;
  Mesh<T> mesh;
  add_box(mesh, Box<T, 3>{{-1, -2, -3}, {1, 2, 3}});
  const SignedDistance<Tree, Sign> body(mesh);
  Pcg32 random(31);
  std::vector<Vec<T, 3>> points;
  for (int i = 0; i < 400; ++i) points.push_back(in_cube(random, T(4)));
  points.push_back({1, 0.5, 0}), points.push_back({1, 2, 3}), points.push_back({-1, 0, -3});  // on it
  std::vector<T> out(points.size()), again(points.size());
  std::vector<std::uint8_t> inside(points.size());
  body.signed_distance(points, out, 1), body.signed_distance(points, again, 2),
      body.inside(points, inside, 1);
  EXPECT_EQ(out, again);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double expected = box_distance(Vec3d(points[i]), {1, 2, 3});
    ASSERT_NEAR(double(out[i]), expected, 8 * double(std::numeric_limits<T>::epsilon())) << i;
    ASSERT_EQ(inside[i] != 0, expected <= 0) << i;
    ASSERT_EQ(body.signed_distance(points[i]), out[i]);
  }
}
TYPED_TEST(SignedDistances, OfABox) {
  expect_box<TypeParam, FirstHit>(), expect_box<TypeParam, Pseudonormal>(), expect_box<TypeParam, Winding>();
}

TYPED_TEST(SignedDistances, RefuseWhatHasNoAnswer) {
  using T = typename TypeParam::Scalar;
  Mesh<T> mesh;
  add_box(mesh, Box<T, 3>{{-1, -1, -1}, {1, 1, 1}});
  const SignedDistance<TypeParam, Pseudonormal> body(mesh);
  const Vec<T, 3> bad{0, std::numeric_limits<T>::quiet_NaN(), 0};
  EXPECT_THROW(body.inside(bad), InvalidInput);
  EXPECT_THROW(body.signed_distance(bad), InvalidInput);
  std::vector<Vec<T, 3>> points{{0, 0, 0}, bad};
  std::vector<std::uint8_t> inside(2), little(1);
  std::vector<T> out(2);
  EXPECT_THROW(body.inside(points, inside, 1), InvalidInput);
  EXPECT_THROW(body.signed_distance(points, out, 1), InvalidInput);
  points.pop_back();
  EXPECT_THROW(body.inside(points, inside, 1), InvalidInput);
  EXPECT_THROW(body.inside(points, little, 0), InvalidInput);
  mesh.faces[3][1] = 99;
  EXPECT_THROW((SignedDistance<TypeParam, Pseudonormal>(mesh)), InvalidInput);
}

TYPED_TEST(SignedDistances, RefuseWhatCannotBeBuilt) {
  using T = typename TypeParam::Scalar;
  Mesh<T> mesh;
  add_box(mesh, Box<T, 3>{{-1, -1, -1}, {1, 1, 1}});
  const auto build = [&]<class Sign>(Sign, const Mesh<T>& of, int threads) {
    SignedDistance<TypeParam, Sign>(of, TypeParam(mesh), {}, threads);
  };
  for (const int threads : {0, -1}) {
    EXPECT_THROW(build(FirstHit{}, mesh, threads), InvalidInput);
    EXPECT_THROW(build(Pseudonormal{}, mesh, threads), InvalidInput);
    EXPECT_THROW(build(Winding{}, mesh, threads), InvalidInput);
    EXPECT_THROW(build(Winding{}, Mesh<T>{}, threads), InvalidInput);
    const SignedDistance<TypeParam> body(mesh);
    EXPECT_THROW(body.inside({}, {}, threads), InvalidInput);
    EXPECT_THROW(body.signed_distance({}, {}, threads), InvalidInput);
  }
  Mesh<T> bad = mesh;
  bad.faces[3][1] = 99;
  EXPECT_THROW(build(FirstHit{}, bad, 1), InvalidInput);
  EXPECT_THROW(build(Pseudonormal{}, bad, 1), InvalidInput);
  EXPECT_THROW(build(Winding{}, bad, 1), InvalidInput);
}

// A corner that is not finite takes its faces with it: a hole is left, which only Winding stands, and which
// closed() tells of. Faces that hang on the mesh leave nothing when they go.
TYPED_TEST(SignedDistances, FacesThatAreDroppedAreMissing) {
  using T = typename TypeParam::Scalar;
  const Mesh<T> whole = sphere<T>(3);
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity()}) {
    Mesh<T> mesh = whole, open = whole, hanging = whole;
    const std::uint32_t lost = mesh.faces[7][0];
    mesh.vertices[lost][1] = bad;
    std::erase_if(open.faces,
                  [&](const auto& f) { return std::ranges::find(f, lost) != std::ranges::end(f); });
    hanging.vertices.push_back({bad, bad, 0});
    hanging.faces.push_back({0, 1, static_cast<std::uint32_t>(whole.vertices.size())});
    using Options = typename TypeParam::Options;
    Options drop;
    drop.non_finite = NonFinite::drop;
    EXPECT_THROW((SignedDistance<TypeParam, Winding>(mesh)), InvalidInput);
    const SignedDistance<TypeParam, Winding> body(mesh, drop), same(open), fine(hanging, drop);
    const SignedDistance<TypeParam> by_ray(mesh, drop);
    EXPECT_FALSE(body.closed() || body.oriented() || by_ray.closed() || by_ray.oriented());
    EXPECT_TRUE(fine.closed() && fine.oriented());
    Pcg32 random(32);
    for (int i = 0; i < 300; ++i) {
      const Vec<T, 3> p = in_cube(random, T(2));
      ASSERT_EQ(body.signed_distance(p), same.signed_distance(p));
      if (std::abs(length(p) - 1) < T(0.1)) continue;
      ASSERT_EQ(fine.inside(p), length(p) < 1);
      const bool by_the_hole = length(p - whole.vertices[lost]) < T(0.3);
      ASSERT_TRUE(by_the_hole || body.inside(p) == (length(p) < 1));
    }
  }
}

// A mesh and points scaled by a power of two have distances scaled by it, also where their squares vanish or
// overflow.
TYPED_TEST(SignedDistances, AreTheSameAtAnySize) {
  using T = typename TypeParam::Scalar;
  const Mesh<T> mesh = sphere<T>(2);
  const SignedDistance<TypeParam, Pseudonormal> plain(mesh);
  const int exponents[] = {-20, -30, -60, -90, 40, 90, -200, -400, 600};
  for (const int exponent : exponents) {
    if (std::abs(exponent) > std::numeric_limits<T>::max_exponent * 3 / 4) continue;
    Mesh<T> scaled = mesh;
    for (auto& p : scaled.vertices)
      for (int k = 0; k < 3; ++k) p[k] = std::ldexp(p[k], exponent);
    const SignedDistance<TypeParam, Pseudonormal> body(scaled);
    Pcg32 random(33);
    std::vector<Vec<T, 3>> points;
    std::vector<T> expected;
    for (int i = 0; i < 100; ++i) {
      Vec<T, 3> p = in_cube(random, T(1.5));
      if (i % 2 == 0) {  // near a face
        const auto t = mesh.triangle(random.below(static_cast<std::uint32_t>(mesh.size())));
        p = (t.a + t.b + t.c) / T(3) + p * T(1e-3);
      }
      expected.push_back(std::ldexp(plain.signed_distance(p), exponent));
      for (int k = 0; k < 3; ++k) p[k] = std::ldexp(p[k], exponent);
      points.push_back(p);
    }
    std::vector<T> out(points.size());
    body.signed_distance(points, out, 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const T slack = std::ldexp(8 * std::numeric_limits<T>::epsilon(), exponent);
      ASSERT_NEAR(out[i], expected[i], slack) << exponent << " " << i;
      ASSERT_NE(out[i], 0) << exponent << " " << i;
      ASSERT_EQ(body.signed_distance(points[i]), out[i]);
    }
  }
}

// From afar all of a small mesh is as near to the last digits.
TYPED_TEST(SignedDistances, OutsideOfTheBoxNothingIsInside) {
  using T = typename TypeParam::Scalar;
  for (const T size : {T(1e-30), T(1e-12), T(1)}) {
    Mesh<T> mesh = sphere<T>(2);
    for (auto& p : mesh.vertices) p = p * size;
    const SignedDistance<TypeParam, Pseudonormal> body(mesh);
    Pcg32 random(34);
    for (int i = 0; i < 300; ++i) {
      const Vec<T, 3> p = in_cube(random, T(2));
      if (length(p) <= T(1.1) * size) continue;
      ASSERT_FALSE(body.inside(p)) << size << " " << i;
      ASSERT_GT(body.signed_distance(p), 0) << size << " " << i;
    }
    EXPECT_TRUE(body.inside({0, 0, 0}));
  }
  // A sheet has two sides, however far.
  Mesh<T> sheet{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const SignedDistance<TypeParam, Pseudonormal> open(sheet);
  EXPECT_TRUE(open.inside({0, 0, -5}));
  EXPECT_FALSE(open.inside({0, 0, 5}));
}

TYPED_TEST(SignedDistances, OfNothing) {
  using T = typename TypeParam::Scalar;
  const SignedDistance<TypeParam, Pseudonormal> nothing(Mesh<T>{});
  EXPECT_TRUE(nothing.closed());
  EXPECT_FALSE(nothing.inside({0, 0, 0}));
  EXPECT_EQ(nothing.signed_distance({0, 0, 0}), std::numeric_limits<T>::infinity());
  const SignedDistance<TypeParam, Winding> nor_this(Mesh<T>{});
  EXPECT_FALSE(nor_this.inside({0, 0, 0}));
}

// A spike whose faces' planes lie on both sides of points above its tip: face normals give the wrong sign
// there, angle-weighted ones do not (Baerentzen and Aanaes 2005, figure 2).
TEST(Pseudonormals, AreRightEverywhere) {
  for (const Mesh3f& mesh : {bumpy(3, 1), shells()}) {
    const SignedDistance<Bvh<Triangles<double>>, Pseudonormal> body([&] {
      Mesh<double> m;
      for (const auto& p : mesh.vertices) m.vertices.push_back(Vec3d(p));
      m.faces = mesh.faces;
      return m;
    }());
    const SignedDistance<WideTree, Pseudonormal> wide(mesh);
    std::size_t by_feature[3] = {};
    for (const Point3f& p : points_about(mesh, 4000, 41)) {
      ASSERT_EQ(body.inside(Vec3d(p)), truth_of(mesh, p).inside());
      ASSERT_EQ(wide.inside(p), truth_of(mesh, p).inside());
      const int feature = static_cast<int>(body.tree().closest_point(Vec3d(p)).feature);
      ++by_feature[feature == 0 ? 0 : feature < 4 ? 1 : 2];
    }
    for (const std::size_t n : by_feature) EXPECT_GT(n, 50u);
  }
}

TEST(Pseudonormals, OfACorner) {
  Mesh3f mesh;
  add_box(mesh, {{0, 0, 0}, {1, 1, 1}});
  const PseudonormalTable<float> table(mesh);
  for (std::size_t f = 0; f < mesh.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      // Whichever way the sides are cut in two, a corner's normal is the space diagonal.
      const Vec3d p(mesh.vertices[mesh.faces[f][i]]), n = table.vertex_normal(f, i);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(n[k], (2 * p[k] - 1) / std::sqrt(3), 1e-15);
    }
}

// Faces without area, of both kinds: two corners in one place, and three on a line. They close the mesh and
// have no normal.
TEST(Pseudonormals, FacesWithoutAreaHaveNone) {
  Mesh3f mesh;
  add_box(mesh, {{-1, -1, -1}, {1, 1, 1}});
  const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
  // The first face a b c becomes a b m, m b c with m on c a; c a m closes the slit.
  const auto [a, b, c] = mesh.faces[0];
  mesh.vertices.push_back(mesh.vertices[a] * 0.75f + mesh.vertices[c] * 0.25f);
  mesh.faces[0] = {a, b, middle};
  mesh.faces.push_back({middle, b, c}), mesh.faces.push_back({a, middle, c});
  const auto twin = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto [d, e, f] = mesh.faces[5];
  mesh.vertices.push_back(mesh.vertices[d]);
  mesh.faces[5] = {twin, e, f};
  mesh.faces.push_back({d, e, twin}), mesh.faces.push_back({d, twin, f});
  ASSERT_TRUE(geometry::Adjacency(mesh).closed());
  const SignedDistance<BruteForce<Triangles<float>>, Pseudonormal> body(mesh);
  const SignedDistance<Bvh<Triangles<float>>, Pseudonormal> tree(mesh);
  const SignedDistance<WideTree, Pseudonormal> wide(mesh);
  ASSERT_TRUE(body.closed() && body.oriented());
  Pcg32 random(43);
  for (int i = 0; i < 4000; ++i) {
    Point3f p = in_cube(random, 1.5f);
    if (i % 2 == 0) p = mesh.vertices[i % 4 == 0 ? middle : twin] + in_cube(random, 0.125f);
    const double d = box_distance(Vec3d(p), {1, 1, 1});
    ASSERT_EQ(body.inside(p), d <= 0) << p[0] << " " << p[1] << " " << p[2];
    ASSERT_EQ(tree.inside(p), d <= 0);
    ASSERT_EQ(wide.inside(p), d <= 0);
  }
}

// Faces that a tree leaves out leave no trace in the normals of the others.
TEST(Pseudonormals, FacesThatAreNotFiniteAreLeftOut) {
  const Mesh3f mesh = bumpy(2, 1);
  Mesh3f spoiled = mesh;
  const auto first = static_cast<std::uint32_t>(spoiled.vertices.size());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 40; ++i) spoiled.vertices.push_back({nan, static_cast<float>(i % 3), nan});
  for (std::uint32_t i = 0; i < 40; ++i) spoiled.faces.push_back({first + i, i, i + 1});
  using Brute = BruteForce<Triangles<float>>;
  EXPECT_THROW((SignedDistance<Brute, Pseudonormal>(spoiled)), InvalidInput);
  const SignedDistance<Brute, Pseudonormal> one(mesh), other(spoiled, {.non_finite = NonFinite::drop});
  for (const Point3f& p : points_about(mesh, 500, 45)) ASSERT_EQ(one.inside(p), other.inside(p));
}

TEST(Pseudonormals, SoupsAreWelded) {
  const Mesh3f mesh = bumpy(2, 1);
  Mesh3f soup;
  for (std::size_t f = 0; f < mesh.size(); ++f) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : mesh.faces[f]) soup.vertices.push_back(mesh.vertices[v]);
    soup.faces.push_back({first, first + 1, first + 2});
  }
  const SignedDistance<BruteForce<Triangles<float>>, Pseudonormal> one(mesh), other(soup);
  EXPECT_TRUE(other.closed() && other.oriented());
  for (const Point3f& p : points_about(mesh, 1000, 44)) ASSERT_EQ(one.inside(p), other.inside(p));
}

// ---- winding numbers -----------------------------------------------------------------------------------

TEST(Windings, AreWholeNumbersForClosedMeshes) {
  Mesh3f mesh = shells();
  append(mesh, bumpy(2, 6, {0.05f, 0, 0}, 0.125f));  // winds twice
  const WindingTree<float> exact(mesh, std::numeric_limits<double>::infinity(), 1), near(mesh, 2, 1),
      nearer(mesh, 4, 1);
  std::vector<Triangle<double>> triangles;
  for (const auto& t : triangles_of(mesh)) triangles.push_back(Triangle<double>(t));
  const Bvh<Triangles<double>> surface{std::span<const Triangle<double>>(triangles)};
  double worst = 0, worst_nearer = 0;
  int most = 0;
  for (const Point3f& p : points_about(mesh, 2000, 51)) {
    const Truth truth = truth_of(mesh, p);
    const WindingNumber w = exact(p);
    ASSERT_EQ(w.on_surface, truth.on);
    if (truth.on) continue;
    // The angle turns by a rounding over the square of how far the face's edges are, in its own lengths.
    const double d2 = surface.closest_point(Vec3d(p)).distance2;
    ASSERT_NEAR(w.value, truth.winding, 1e-15 * (1 + 1 / d2));
    worst = std::max(worst, std::abs(near(p).value - truth.winding));
    worst_nearer = std::max(worst_nearer, std::abs(nearer(p).value - truth.winding));
    most = std::max(most, truth.winding);
  }
  EXPECT_EQ(most, 2);
  EXPECT_LT(worst, 0.02);
  EXPECT_LT(worst_nearer, worst / 4);  // of third order in 1 / reach
  EXPECT_GT(worst, 1e-6);
}

TEST(Windings, OfAnOpenMeshIsItsSolidAngle) {
  Mesh3f mesh;  // a square of side 2 seen from above its middle at height h: closed form
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  const WindingTree<float> tree(mesh, std::numeric_limits<double>::infinity(), 1);
  for (const float h : {0.125f, 1.f, 16.f}) {
    const double solid = 4 * std::asin(1 / (1 + double(h) * h));
    EXPECT_NEAR(tree({0.0f, 0.0f, -h}).value, solid / (4 * std::numbers::pi), 1e-12);
    EXPECT_NEAR(tree({0.0f, 0.0f, h}).value, -solid / (4 * std::numbers::pi), 1e-12);
  }
  EXPECT_TRUE(tree({0.5f, 0.25f, 0}).on_surface);
  EXPECT_FALSE((SignedDistance<WideTree, Winding>(mesh).closed()));
}

// A group's moments against the sum over its faces, at every size that float holds.
TEST(Windings, FarGroupsKeepTheirRange) {
  for (const float scale : {0x1p-60f, 1.f, 0x1p60f}) {
    Mesh3f mesh = bumpy(3, 7, {}, scale);
    mesh.faces.resize(mesh.size() / 3);  // open: the number varies
    const WindingTree<float> exact(mesh, std::numeric_limits<double>::infinity(), 1), fast(mesh, 2, 1);
    Pcg32 random(53);
    for (int i = 0; i < 300; ++i) {
      const Point3f p = in_cube(random, 4 * scale);
      ASSERT_NEAR(exact(p).value, fast(p).value, 5e-3);
    }
  }
}

/// A ball of doubles, and points about it that are clearly in or out, by the number of radii to its middle.
template <class Check>
void each_about_a_ball(const Vec3d& middle, double radius, Check&& check) {
  Mesh<double> mesh = sphere<double>(3);
  for (Vec3d& p : mesh.vertices) p = p * radius + middle;
  const SignedDistance<Bvh<Triangles<double>>, Winding> body(mesh);
  const WindingTree<double> sum(mesh, std::numeric_limits<double>::infinity(), 1);
  Pcg32 random(55);
  for (int i = 0; i < 300; ++i) {
    const Vec3d p = in_cube(random, 2.0);
    if (std::abs(length(p) - 1) > 0.1) check(body, sum, p * radius + middle, length(p) < 1);
  }
}

// What is kept of coordinates far from the origin in float is not enough to tell groups apart.
TEST(Windings, OfDoublesFarFromTheOrigin) {
  for (const double offset : {0.0, 1e3, 5e6, 1e9, 1e12, -1e15})
    for (const double radius : {1024.0, 1.0, 0.01, 1e-4}) {
      if (std::abs(offset) * 0x1p-52 > 1e-3 * radius) continue;  // no ball is left of it
      for (const Vec3d& middle : {Vec3d{offset, offset, offset}, Vec3d{0, offset, -offset}})
        each_about_a_ball(middle, radius, [&](const auto& body, const auto& sum, const Vec3d& q, bool in) {
          ASSERT_EQ(body.inside(q), in) << offset << " " << radius;
          ASSERT_NEAR(body.rule().winding()(q).value, in ? 1 : 0, 0.02) << offset << " " << radius;
          ASSERT_NEAR(sum(q).value, in ? 1 : 0, 1e-9) << offset << " " << radius;
        });
    }
}
TEST(Windings, OfDoublesOfAnySize) {
  for (const double radius : {1e-300, 1e-150, 1e-80, 1e-37, 1e37, 1e80, 1e150, 1e300, 1e307})
    each_about_a_ball({}, radius, [&](const auto& body, const auto& sum, const Vec3d& q, bool in) {
      ASSERT_EQ(body.inside(q), in) << radius;
      ASSERT_NEAR(body.rule().winding()(q).value, in ? 1 : 0, 0.02) << radius;
      ASSERT_NEAR(sum(q).value, in ? 1 : 0, 1e-12) << radius;
    });
}
// Two balls, one as small beside the other as doubles can have it: both are felt.
TEST(Windings, OfDoublesOfMixedSizes) {
  Mesh<double> mesh = sphere<double>(3, {2, 0, 0}), little = sphere<double>(2, {}, 1e-200);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), little.vertices.begin(), little.vertices.end());
  for (const auto& f : little.faces) mesh.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  for (const double reach : {2.0, std::numeric_limits<double>::infinity()}) {
    const WindingTree<double> tree(mesh, reach, 1);
    EXPECT_NEAR(tree({0, 0, 0}).value, 1, 0.02);
    EXPECT_NEAR(tree({0, 5e-201, 0}).value, 1, 0.02);
    EXPECT_NEAR(tree({0, 2e-200, 0}).value, 0, 0.02);
    EXPECT_NEAR(tree({2, 0.5, 0}).value, 1, 0.02);
    EXPECT_NEAR(tree({0, 0.5, 0}).value, 0, 0.02);
    EXPECT_TRUE(tree({1e-200, 0, 0}).on_surface);
  }
}
// Powers of the distance in radii leave the range of float long before the distance does.
TEST(Windings, FarAwayAreNone) {
  const WindingTree<float> ball(bumpy(2, 1), 2, 1), little(bumpy(2, 1, {}, 0x1p-90f), 2, 1);
  const WindingTree<double> of_double(sphere<double>(2, {}, 1e-300), 2, 1);
  for (const float far : {1e3f, 1e9f, 1e15f, 1e25f, 3e38f}) {
    EXPECT_NEAR(ball({far, -far, far}).value, 0, 1e-6) << far;
    EXPECT_NEAR(little({far, -far, far}).value, 0, 1e-6) << far;
    EXPECT_NEAR(of_double({far, -far, 1e308}).value, 0, 1e-6) << far;
  }
}

// Points as near to a face as doubles allow, and not on it: their height is lost in the rounding of a solid
// angle, its sign is not.
TEST(Windings, NearestPointsOfFacesAreToldExactly) {
  Mesh<double> mesh = sphere<double>(3);  // convex: behind all faces is inside
  const Vec3d turn[3] = {normalized(Vec3d{2, 1, 0.3}), normalized(Vec3d{-1, 2, 0.1}), {0, 0, 1}};
  for (Vec3d& p : mesh.vertices) p = turn[0] * p[0] + turn[1] * p[1] + turn[2] * p[2];
  const SignedDistance<Bvh<Triangles<double>>, Winding> near(mesh), sum(mesh, {}, {.reach = 1e300});
  Pcg32 random(56);
  int inside = 0, outside = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto face = random.below(static_cast<std::uint32_t>(mesh.size()));
    const Triangle<double> t = mesh.triangle(face);
    const double v = random.uniform(0.1, 0.4), w = random.uniform(0.1, 0.4);
    const Vec3d p = t.a * (1 - v - w) + t.b * v + t.c * w;
    bool in = true;
    for (std::size_t f = 0; f < mesh.size() && in; ++f) {
      const Triangle<double> other = mesh.triangle(f);
      in = geometry::orientation(other.a, other.b, other.c, p) <= 0;
    }
    ++(in ? inside : outside);
    ASSERT_EQ(sum.inside(p), in) << i;
    ASSERT_EQ(near.inside(p), in) << i;
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(outside, 500);
}

TEST(Windings, StandHolesWhereRaysDoNot) {
  Mesh3f mesh = bumpy(4, 1);
  const Mesh3f whole = mesh;
  std::erase_if(mesh.faces, [&](const auto& f) { return mesh.vertices[f[0]][2] > 0.85f; });
  const SignedDistance<WideTree, Winding> winding(mesh);
  const SignedDistance<WideTree, RayParity> parity(mesh);
  EXPECT_FALSE(winding.closed());
  std::size_t wrong = 0, wrong_parity = 0;
  for (const Point3f& p : points_about(whole, 3000, 54)) {
    const Truth truth = truth_of(whole, p);
    if (truth.on) continue;
    wrong += winding.inside(p) != truth.inside(), wrong_parity += parity.inside(p) != truth.inside();
  }
  EXPECT_LT(wrong, 60u);
  EXPECT_GT(wrong_parity, 2 * wrong);
}

TEST(Windings, RefuseReachesBelowOne) {
  EXPECT_THROW(WindingTree<float>(bumpy(1, 1), 0.5, 1), InvalidInput);
  EXPECT_THROW(WindingTree<float>(bumpy(1, 1), std::nan(""), 1), InvalidInput);
}

// ---- closedness ----------------------------------------------------------------------------------------

TEST(Closedness, IsWhatAdjacencyFinds) {
  Pcg32 random(61);
  for (int i = 0; i < 200; ++i) {
    Mesh3f mesh = bumpy(1, 1);
    for (int damage = static_cast<int>(random.below(3)); damage > 0; --damage) {
      const auto f = random.below(static_cast<std::uint32_t>(mesh.size()));
      switch (random.below(4)) {
        case 0:
          mesh.faces.erase(mesh.faces.begin() + f);
          break;
        case 1:
          std::swap(mesh.faces[f][0], mesh.faces[f][1]);
          break;
        case 2: {
          const auto copy = mesh.faces[f];
          mesh.faces.push_back(copy);
          break;
        }
        default:
          mesh.faces[f][0] = mesh.faces[f][1];
      }
    }
    const geometry::Adjacency adjacency(mesh);
    const geometry::Closedness found = geometry::closedness(mesh);
    ASSERT_EQ(found.closed, adjacency.closed());
    ASSERT_EQ(found.oriented, adjacency.closed() && adjacency.oriented());
  }
  Mesh3f bad = bumpy(1, 1);
  bad.faces[2][0] = 1000;
  EXPECT_THROW(geometry::closedness(bad), std::out_of_range);
}

}  // namespace
}  // namespace treeline::accel::test
