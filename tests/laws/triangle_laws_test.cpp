// Laws of every tree over triangles: nothing escapes a closed mesh, all equal brute force, the inside is
// inside, the same for any thread count and batch.
#include <oneapi/tbb/global_control.h>

#include "tests/laws/soups.hpp"
#include "tests/laws/trees.hpp"

namespace treeline::test {
namespace {

using accel::Hit;
using accel::Triangles;

// ---- closed meshes: watertight trees only ----------------------------------------------------------------

template <class T>
struct Closed {
  std::string name;
  Mesh<T> mesh;
  std::vector<Vec<T, 3>> inside;  // origins within the mesh
};

template <class T>
std::vector<Closed<T>> closed_meshes() {
  const Vec<T, 3> far{T(1e3), T(-2e3), T(5e2)};
  return {
      {"sphere", sphere<T>(3), {{0, 0, 0}, {T(0.3), T(-0.2), T(0.6)}}},
      {"sphere far away", moved(sphere<T>(3), far), {far}},
      {"tiny sphere", moved(sphere<T>(3), {}, T(1e-25)), {{0, 0, 0}}},
      {"huge sphere", moved(sphere<T>(3), {}, T(1e15)), {{0, 0, 0}}},
      {"cube of coplanar faces",
       cube<T>(2),
       {{0, 0, 0}, {T(0.5), T(0.25), T(-0.125)}, {T(0.1), T(0.2), T(0.3)}}},
      {"spikes", spiky<T>(3, 3), {{0, 0, 0}}},
      {"thin sheet", sheet<T>(3, T(1e-4)), {{0, 0, 0}, {T(0.3), T(0.3), T(1e-5)}}},
      {"torus", torus<T>(40, 16), {{1, 0, 0}, {0, T(-1), T(0.1)}}},
  };
}

/// Rays at every vertex, at every edge in an uneven place, along the axes, and anywhere.
template <class T>
std::vector<Ray<T>> rays_from_inside(const Closed<T>& c) {
  std::vector<Ray<T>> r;
  Pcg32 random(7);
  for (const Vec<T, 3>& o : c.inside) {
    const auto aim = [&](const Vec<T, 3>& target) {
      if (target != o) r.push_back({o, target - o});
    };
    for (const auto& v : c.mesh.vertices) aim(v);
    for (const auto& f : c.mesh.faces)
      for (int i = 0; i < 3; ++i) {
        const Vec<T, 3>&a = c.mesh.vertices[f[i]], &b = c.mesh.vertices[f[(i + 1) % 3]];
        aim(a + (b - a) * random.uniform<T>());
      }
    for (T zero : {T(0), -T(0), std::numeric_limits<T>::denorm_min()})
      for (int k = 0; k < 3; ++k)
        for (T sign : {T(1), T(-1)}) {
          Vec<T, 3> d = Vec<T, 3>::filled(zero);
          d[k] = sign;
          r.push_back({o, d});
        }
    for (int i = 0; i < 1000; ++i) r.push_back({o, sample_sphere(random.uniform<T>(), random.uniform<T>())});
  }
  return r;
}

template <class Tree>
class WatertightLaws : public testing::Test {};
TYPED_TEST_SUITE_P(WatertightLaws);

TYPED_TEST_P(WatertightLaws, NoRayFromInsideAClosedMeshEscapes) {
  using T = typename TypeParam::Scalar;
  for (const Closed<T>& c : closed_meshes<T>()) {
    const TypeParam tree(c.mesh);
    const auto rays = rays_from_inside(c);
    std::size_t closest = 0, any = 0;
    for (const auto& ray : rays) closest += !tree.closest_hit(ray), any += !tree.any_hit(ray);
    EXPECT_EQ(closest, 0u) << c.name << ", of " << rays.size();
    EXPECT_EQ(any, 0u) << c.name << ", of " << rays.size();
  }
}

/// Solid angle under which a closed mesh is seen, over 4 pi: 1 inside, 0 outside (Van Oosterom and Strackee
/// 1983).
template <class T>
double winding(const Mesh<T>& mesh, const Vec<T, 3>& p) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const Triangle3d t(mesh.triangle(i));
    const Vec3d a = t.a - Vec3d(p), b = t.b - Vec3d(p), c = t.c - Vec3d(p);
    const double la = length(a), lb = length(b), lc = length(c);
    sum +=
        2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

TYPED_TEST_P(WatertightLaws, ContainsIsTheWindingNumber) {
  using T = typename TypeParam::Scalar;
  Pcg32 random(5);
  for (const Closed<T>& c : closed_meshes<T>()) {
    if (c.name == "tiny sphere" || c.name == "huge sphere")
      continue;  // products of the truth leave the range
    const TypeParam tree(c.mesh);
    const Box<T, 3> box = c.mesh.box();
    int inside = 0, outside = 0;
    for (int n = 0; n < 150; ++n) {
      Vec<T, 3> p;
      for (int k = 0; k < 3; ++k)
        p[k] = box.centre()[k] + box.extent()[k] * random.uniform<T>(T(-0.55), T(0.55));
      // Within rounding of the surface either answer is right: there the winding number is near one half.
      const double w = winding(c.mesh, p);
      if (std::abs(w - 0.5) < 0.499) continue;
      ++(w > 0.5 ? inside : outside);
      EXPECT_EQ(tree.contains(p), w > 0.5) << c.name << " " << n << " " << w;
    }
    EXPECT_GT(inside, 5) << c.name;
    EXPECT_GT(outside, 5) << c.name;
    for (const auto& p : c.inside) EXPECT_TRUE(tree.contains(p)) << c.name;
  }
}

REGISTER_TYPED_TEST_SUITE_P(WatertightLaws, NoRayFromInsideAClosedMeshEscapes, ContainsIsTheWindingNumber);
using WatertightFloat = Trees<Triangles<float, Watertight>>;
using WatertightDouble = Trees<Triangles<double, Watertight>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Float, WatertightLaws, WatertightFloat);
INSTANTIATE_TYPED_TEST_SUITE_P(Double, WatertightLaws, WatertightDouble);

// ---- any triangles, either ray test ----------------------------------------------------------------------

template <class Tree>
class TriangleLaws : public testing::Test {};
TYPED_TEST_SUITE_P(TriangleLaws);

TYPED_TEST_P(TriangleLaws, RaysEqualBruteForce) {
  const bool ok = rc::check([] {
    using T = typename TypeParam::Scalar;
    auto make = any_soup<T>();
    const auto soup = make.triangles(*rc::gen::inRange<std::size_t>(0, 120));
    const TypeParam tree(soup);
    const typename PrimitivesOf<TypeParam>::Brute brute(soup);
    for (int i = 0; i < 20; ++i) {
      const Ray<T> ray = make.ray(soup);
      const Hit<T> found = tree.closest_hit(ray), expected = brute.closest_hit(ray);
      RC_ASSERT(found.t == expected.t);
      RC_ASSERT(found.primitive == expected.primitive);
      RC_ASSERT(found == expected);
      RC_ASSERT(tree.any_hit(ray) == bool(expected));
      if (found) RC_ASSERT(ray.t_min <= found.t && found.t <= ray.t_max);
    }
  });
  EXPECT_TRUE(ok);
}

TYPED_TEST_P(TriangleLaws, ClosestPointsEqualBruteForce) {
  const bool ok = rc::check([] {
    using T = typename TypeParam::Scalar;
    auto make = any_soup<T>();
    const auto soup = make.triangles(*rc::gen::inRange<std::size_t>(0, 120));
    const TypeParam tree(soup);
    const typename PrimitivesOf<TypeParam>::Brute brute(soup);
    for (int i = 0; i < 20; ++i) {
      const Vec<T, 3> q = make.place(soup);
      const T limit = i % 3 ? std::numeric_limits<T>::infinity() : make.random.template uniform<T>(0, 1);
      const auto found = tree.closest_point(q, limit), expected = brute.closest_point(q, limit);
      RC_ASSERT(found.distance2 == expected.distance2);
      RC_ASSERT(found.primitive == expected.primitive);
      RC_ASSERT(found.point == expected.point);
      if (found) RC_ASSERT(found.feature == expected.feature);
    }
  });
  EXPECT_TRUE(ok);
}

/// Two small triangles in opposite corners of a soup's box: trees over soups that both have them keep their
/// triangles in the same place and scale, and round a query alike.
template <class T>
std::vector<Triangle<T>> corner_triangles(const std::vector<Triangle<T>>& soup) {
  Box<T, 3> box;
  for (const auto& t : soup) box.grow(t.a), box.grow(t.b), box.grow(t.c);
  const Vec<T, 3> e = box.extent() * T(0x1p-8);
  const auto corner = [](const Vec<T, 3>& p, const Vec<T, 3>& in) {
    return Triangle<T>{p, p + Vec<T, 3>{in[0], 0, 0}, p + Vec<T, 3>{0, in[1], in[2]}};
  };
  return {corner(box.low, e), corner(box.high, e * T(-1))};
}

// Adding triangles takes no hit away, and can only bring the nearest point nearer, but for the rounding of a
// distance. (The t of a hit on a triangle seen edge-on is known only within a slack that grows with the
// scene, so t itself may move either way.)
TYPED_TEST_P(TriangleLaws, MoreTrianglesTakeNothingAway) {
  const bool ok = rc::check([] {
    using T = typename TypeParam::Scalar;
    auto make = any_soup<T>();
    const auto soup = make.triangles(*rc::gen::inRange<std::size_t>(2, 100));
    auto fewer = corner_triangles(soup), more = fewer;
    fewer.insert(fewer.end(), soup.begin(), soup.begin() + static_cast<std::ptrdiff_t>(soup.size() / 2));
    more.insert(more.end(), soup.begin(), soup.end());
    const TypeParam some(fewer), all(more);
    for (int i = 0; i < 10; ++i) {
      const Ray<T> ray = make.ray(soup);
      const Vec<T, 3> q = make.place(soup);
      if (some.any_hit(ray)) RC_ASSERT(all.any_hit(ray));
      const auto distance = [&](const TypeParam& tree) {
        return std::sqrt(double(tree.closest_point(q).distance2));
      };
      RC_ASSERT(distance(all) <= distance(some) * (1 + 4 * double(std::numeric_limits<T>::epsilon())));
    }
  });
  EXPECT_TRUE(ok);
}

TYPED_TEST_P(TriangleLaws, AnswersDoNotDependOnThreadsOrBatches) {
  using T = typename TypeParam::Scalar;
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  SoupMaker<T> make{Pcg32(1), SoupMaker<T>::grid};  // full of ties
  auto soup = make.triangles(100);
  make.kind = SoupMaker<T>::even;
  for (const auto& t : make.triangles(300)) soup.push_back(t);
  const TypeParam tree(soup);
  constexpr std::size_t n = 700;
  constexpr T limit = std::numeric_limits<T>::infinity();
  std::vector<Ray<T>> rays;
  std::vector<Vec<T, 3>> places;
  for (std::size_t i = 0; i < n; ++i) rays.push_back(make.ray(soup)), places.push_back(make.place(soup));

  std::vector<Hit<T>> hit_of(n);
  std::vector<accel::ClosestPoint<T>> nearest_of(n);
  std::vector<std::uint8_t> any_of(n), in_of(n);
  for (std::size_t i = 0; i < n; ++i) {
    hit_of[i] = tree.closest_hit(rays[i]), any_of[i] = tree.any_hit(rays[i]);
    nearest_of[i] = tree.closest_point(places[i]), in_of[i] = tree.contains(places[i]);
  }

  for (int threads : {1, 2, 3, 8})
    for (std::size_t size : {std::size_t{1}, std::size_t{7}, std::size_t{256}, n}) {
      if (size == 1 && threads > 2) continue;
      std::vector<Hit<T>> hits(n);
      std::vector<std::uint8_t> any(n, 2), in(n, 2);
      std::vector<accel::ClosestPoint<T>> near(n);
      for (std::size_t i = 0; i < n; i += size) {
        const std::size_t m = std::min(size, n - i);
        const auto some_rays = std::span(std::as_const(rays)).subspan(i, m);
        const auto some_places = std::span(std::as_const(places)).subspan(i, m);
        tree.closest_hit(some_rays, std::span(hits).subspan(i, m), threads);
        tree.any_hit(some_rays, std::span(any).subspan(i, m), threads);
        tree.closest_point(some_places, limit, std::span(near).subspan(i, m), threads);
        tree.contains(some_places, std::span(in).subspan(i, m), threads);
      }
      EXPECT_EQ(hits, hit_of) << threads << " " << size;
      EXPECT_EQ(any, any_of) << threads << " " << size;
      EXPECT_EQ(in, in_of) << threads << " " << size;
      for (std::size_t i = 0; i < n; ++i) {
        ASSERT_EQ(near[i].distance2, nearest_of[i].distance2) << threads << " " << size << " " << i;
        ASSERT_EQ(near[i].primitive, nearest_of[i].primitive) << threads << " " << size << " " << i;
        ASSERT_EQ(near[i].point, nearest_of[i].point) << threads << " " << size << " " << i;
      }
    }
}

REGISTER_TYPED_TEST_SUITE_P(TriangleLaws, RaysEqualBruteForce, ClosestPointsEqualBruteForce,
                            MoreTrianglesTakeNothingAway, AnswersDoNotDependOnThreadsOrBatches);
using FastFloat = Trees<Triangles<float, MollerTrumbore>>;
INSTANTIATE_TYPED_TEST_SUITE_P(WatertightFloat, TriangleLaws, WatertightFloat);
INSTANTIATE_TYPED_TEST_SUITE_P(WatertightDouble, TriangleLaws, WatertightDouble);
INSTANTIATE_TYPED_TEST_SUITE_P(FastFloat, TriangleLaws, FastFloat);

}  // namespace
}  // namespace treeline::test
