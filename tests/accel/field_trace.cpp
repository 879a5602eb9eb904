// Sphere tracing: against rays in closed form and rays on the meshes that fields were sampled from; how many
// steps theory has it take; and that nothing the field holds is stepped over.
#include "tests/accel/field_common.hpp"

namespace treeline::accel::field::test {
namespace {

Rayd aimed(Pcg32& random, double from, double spread) {
  const Vec3d a = normalized(in_box(random, {{-1, -1, -1}, {1, 1, 1}})) * from;
  const Vec3d to = in_box(random, {{-spread, -spread, -spread}, {spread, spread, spread}});
  return {a, (to - a) * random.uniform(0.1, 3.0), 0, 1e6};
}

/// Where a ray meets a ball first, negative for never; and by how much it misses.
double ball_hit(const Sphere& ball, const Rayd& ray, double& clearance) {
  const Vec3d o = ray.origin - ball.centre, d = normalized(ray.direction);
  const double b = dot(o, d), q = length2(o) - b * b;
  clearance = std::sqrt(q) - ball.radius;
  return clearance > 0 ? -1 : (-b - std::sqrt(ball.radius * ball.radius - q)) / length(ray.direction);
}

TEST(SphereTrace, MeetsABallWhereItIs) {
  const Sphere ball{{0.1, 0.2, 0.3}, 0.7};
  Pcg32 random(1);
  for (int n = 0; n < 5000; ++n) {
    const Rayd ray = aimed(random, 4, 1.2);
    double clearance;
    const double t = ball_hit(ball, ray, clearance);
    TraceOptions o;
    o.tolerance = 1e-9, o.relaxation = n % 2 ? 1 : 1.7, o.max_steps = 100000;
    const Trace found = sphere_trace(ball, ray, o);
    if (std::abs(clearance) < 1e-6) continue;
    ASSERT_EQ(found.status, t < 0 ? TraceStatus::miss : TraceStatus::hit) << n;
    if (t >= 0) {
      ASSERT_NEAR(found.t * length(ray.direction), t * length(ray.direction), 1e-9 / 1e-3);
    }
    ASSERT_FALSE(found.doubtful);
  }
}

TEST(SphereTrace, StepsGrowWithTheRootOfOneOverClearance) {
  const Union ball{Sphere{{}, 1}, HalfSpace{{Vec3d{0, 0, 1}, -100}}};  // the plane takes the bounds away
  const auto steps = [&](double clearance) {
    TraceOptions o;
    o.relaxation = 1, o.max_steps = 100000;
    return sphere_trace(ball, {{-3, 1 + clearance, 0}, {1, 0, 0}, 0, 6}, o).steps;
  };
  EXPECT_NEAR(double(steps(1e-4)) / steps(1e-2), 10, 1.5);
  EXPECT_NEAR(steps(1e-2), 39, 8);
}

TEST(SphereTrace, RelaxationSavesStepsOverAPlane) {
  const HalfSpace below{{Vec3d{0, 0, 1}, 0}};
  TraceOptions plain;
  plain.relaxation = 1, plain.max_steps = 10000;
  TraceOptions relaxed = plain;
  relaxed.relaxation = 1.8;
  const double angle = std::numbers::pi / 180;
  const Rayd ray{{0, 0, 0.01}, {std::cos(angle), 0, -std::sin(angle)}, 0, 10};
  const Trace a = sphere_trace(below, ray, plain), b = sphere_trace(below, ray, relaxed);
  EXPECT_EQ(a.status, TraceStatus::hit);
  EXPECT_EQ(b.status, TraceStatus::hit);
  EXPECT_NEAR(a.t, 0.01 / std::sin(angle), 1e-5 / std::sin(angle));
  EXPECT_NEAR(b.t, a.t, 1e-5 / std::sin(angle));
  // Steps are a geometric series with ratio 1 - relaxation · sin(angle).
  EXPECT_NEAR(double(a.steps) / b.steps, 1.8, 0.1);
}

TEST(SphereTrace, ACapThatIsReachedIsTold) {
  const HalfSpace below{{Vec3d{0, 0, 1}, 0}};
  TraceOptions o;
  o.max_steps = 16;
  const Trace found = sphere_trace(below, {{0, 0, 0.01}, {1, 0, -0.01}, 0, 10}, o);
  EXPECT_EQ(found.status, TraceStatus::exhausted);
  EXPECT_EQ(found.steps, 16);
  EXPECT_LT(found.t, 1.0);
}

TEST(SphereTrace, FromInside) {
  const Sphere ball{{}, 1};
  const Trace found = sphere_trace(ball, {{0.5, 0, 0}, {2, 0, 0}, 0, 10});
  EXPECT_EQ(found.status, TraceStatus::hit);
  EXPECT_NEAR(found.t, 0.25, 1e-5);
  EXPECT_EQ(sphere_trace(ball, {{0.5, 0, 0}, {2, 0, 0}, 0, 0.2}).status, TraceStatus::miss);
  EXPECT_EQ(sphere_trace(ball, {{-3, 0, 0}, {1, 0, 0}, 4.5, 10}).status, TraceStatus::miss);
}

TEST(SphereTrace, RefusesWhatIsNoRay) {
  const Sphere ball{{}, 1};
  const Rayd ray{{-3, 0, 0}, {1, 0, 0}, 0, 10};
  const auto with = [&](auto&& change) {
    TraceOptions o;
    change(o);
    return o;
  };
  EXPECT_THROW(sphere_trace(ball, ray, with([](auto& o) { o.max_steps = 0; })), InvalidInput);
  EXPECT_THROW(sphere_trace(ball, ray, with([](auto& o) { o.relaxation = 2; })), InvalidInput);
  EXPECT_THROW(sphere_trace(ball, ray, with([](auto& o) { o.tolerance = 0; })), InvalidInput);
  EXPECT_THROW(sphere_trace(ball, {{-3, 0, 0}, {0, 0, 0}, 0, 10}), InvalidInput);
  EXPECT_THROW(sphere_trace(ball, {{-3, NAN, 0}, {1, 0, 0}, 0, 10}), InvalidInput);
  const HalfSpace below{{Vec3d{0, 0, 1}, 0}};                                // has no bounds
  EXPECT_THROW(sphere_trace(below, {{-3, 0, 1}, {1, 0, 0}}), InvalidInput);  // endless
}

// The tolerance follows the field's size: nothing is hit beside a small shape, nor is a large one's a matter
// of the last digits.
TEST(SphereTrace, ToleranceIsOfTheFieldsSize) {
  for (const double size : {1e-30, 1e-6, 1.0, 1e6}) {
    const Mesh3f mesh = [&] {
      Mesh3f m = accel::test::sphere<float>(2);
      for (auto& p : m.vertices) p = p * static_cast<float>(size);
      return m;
    }();
    const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(12));
    const Trilinear field(s);
    const Sphere ball{{}, size};
    const auto expect = [&](const auto& shape) {
      EXPECT_NEAR(sphere_trace(shape, {{-3 * size, 0, 0}, {1, 0, 0}}).t, 2 * size, 0.1 * size) << size;
      const Trace beside = sphere_trace(shape, {{-3 * size, 1.2 * size, 0}, {1, 0, 0}});
      EXPECT_EQ(beside.status, TraceStatus::miss) << size;
      EXPECT_FALSE(beside.doubtful) << size;
    };
    expect(field), expect(ball), expect(Union{ball, Torus{{}, 0.5 * size, 0.1 * size}});
    expect(SmoothUnion{ball, ball, 0.0}), expect(Difference{ball, Sphere{{}, 0.5 * size}});
  }
}

// The same ray, whose direction is longer or shorter by a power of two: t is divided by it, nothing else.
TEST(SphereTrace, DirectionsOfAnyLength) {
  const Sphere ball{{}, 1};
  const Mesh3f mesh = accel::test::sphere<float>(3);
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(32));
  const Trilinear field(s);
  const Rayd ray{{-3, 0, 0.1}, {1, 0.01, 0}, 0, 100};
  const Trace plain = sphere_trace(ball, ray), sampled = sphere_trace(field, ray);
  ASSERT_EQ(plain.status, TraceStatus::hit);
  ASSERT_EQ(sampled.status, TraceStatus::hit);
  for (const int exponent : {-1000, -565, -3, 1, 565, 1000}) {
    Rayd other = ray;
    other.direction = ray.direction * std::scalbn(1.0, exponent),
    other.t_max = std::scalbn(ray.t_max, -exponent);
    const auto expect_same = [&](const Trace& a, const Trace& b) {
      EXPECT_EQ(a.status, b.status) << exponent;
      EXPECT_EQ(a.t, std::scalbn(b.t, exponent)) << exponent;
      EXPECT_EQ(a.steps, b.steps) << exponent;
    };
    expect_same(plain, sphere_trace(ball, other));
    expect_same(sampled, sphere_trace(field, other));
    other.t_max = std::numeric_limits<double>::infinity();
    expect_same(sampled, sphere_trace(field, other));
  }
  EXPECT_NEAR(sphere_trace(ball, {{-3, 0, 0}, {1e-170, 0, 0}, 0, 1e180}).t, 2e170, 1e166);
  EXPECT_NEAR(sphere_trace(ball, {{-3, 0, 0}, {1e170, 0, 0}, 0, 1}).t, 2e-170, 1e-174);
  // A miss goes to the given end.
  EXPECT_EQ(sphere_trace(ball, {{-3, 2, 0}, {1e-170, 0, 0}, 0, 1e180}).t, 1e180);
  // The hit's t would be 2e320.
  EXPECT_THROW(sphere_trace(field, {{-3, 0, 0.1}, {1e-320, 0, 0}}), InvalidInput);
}

