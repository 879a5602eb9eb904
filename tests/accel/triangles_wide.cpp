// The wide tree over triangles on one instruction set, which this file is compiled for. With --digest it
// prints a hash of all answers instead, so that the instruction sets can be compared.
#include <cstdio>
#include <cstring>
#include <string_view>

#include "accel/bvh/wide_triangles.hpp"
#include "tests/accel/instruction_set.hpp"
#include "tests/accel/triangles_wide.hpp"

namespace treeline::accel::test {
namespace {

using Closed = Bvh<Triangles<float, Watertight>, accel::Wide>;
using Exactly = Bvh<Triangles<float, geometry::Exact>, accel::Wide>;
/// Where the line of a ray meets the plane of a triangle, in long double by scalar triple products.
struct Meeting {
  long double t, weight[3];
  long double least() const { return std::min({weight[0], weight[1], weight[2]}); }
};
Meeting meeting(const R& ray, const Triangle<float>& triangle) {
  using L = Vec<long double, 3>;
  const L o(ray.origin), d(ray.direction);
  const L a = L(triangle.a) - o, b = L(triangle.b) - o, c = L(triangle.c) - o;
  const long double wa = dot(d, cross(b, c)), wb = dot(d, cross(c, a)), wc = dot(d, cross(a, b));
  const long double sum = wa + wb + wc;
  return {dot(a, cross(b, c)) / sum, {wa / sum, wb / sum, wc / sum}};
}

template <class Tree>
class WideRays : public testing::Test {};
using WideTrees = testing::Types<Closed, Exactly>;
TYPED_TEST_SUITE(WideRays, WideTrees);

template <class Tree>
void expect_same_in_every_batch(const Tree& tree, const std::vector<R>& rays,
                                const std::vector<Hit<float>>& hits, const std::vector<std::uint8_t>& any) {
  for (const RayBatch how : {RayBatch::automatic, RayBatch::singly, RayBatch::streams, RayBatch::packets})
    for (const int threads : {1, 2}) {
      std::vector<Hit<float>> same(rays.size());
      std::vector<std::uint8_t> same_any(rays.size());
      tree.closest_hit(rays, same, threads, how), tree.any_hit(rays, same_any, threads, how);
      ASSERT_TRUE(same == hits);
      ASSERT_EQ(same_any, any);
    }
}

/// Rays whose answer hangs on the last digits are left out; `far`: how much coarser the rays' origins are.
template <class Tree>
void expect_true_hits(const std::vector<Triangle<float>>& triangles, const std::vector<R>& rays,
                      float far = 1) {
  const Tree tree(triangles);
  std::vector<Hit<float>> hits(rays.size());
  std::vector<std::uint8_t> any(rays.size());
  tree.closest_hit(rays, hits, 1), tree.any_hit(rays, any, 1);
  expect_same_in_every_batch(tree, rays, hits, any);
  std::size_t met = 0, missed = 0;
  const long double doubt = 1000.0l * std::numeric_limits<float>::epsilon() * far;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const R& ray = rays[i];
    Hit<long double> nearest{ray.t_max};
    bool doubtful = false;
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const Meeting m = meeting(ray, triangles[k]);
      if (!(m.least() > -doubt)) continue;
      if (m.least() < doubt || std::abs(m.t - ray.t_min) < doubt || std::abs(m.t - ray.t_max) < doubt)
        doubtful = true;
      if (m.t >= ray.t_min && m.t < nearest.t) nearest = {m.t, static_cast<Id>(k)};
    }
    if (doubtful) continue;
    ASSERT_EQ(hits[i].primitive, nearest.primitive) << "ray " << i;
    ASSERT_EQ(any[i] != 0, static_cast<bool>(nearest)) << "ray " << i;
    ASSERT_TRUE(tree.closest_hit(ray) == hits[i] && tree.any_hit(ray) == (any[i] != 0));
    (nearest ? met : missed)++;
    if (!nearest) continue;
    const Meeting m = meeting(ray, triangles[nearest.primitive]);
    const auto normal = normalized(triangles[nearest.primitive].area_normal());
    const long double cosine = std::abs(dot(normal, normalized(ray.direction)));
    EXPECT_NEAR(hits[i].t, m.t, doubt * (1 + std::abs(m.t)) / cosine) << "ray " << i;
    EXPECT_NEAR(hits[i].u, m.weight[1], doubt / cosine / 0.01) << "ray " << i;
    EXPECT_NEAR(hits[i].v, m.weight[2], doubt / cosine / 0.01) << "ray " << i;
  }
  EXPECT_GT(met, rays.size() / 20);
  EXPECT_GT(missed, rays.size() / 20);
}