TEST(SphereTrace, RefusesWhatOverflows) {
  const Sphere ball{{}, 1};
  const double inf = std::numeric_limits<double>::infinity();
  const Mesh3f mesh = accel::test::sphere<float>(2);
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(16));
  const Trilinear field(s);
  EXPECT_THROW(sphere_trace(ball, {{-1e200, 0, 0}, {1, 0, 0}, 0, 1e201}), InvalidInput);
  EXPECT_THROW(sphere_trace(field, {{-1e200, 0, 0}, {1, 0, 0}}), InvalidInput);
  const HalfSpace below{{Vec3d{0, 0, 1}, 0}};
  EXPECT_THROW(sphere_trace(below, {{-3, 0, 1}, {1, 0, 0}, -1e200, 10}), InvalidInput);
  EXPECT_THROW(sphere_trace(below, {{-3, 0, 1}, {1, 0, 0}, -inf, 10}), InvalidInput);
  EXPECT_THROW(sphere_trace(below, {{-3, 0, 1}, {1e200, 0, 0}, 0, 1e200}), InvalidInput);
  // Bounds say where such a ray begins.
  EXPECT_EQ(sphere_trace(field, {{-3, 0, 0.1}, {1, 0, 0}, -inf, inf}).status, TraceStatus::hit);
}

// Behind a wall that the field has lost stands one that it has: a ray through both says so.
TEST(SphereTrace, AHitBehindALostWallIsDoubtful) {
  Mesh3f mesh = turned_box({1, 0.8, 0.002});  // an eighth of a cell
  for (auto& p : mesh.vertices) p[0] -= 1.5f;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const Mesh3f ball = accel::test::sphere<float>(4);
  for (auto p : ball.vertices) p[0] += 1.5f, mesh.vertices.push_back(p);
  for (const auto& f : ball.faces) mesh.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  const accel::Bvh<Triangles<float>> tree(mesh);
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(160));
  const Trilinear field(s);
  Pcg32 random(4);
  int behind = 0, plain = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3d to = Vec3d{1.5, 0, 0} + in_box(random, {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}});
    const Vec3d from = Vec3d{-4, random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)};
    const Rayd ray{from, normalized(to - from)};
    const auto truth = tree.closest_hit({Vec3f(ray.origin), Vec3f(ray.direction)});
    const Trace found = sphere_trace(field, ray);
    ASSERT_EQ(found.status, TraceStatus::hit) << n;
    if (found.t - double(truth.t) > 0.5) {
      ++behind;
      ASSERT_TRUE(found.doubtful) << n;
    }
    plain += !found.doubtful;
  }
  EXPECT_GT(behind, 100);
  EXPECT_GT(plain, 500);
}