TYPED_TEST(WideRays, EqualAnIndependentComputation) {
  expect_true_hits<TypeParam>(soup<float>(500, 0.3f, 41), random_rays(500, 42));
  expect_true_hits<TypeParam>(soup<float>(3000, 0.05f, 43), random_rays(200, 44));
}

TYPED_TEST(WideRays, AllHitsAreThoseOfEachTriangleAlone) {
  const auto triangles = soup<float>(400, 0.8f, 45);
  const TypeParam tree(triangles);
  std::vector<TypeParam> alone;
  for (const auto& t : triangles) alone.emplace_back(std::vector<Triangle<float>>{t});
  std::size_t most = 0;
  for (const R& ray : random_rays(100, 46)) {
    std::vector<Hit<float>> expected, found;
    for (std::size_t k = 0; k < alone.size(); ++k)
      if (const auto hit = alone[k].closest_hit(ray)) {
        expected.push_back(hit);
        expected.back().primitive = static_cast<Id>(k);
      }
    std::sort(expected.begin(), expected.end(),
              [](auto& a, auto& b) { return a.t < b.t || (a.t == b.t && a.primitive < b.primitive); });
    tree.all_hits(ray, found);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      // Alone, a triangle may lie in a space moved elsewhere: rounding differs.
      ASSERT_NEAR(found[i].t, expected[i].t, 1e-4f);
    }
    if (!found.empty()) {
      ASSERT_TRUE(found[0] == tree.closest_hit(ray));
    }
    most = std::max(most, found.size());
  }
  EXPECT_GT(most, 10u);
}

TYPED_TEST(WideRays, ExtremeScalesChangeNothingButT) {
  const auto triangles = soup<float>(300, 0.2f, 61);
  const auto rays = random_rays(300, 62);
  const TypeParam tree(triangles);
  for (const int exponent : {-100, -40, 40, 60}) {
    const float scale = std::ldexp(1.0f, exponent);
    std::vector<Triangle<float>> scaled;
    for (const auto& t : triangles) scaled.push_back({t.a * scale, t.b * scale, t.c * scale});
    const TypeParam other(scaled);
    for (R ray : rays) {
      const auto expected = tree.closest_hit(ray);
      ray.origin = ray.origin * scale, ray.direction = ray.direction * scale;
      if (!(ray.direction[0] == 0 || std::isnormal(ray.direction[0]))) continue;  // a denormal loses digits
      ASSERT_TRUE(other.closest_hit(ray) == expected);
    }
  }
}

TYPED_TEST(WideRays, TiesGoToTheLowerIdAndTrianglesWithoutAreaAreDropped) {
  const Triangle<float> wall{{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}};
  std::vector<Triangle<float>> triangles(40, wall);
  for (int i = 0; i < 10; ++i) {
    triangles.insert(triangles.begin(), Triangle<float>{{0, 0, 0.5f}, {0, 0, 0.5f}, {0, 0, 0.5f}});
    triangles.insert(triangles.begin(), Triangle<float>{{-1, 0, 0.5f}, {0, 0, 0.5f}, {1, 0, 0.5f}});
  }
  const TypeParam tree(triangles);
  EXPECT_EQ(tree.size(), 40u);
  EXPECT_EQ(tree.stats().dropped, 20u);
  const auto hit = tree.closest_hit({{}, {0, 0, 1}});
  EXPECT_EQ(hit.primitive, 20u);
  EXPECT_EQ(hit.t, 1.0f);
}

TYPED_TEST(WideRays, EndsOfTheIntervalCount) {
  const std::vector<Triangle<float>> wall{{{-1, -1, 2}, {1, -1, 2}, {0, 1, 2}}};
  const TypeParam tree(wall);
  const V ahead{0, 0, 1};
  EXPECT_TRUE(tree.any_hit({{}, ahead, 2, 2}));
  EXPECT_TRUE(tree.any_hit({{}, ahead, 0, 2}));
  EXPECT_TRUE(tree.any_hit({{}, ahead, 2, 9}));
  EXPECT_TRUE(tree.any_hit({{0, 0, 2}, ahead}));
  EXPECT_TRUE(tree.any_hit({{0, 0, 5}, ahead, -4, -1}));
  EXPECT_FALSE(tree.any_hit({{}, ahead, 0, 1.999f}));
  EXPECT_FALSE(tree.any_hit({{}, ahead, 2.001f, 9}));
  EXPECT_FALSE(tree.any_hit({{}, ahead, 3, 1}));  // an empty interval
  EXPECT_FALSE(tree.any_hit({{}, -ahead}));
  EXPECT_EQ(tree.closest_hit({{}, ahead * 4.0f}).t, 0.5f);
}

TYPED_TEST(WideRays, DuplicatesAndNestedCoplanarTrianglesEndInABoundedTree) {
  std::vector<Triangle<float>> triangles(200000, Triangle<float>{{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}});
  for (int i = 0; i < 20000; ++i) {
    const float s = std::ldexp(1.0f, -(i % 60)) * (1 + static_cast<float>(i) * 1e-6f);
    triangles.push_back({{-s, -s, 2}, {s, -s, 2}, {0, s, 2}});
  }
  const TypeParam tree(triangles);
  EXPECT_LE(tree.stats().depth, binary_max_depth);
  EXPECT_LE(tree.stats().largest_leaf, 8u);
  EXPECT_EQ(tree.closest_hit({{}, {0, 0, 1}}).primitive, 0u);
  EXPECT_EQ(tree.closest_hit({{0, 0, 1.5f}, {0, 0, 1}}).primitive, 200000u);
}

TYPED_TEST(WideRays, GrowingByPowersOfTwoStaysWithinTheDepth) {
  std::vector<Triangle<float>> triangles;
  for (int i = 0; i < 4000; ++i) {
    const float x = std::ldexp(1.0f, i % 200 - 100), s = x * 0.1f;
    triangles.push_back({{x, -s, -s}, {x, s, -s}, {x, 0, s}});
  }
  const TypeParam tree(triangles);
  EXPECT_LE(tree.stats().depth, binary_max_depth);
  for (int e = -20; e <= 20; ++e) {
    const float x = std::ldexp(1.0f, e);
    EXPECT_EQ(tree.closest_hit({{x * 0.75f, 0, 0}, {x, 0, 0}}).t, 0.25f) << e;
  }
}

TYPED_TEST(WideRays, RefusesByIndexOrDrops) {
  auto triangles = soup<float>(100, 0.2f, 91);
  triangles[17].b[1] = std::numeric_limits<float>::quiet_NaN();
  try {
    TypeParam{triangles};
    FAIL() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("17"), std::string::npos);
  }
  const TypeParam tree(triangles, {.non_finite = NonFinite::drop});
  EXPECT_EQ(tree.size(), 99u);
  EXPECT_EQ(tree.stats().dropped, 1u);
  const auto& last = triangles[99];
  const V normal = last.area_normal();
  const auto hit = tree.closest_hit({last.centroid() + normal * 1e-2f, -normal});
  EXPECT_EQ(hit.primitive, 99u);  // ids stay those of the input
  Mesh<float> mesh = sphere<float>(1);
  mesh.faces[5][1] = 1000;
  EXPECT_THROW(TypeParam{mesh}, InvalidInput);
  EXPECT_THROW(TypeParam(sphere<float>(1), {.threads = 0}), InvalidInput);
  EXPECT_THROW((void)tree.closest_hit({{}, {0, -0.0f, 0}}), InvalidInput);
  EXPECT_THROW((void)tree.any_hit({{}, {std::numeric_limits<float>::infinity(), 0, 0}}), InvalidInput);
  const TypeParam none{std::vector<Triangle<float>>{}};
  EXPECT_FALSE(none.any_hit({{}, {1, 0, 0}}));
  EXPECT_FALSE(none.closest_hit({{}, {1, 0, 0}}));
  EXPECT_EQ(none.size(), 0u);
}

template <class Tree>
class WideClosedRays : public testing::Test {};
using ClosedTrees = testing::Types<Closed, Exactly>;
TYPED_TEST_SUITE(WideClosedRays, ClosedTrees);