/// Rays at a mesh: every hit of the mesh is a hit of the field or a doubt; no hit lies where nothing is; and
/// where both hit the same, t agrees.
void expect_like_the_mesh(const Mesh3f& mesh, int resolution, double allowed_doubts) {
  const accel::Bvh<Triangles<double>> exact([&] {
    geometry::Mesh3d m;
    for (const auto& p : mesh.vertices) m.vertices.push_back(Vec3d(p));
    m.faces = mesh.faces;
    return m;
  }());
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(resolution));
  const Trilinear field(s);
  Pcg32 random(2);
  int doubts = 0, hits = 0;
  constexpr int count = 5000;
  for (int n = 0; n < count; ++n) {
    Rayd ray = aimed(random, 3, 1);
    ray.direction = normalized(ray.direction);
    if (n % 3 == 0) ray.t_max = std::numeric_limits<double>::infinity();
    TraceOptions o;
    o.max_steps = 4000, o.relaxation = n % 2 ? 1 : 1.6, o.tolerance = 1e-5;
    const Trace found = sphere_trace(field, ray, o);
    const auto truth = exact.closest_hit(ray);
    ASSERT_NE(found.status, TraceStatus::exhausted);
    doubts += found.doubtful && found.status == TraceStatus::miss;
    hits += bool(truth);
    if (found.status == TraceStatus::miss && truth) {
      ASSERT_TRUE(found.doubtful) << n;
    }
    if (found.status == TraceStatus::hit) {
      const FieldSample there = field.sample(ray.at(found.t));
      ASSERT_LE(std::abs(true_distance(mesh, ray.at(found.t))), there.error + *o.tolerance) << n;
    }
    // The conservative trace misses nothing, and stops no later than the surface.
    o.stop_at_doubt = true;
    const Trace careful = sphere_trace(field, ray, o);
    if (truth) {
      ASSERT_EQ(careful.status, TraceStatus::hit) << n;
      ASSERT_LE(careful.t, truth.t + *o.tolerance) << n;
    } else if (careful.status == TraceStatus::hit) {
      ASSERT_TRUE(careful.doubtful || found.status == TraceStatus::hit) << n;
    }
  }
  EXPECT_GT(hits, count / 100);
  EXPECT_LE(doubts, allowed_doubts * count);
}

TEST(SphereTrace, MeetsWhatRaysMeetOnMeshes) {
  expect_like_the_mesh(accel::test::sphere<float>(3), 40, 0.05);
  expect_like_the_mesh(turned_box({1, 0.6, 0.4}), 40, 0.2);
  expect_like_the_mesh(nested(2), 40, 0.05);
  // Half a cell thick, which the field may lose: but not the bound.
  expect_like_the_mesh(turned_box({1, 0.8, 0.01}), 48, 1);
}

/// Whatever of a true wall the field holds, be it a sliver of one: looked for in small steps.
template <class Field>
void expect_no_passage(const Field& field, const Mesh3f& mesh) {
  const accel::Bvh<Triangles<float>> tree(mesh);
  Pcg32 random(3);
  int walls = 0;
  for (int n = 0; n < 2000; ++n) {
    Rayd ray = aimed(random, 3, 0.6);
    ray.direction = normalized(ray.direction), ray.t_max = 5;
    if (!tree.any_hit({Vec3f(ray.origin), Vec3f(ray.direction)})) continue;
    double inside = -1;
    for (double t = 2; t < 4 && inside < 0; t += 0.001)
      if (field.distance(ray.at(t)) < 0) inside = t;
    if (inside < 0) continue;
    ++walls;
    TraceOptions o;
    o.relaxation = n % 2 ? 1 : 1.9, o.max_steps = 4000;
    const Trace found = sphere_trace(field, ray, o);
    ASSERT_EQ(found.status, TraceStatus::hit) << n;
    ASSERT_LE(found.t, inside) << n;
  }
  EXPECT_GT(walls, 50);
}

TEST(SphereTrace, AWallThatTheFieldHoldsIsNotSteppedOver) {
  for (const double half : {0.05, 0.02, 0.01}) {  // 2 cells thick, less than 1, and less than a half
    const Mesh3f mesh = turned_box({1, 0.8, half});
    const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), options(40));
    expect_no_passage(Trilinear(s), mesh);
    expect_no_passage(Tricubic(s), mesh);
  }
}

}  // namespace
}  // namespace treeline::accel::field::test