TYPED_TEST(WideClosedRays, NoneEscapesAClosedSphereAtVerticesAndEdges) {
  struct Place {
    V centre;
    float radius;
  };
  for (const Place& place : {Place{{}, 1}, Place{{1e3f, 2e3f, -5e2f}, 1}, Place{{1e5f, -1e5f, 3e4f}, 1},
                             Place{{}, 1e-3f}, Place{{-1e5f, 0, 0}, 1e-2f}}) {
    const Mesh<float> mesh = sphere<float>(5, place.centre, place.radius);
    const TypeParam tree(mesh);
    Pcg32 random(51);
    std::vector<R> rays;
    for (int i = 0; i < 50000; ++i) {
      const auto& face = mesh.faces[random.below(static_cast<std::uint32_t>(mesh.size()))];
      const V p = mesh.vertices[face[0]], q = mesh.vertices[face[1]];
      const V target = i % 2 ? p : p + (q - p) * random.uniform<float>();
      const V origin = i % 8 < 2 ? place.centre : place.centre + in_cube(random, place.radius * 0.5f);
      if (target != origin) rays.push_back({origin, target - origin});
    }
    std::vector<Hit<float>> hits(rays.size());
    std::vector<std::uint8_t> any(rays.size());
    tree.closest_hit(rays, hits, 1), tree.any_hit(rays, any, 1);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_TRUE(hits[i]) << "ray " << i << " escapes";
      ASSERT_TRUE(any[i]) << "ray " << i << " escapes";
    }
  }
}

TYPED_TEST(WideClosedRays, RaysInFacePlanesMeetEveryClosedBoxTheyTouch) {
  Mesh<float> mesh;
  std::vector<Box<float, 3>> boxes;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) {
        const float top = static_cast<float>(z) + (x % 2 ? 1.0f : 0.5f);
        boxes.push_back({{float(x), float(y), float(z)}, {float(x + 1), float(y + 1), top}});
        add_box<float>(mesh, boxes.back());
      }
  const TypeParam tree(mesh);
  for (int axis = 0; axis < 3; ++axis)
    for (int i = -1; i <= 9; ++i)
      for (int j = -1; j <= 9; ++j)
        for (const float sign : {1.0f, -1.0f})
          for (const float zero : {0.0f, -0.0f, 1e-38f, 1e-45f}) {
            R ray;
            ray.origin[axis] = sign > 0 ? -0.5f : 4.5f;
            ray.origin[(axis + 1) % 3] = float(i) / 2, ray.origin[(axis + 2) % 3] = float(j) / 2;
            ray.direction = {zero, zero, zero};
            ray.direction[axis] = sign;
            bool touches = false, enters = false;
            for (Box<float, 3> box : boxes) {
              box.low[axis] = -1, box.high[axis] = 5;
              touches = touches || box.contains(ray.origin);
              const auto inside = [&](int k) {
                return box.low[k] < ray.origin[k] && ray.origin[k] < box.high[k];
              };
              enters = enters || (inside(0) && inside(1) && inside(2));
            }
            // A ray that leans, however little, may leave a side.
            if (zero != 0 && touches && !enters) continue;
            ASSERT_EQ(tree.any_hit(ray), touches) << axis << ' ' << i << ' ' << j << ' ' << zero;
            ASSERT_EQ(static_cast<bool>(tree.closest_hit(ray)), touches);
          }
}

/// Grazing needles and rays at corners, against integers: coordinates are small whole numbers over 2^k, so
/// that all determinants fit.
TEST(WideExactRays, DecideLikeWholeNumbers) {
  Pcg32 random(101);
  using Whole = Vec<long long, 3>;
  const auto det = [](const Whole& a, const Whole& b, const Whole& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  };
  const auto whole = [&](int half) {
    const auto one = [&] {
      return static_cast<long long>(random.below(static_cast<std::uint32_t>(2 * half + 1))) - half;
    };
    const long long x = one(), y = one();
    return Whole{x, y, one()};
  };
  std::size_t hit_count = 0, border_count = 0, miss_count = 0;
  for (int round = 0; round < 300; ++round) {
    // A needle of hundreds of thousands in length and few across.
    const Whole a = whole(100000), along = whole(100000), b = a + along, c = a + along / 3ll + whole(2);
    const float unit = 0x1p-10f;
    const auto point = [&](const Whole& p) { return V{float(p[0]), float(p[1]), float(p[2])} * unit; };
    const Triangle<float> triangle{point(a), point(b), point(c)};
    if (geometry::is_degenerate(triangle)) continue;
    const Exactly tree(std::vector<Triangle<float>>{triangle});
    for (int i = 0; i < 30; ++i) {
      const Whole o = i % 3 == 0 ? a - along / 2ll + whole(2) : whole(200000);
      const Whole target = i % 5 == 0   ? a
                           : i % 5 == 1 ? (b + c) / 2ll
                                        : a + along / 2ll + whole(i % 2 ? 2 : 40000);
      const Whole d = target - o;
      if (d == Whole{}) continue;
      const Whole p[3] = {a - o, b - o, c - o};
      const long long limit = 1 << 19;  // products of three stay below 2^63
      bool fits = true;
      for (int k = 0; k < 3; ++k) fits = fits && std::abs(d[k]) < limit && std::abs(p[0][k]) < limit;
      if (!fits) continue;
      const long long e[3] = {det(d, p[2], p[1]), det(d, p[0], p[2]), det(d, p[1], p[0])};
      const bool negative = e[0] < 0 || e[1] < 0 || e[2]<0, positive = e[0]> 0 || e[1] > 0 || e[2] > 0;
      const long double above = det(p[0], p[1], p[2]), below = (long double)(-(e[0] + e[1] + e[2]));
      const bool expected = negative != positive && above / below >= 0;
      const auto hit = tree.closest_hit({point(o), point(d)});
      ASSERT_EQ(static_cast<bool>(hit), expected) << round << ' ' << i;
      ASSERT_EQ(tree.any_hit({point(o), point(d)}), expected);
      (expected ? hit_count : miss_count)++;
      if (!expected) continue;
      border_count += e[0] == 0 || e[1] == 0 || e[2] == 0;
      ASSERT_EQ(hit.t, static_cast<float>(above / below)) << round << ' ' << i;
    }
  }
  EXPECT_GT(hit_count, 500u);
  EXPECT_GT(border_count, 100u);
  EXPECT_GT(miss_count, 500u);
}

// ---- digest --------------------------------------------------------------------------------------------

template <class Tree>
std::uint64_t digest_of(const Tree& tree, const std::vector<R>& rays) {
  std::uint64_t hash = 0;
  std::vector<Hit<float>> hits(rays.size());
  std::vector<std::uint8_t> any(rays.size());
  tree.closest_hit(rays, hits, 1), tree.any_hit(rays, any, 1);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto& h = hits[i];
    for (const float x : {h.t, h.u, h.v}) hash = geometry::hash_u64(hash, std::bit_cast<std::uint32_t>(x));
    hash = geometry::hash_u64(hash, std::uint64_t{h.primitive} << 8 | any[i]);
  }
  Work work;
  for (const auto& ray : rays) (void)tree.closest_hit(ray, work);
  return geometry::hash_u64(geometry::hash_u64(hash, work.nodes), work.primitives);
}

/// Multiples of 2^-12: input made without a rounding, which compilers could fuse away.
float whole(Pcg32& random, int half) {
  return static_cast<float>(static_cast<int>(random.below(static_cast<std::uint32_t>(2 * half))) - half) /
         4096;
}
V whole_point(Pcg32& random, int half) {
  const float x = whole(random, half), y = whole(random, half);
  return {x, y, whole(random, half)};
}

template <class Tree>
std::uint64_t digest() {
  Pcg32 random(81);
  std::uint64_t hash = 0;
  for (const int size : {100, 1000, 6000})
    for (const V centre : {V{}, V{100000, -30000, 70000}}) {
      std::vector<Triangle<float>> triangles;
      for (int i = 0; i < 2500; ++i) {
        const V at = whole_point(random, 4096);
        const auto corner = [&] { return (at + whole_point(random, size)) + centre; };
        const V a = corner(), b = corner(), c = corner();
        triangles.push_back({a, b, c});
      }
      std::vector<R> rays;
      for (int i = 0; i < 1500; ++i) {
        R ray{whole_point(random, 8192) + centre, whole_point(random, 4096)};
        const Triangle<float>& t = triangles[random.below(2500)];
        if (i % 3 == 0) ray.direction = (i % 2 ? t.a : (t.a + t.b) * 0.5f) - ray.origin;  // a corner, an edge
        if (i % 4 == 1) ray.direction[i / 4 % 3] = i % 8 == 1 ? 0.0f : -0.0f;
        if (i % 16 == 3) ray.direction[0] = std::numeric_limits<float>::denorm_min() * 3;
        if (i % 5 == 0) ray.t_min = -0.5f, ray.t_max = 1.5f;
        if (ray.direction != V{}) rays.push_back(ray);
      }
      hash = geometry::hash_u64(hash, digest_of(Tree(triangles, {.non_finite = NonFinite::drop}), rays));
    }
  return hash;
}

}  // namespace
}  // namespace treeline::accel::test

int main(int argc, char** argv) {
  using namespace treeline::accel::test;
  if (argc == 2 && std::string_view(argv[1]) == "--digest") {
    if (runs_here())
      std::printf("%016llx\n", static_cast<unsigned long long>(
                                   treeline::geometry::hash_u64(digest<Closed>(), digest<Exactly>())));
    return 0;
  }
  testing::InitGoogleTest(&argc, argv);
  if (!runs_here()) return 0;
  return RUN_ALL_TESTS();
}
