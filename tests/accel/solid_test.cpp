// BSP trees of meshes as solids: against exact parity, brute force, closed forms and laws.
#include "accel/bsp_solid.hpp"

#include <gtest/gtest.h>

#include "geometry/exact/orientation.hpp"
#include "tests/geometry/meshes.hpp"

namespace treeline::test {
namespace {

using namespace treeline::accel;
using Tree = BspTree<Solid<>>;

Mesh3d on_grid(Mesh3d m, double steps = 0x1p20) {
  for (auto& p : m.vertices)
    for (int k = 0; k < 3; ++k) p[k] = std::rint(p[k] * steps) / steps;
  return m;
}
Mesh3d nested() {
  Mesh3d m = sphere<double>(2);
  for (const double scale : {0.75, 0.5}) {
    const auto base = static_cast<std::uint32_t>(m.vertices.size());
    const Mesh3d s = moved(sphere<double>(2), {0, 0, 0}, scale);
    m.vertices.insert(m.vertices.end(), s.vertices.begin(), s.vertices.end());
    for (auto f : s.faces) {
      if (scale == 0.75) std::swap(f[0], f[1]);
      m.faces.push_back({f[0] + base, f[1] + base, f[2] + base});
    }
  }
  return m;
}
std::vector<std::pair<std::string, Mesh3d>> meshes() {
  return {{"sphere", on_grid(sphere<double>(3))},    {"cube", on_grid(cube<double>(1))},
          {"spiky", on_grid(spiky<double>(3, 1))},   {"sheet", on_grid(sheet<double>(3, 0.01))},
          {"torus", on_grid(torus<double>(24, 12))}, {"nested", on_grid(nested())}};
}
std::vector<std::pair<std::string, SolidOptions>> strategies() {
  return {{"first", SolidOptions::first_face()}, {"best", SolidOptions::best_face()}, {"shallow", {}}};
}

/// By the parity of crossings of a segment to a far point, each decided exactly; another point if it meets an
/// edge.
Location parity(const Mesh3d& mesh, const Vec3d& p, Pcg32& random) {
  for (;;) {
    const Vec3d q = normalized(random_vec<double>(random)) * 64.0;
    bool odd = false, clear = true;
    for (std::size_t f = 0; f < mesh.size() && clear; ++f) {
      const Triangle3d t = mesh.triangle(f);
      const int s[3] = {orientation(p, q, t.b, t.c), orientation(p, q, t.c, t.a),
                        orientation(p, q, t.a, t.b)};
      const bool positive = s[0] > 0 || s[1] > 0 || s[2] > 0, negative = s[0] < 0 || s[1] < 0 || s[2] < 0;
      if (positive && negative) continue;
      const int from = orientation(t.a, t.b, t.c, p), to = orientation(t.a, t.b, t.c, q);
      if (from == 0 && to != 0) return Location::on;
      if (s[0] == 0 || s[1] == 0 || s[2] == 0)
        clear = from * to > 0;
      else if (from * to < 0)
        odd = !odd;
    }
    if (clear) return odd ? Location::inside : Location::outside;
  }
}

/// Anywhere, near the surface, in it as far as rounding allows, and at vertices.
Vec3d query(const Mesh3d& mesh, int i, Pcg32& random) {
  if (i % 4 == 0) return random_vec<double>(random, -1.4, 1.4);
  const Triangle3d t = mesh.triangle(random.below(static_cast<std::uint32_t>(mesh.size())));
  if (i % 4 == 1) return i % 8 == 1 ? t.a : t.a * 0.5 + t.b * 0.5;
  const double u = random.uniform(), v = random.uniform() * (1 - u);
  const Vec3d p = t.a * (1 - u - v) + t.b * u + t.c * v;
  return i % 4 == 2 ? p : p + random_vec<double>(random) * 1e-3;
}

TEST(Solid, LocatesLikeParity) {
  for (const auto& [name, mesh] : meshes())
    for (const auto& [how, options] : strategies()) {
      SCOPED_TRACE(name + ", " + how);
      const Tree tree(mesh, options);
      Pcg32 random(11);
      int counts[3] = {};
      for (int i = 0; i < 400; ++i) {
        const Vec3d p = query(mesh, i, random);
        const Location truth = parity(mesh, p, random);
        ASSERT_EQ(tree.locate(p), truth) << i;
        ++counts[static_cast<int>(truth)];
      }
      for (const int c : counts) EXPECT_GT(c, 10);
      EXPECT_EQ(tree.stats().moved, 0u);
    }
}

double largest(const Vec3d& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }
double area(std::span<const Vec3d> outline) {
  Vec3d n{};
  for (std::size_t i = 2; i < outline.size(); ++i)
    n += cross(outline[i - 1] - outline[0], outline[i] - outline[0]);
  return length(n) / 2;
}

TEST(Solid, PiecesCoverTheirFaces) {
  for (const auto& [name, mesh] : meshes())
    for (const auto& [how, options] : strategies()) {
      SCOPED_TRACE(name + ", " + how);
      const Tree tree(mesh, options);
      std::vector<double> covered(mesh.size());
      std::size_t pieces = 0;
      tree.paint({5, 4, 3}, [&](Id face, std::span<const Vec3d> outline) {
        ASSERT_GE(outline.size(), 3u);
        covered[face] += area(outline), ++pieces;
      });
      EXPECT_EQ(pieces, tree.stats().fragments);
      for (std::size_t f = 0; f < mesh.size(); ++f)
        ASSERT_NEAR(covered[f], mesh.triangle(f).area(), 1e-13) << f;
      EXPECT_EQ(tree.stats().leaves, tree.stats().nodes + 1);
    }
}

using RayTest = Watertight::Prepared<double>;

TEST(Solid, PaintsFarPiecesFirst) {
  for (const auto& [name, mesh] : meshes()) {
    SCOPED_TRACE(name);
    const Tree tree(mesh);
    Pcg32 random(5);
    for (const Vec3d& eye : {Vec3d{2, 3, 1}, Vec3d{0.1, 0.2, 0.05}, mesh.vertices[7] * 2.0}) {
      std::vector<Rayd> rays;
      std::vector<RayTest> tests;
      for (int i = 0; i < 20; ++i) rays.push_back({eye, random_vec<double>(random) - eye * 0.9});
      for (const Rayd& r : rays) tests.emplace_back(r);
      std::vector<double> last(rays.size(), INFINITY);
      tree.paint(eye, [&](Id, std::span<const Vec3d> outline) {
        for (std::size_t r = 0; r < rays.size(); ++r)
          for (std::size_t i = 2; i < outline.size(); ++i)
            if (const auto hit = tests[r]({outline[0], outline[i - 1], outline[i]}, 0, INFINITY)) {
              ASSERT_LE(hit->t, last[r] * (1 + 1e-12));
              last[r] = hit->t;
            }
      });
      for (std::size_t r = 0; r < rays.size(); ++r) {
        double nearest = INFINITY;
        for (std::size_t f = 0; f < mesh.size(); ++f)
          if (const auto hit = tests[r](mesh.triangle(f), 0, INFINITY)) nearest = std::min(nearest, hit->t);
        if (std::isinf(nearest)) {
          EXPECT_TRUE(std::isinf(last[r]));
        } else {
          EXPECT_NEAR(last[r], nearest, 1e-11 * nearest);
        }
      }
    }
  }
}

TEST(Solid, RaysHitWhatBruteForceHits) {
  for (const auto& [name, mesh] : meshes()) {
    SCOPED_TRACE(name);
    const Tree tree(mesh);
    Pcg32 random(9);
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
      Rayd ray{random_vec<double>(random, -2, 2), random_vec<double>(random)};
      if (i % 3 == 1) ray.direction = query(mesh, i, random) - ray.origin;
      if (i % 3 == 2) ray.direction = {0, i % 2 == 0 ? 1.0 : -1.0, 0};
      if (i % 5 == 0) ray.t_max = 1.5;
      if (i % 7 == 0) ray.t_min = 1;
      const RayTest test(ray);
      double nearest = INFINITY;
      for (std::size_t f = 0; f < mesh.size(); ++f)
        if (const auto hit = test(mesh.triangle(f), ray.t_min, ray.t_max))
          nearest = std::min(nearest, hit->t);
      ASSERT_EQ(tree.closest_hit(ray).t, nearest) << i;
      hits += std::isfinite(nearest);
    }
    EXPECT_GT(hits, 50);
  }
}

Mesh3d box_mesh(const Vec3d& low, const Vec3d& high) {
  Mesh3d m = cube<double>(-1);
  for (auto& p : m.vertices)
    for (int k = 0; k < 3; ++k) p[k] = p[k] < 0 ? low[k] : high[k];
  return m;
}
SolidOptions common_grid(std::initializer_list<const Mesh3d*> all) {
  Box<double, 3> box;
  for (const Mesh3d* m : all) box = merged(box, m->box());
  SolidOptions o;
  o.grid = SolidGrid::over(box);
  return o;
}

// Boxes that cross, touch in a face, share part of a plane, lie in one another, coincide, and are apart.
TEST(SolidMerge, BoxesHaveTheVolumesOfSchool) {
  const Vec3d lows[] = {{0.5, 0.25, 0.125}, {1, 0, 0}, {0, 0.5, 0},   {0.25, 0.25, 0.25},
                        {0, 0, 0},          {2, 2, 2}, {1, 0.5, 0.25}};
  const double sizes[] = {1, 1, 1, 0.5, 1, 1, 2};
  for (std::size_t i = 0; i < std::size(lows); ++i) {
    SCOPED_TRACE(i);
    const Mesh3d a = box_mesh({0, 0, 0}, {1, 1, 1}), b = box_mesh(lows[i], lows[i] + Vec3d::filled(sizes[i]));
    double common = 1;
    for (int k = 0; k < 3; ++k) common *= std::max(0.0, std::min(1.0, lows[i][k] + sizes[i]) - lows[i][k]);
    const SolidOptions options = common_grid({&a, &b});
    const Tree x(a, options), y(b, options);
    const double vb = sizes[i] * sizes[i] * sizes[i];
    EXPECT_EQ(merged(x, y, Merge::unite).volume(), 1 + vb - common);
    EXPECT_EQ(merged(x, y, Merge::intersect).volume(), common);
    EXPECT_EQ(merged(x, y, Merge::subtract).volume(), 1 - common);
    EXPECT_EQ(merged(y, x, Merge::subtract).volume(), vb - common);
  }
}

TEST(SolidMerge, PointsAndVolumesFollowSetAlgebra) {
  const Mesh3d a = on_grid(spiky<double>(3, 1)), b = moved(a, Vec3d{0.25, 0.125, 0.0625}),
               c = on_grid(torus<double>(24, 12));
  for (const auto& [p, q] : {std::pair{&a, &b}, std::pair{&a, &c}, std::pair{&b, &c}}) {
    const SolidOptions options = common_grid({p, q});
    const Tree x(*p, options), y(*q, options);
    ASSERT_EQ(x.stats().moved + y.stats().moved, 0u);
    const Tree both = merged(x, y, Merge::unite), common = merged(x, y, Merge::intersect),
               rest = merged(x, y, Merge::subtract);
    const double v = x.volume(), w = y.volume(), u = both.volume(), i = common.volume();
    EXPECT_NEAR(u + i, v + w, 1e-13 * (v + w));
    EXPECT_NEAR(rest.volume() + i, v, 1e-13 * v);
    EXPECT_GT(i, 0.01 * v);
    // What is cut apart fits together again, in yet another tree.
    const Tree again = merged(rest, common, Merge::unite);
    EXPECT_NEAR(again.volume(), v, 1e-13 * v);
    Pcg32 random(4);
    for (int n = 0; n < 3000; ++n) {
      const Vec3d point = query(n % 2 == 0 ? *p : *q, n, random);
      const Location k = x.locate(point), l = y.locate(point);
      if (k == Location::on && l == Location::on) continue;  // what is on both may vanish
      const auto of = [](bool in, bool on) {
        return in ? Location::inside : on ? Location::on : Location::outside;
      };
      const bool k_in = k == Location::inside, l_in = l == Location::inside, k_out = k == Location::outside,
                 l_out = l == Location::outside;
      ASSERT_EQ(both.locate(point), of(k_in || l_in, !(k_out && l_out)));
      ASSERT_EQ(common.locate(point), of(k_in && l_in, !k_out && !l_out));
      ASSERT_EQ(rest.locate(point), of(k_in && l_out, !k_out && !l_in));
      ASSERT_EQ(again.locate(point), k);
    }
  }
}

// Volume of the region common to a cube and itself turned by 45° about an axis: a regular octagon, 8 (sqrt(2)
// - 1).
TEST(SolidMerge, TurnedCubesShareAnOctagon) {
  const Mesh3d a = box_mesh({-1, -1, -1}, {1, 1, 1});
  Mesh3d b = a;
  for (auto& p : b.vertices) p = {(p[0] - p[1]) * std::sqrt(0.5), (p[0] + p[1]) * std::sqrt(0.5), p[2]};
  const SolidOptions options = common_grid({&a, &b});
  const Tree x(a, options), y(b, options);
  EXPECT_NEAR(merged(x, y, Merge::intersect).volume(), 16 * (std::sqrt(2.0) - 1),
              1e-6);  // the turned one is moved
  EXPECT_GT(y.stats().moved, 0u);
}

TEST(Solid, ConvexSolidsDoNotMakeAList) {
  const Mesh3d mesh = on_grid(sphere<double>(5));
  EXPECT_LT(Tree(mesh).stats().depth, 100u);
  EXPECT_EQ(Tree(on_grid(sphere<double>(3)), SolidOptions::first_face()).stats().depth, 512u);
}

// What the strategies are for: few pieces, and neither a list nor a deep tree.
TEST(Solid, RoughSpheresStayFewAndShallow) {
  Mesh3d mesh = sphere<double>(6);
  for (auto& p : mesh.vertices)
    p = p * (1 + 0.05 * std::sin(9 * p[0]) * std::sin(8 * p[1] + 1) * std::sin(7 * p[2]));
  mesh = on_grid(mesh);
  const SolidStats s = Tree(mesh).stats(), best = Tree(mesh, SolidOptions::best_face()).stats();
  EXPECT_LE(s.fragments, 2.3 * static_cast<double>(mesh.size()));
  EXPECT_LE(s.depth, 40u);
  EXPECT_LE(best.fragments, 2.1 * static_cast<double>(mesh.size()));
}

TEST(Solid, RoundingLosesPoints) {
  const Mesh3d mesh = on_grid(spiky<double>(3, 1));
  SolidOptions options = SolidOptions::best_face();
  options.epsilon = 1e-8;
  const BspTree<Solid<solid::RoundedSpace<float>>> rounded(mesh, options);
  const Tree exact(mesh, options);
  Pcg32 random(2);
  int wrong = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d p = query(mesh, 4 * i + 3, random);
    wrong += rounded.locate(p) != exact.locate(p);
  }
  EXPECT_GT(wrong, 0);
  EXPECT_GT(rounded.stats().fragments, exact.stats().fragments);
}

TEST(Solid, RefusesWhatBoundsNothing) {
  Mesh3d m = cube<double>(0);
  const auto refused = [](const Mesh3d& mesh, const std::string& why) {
    try {
      Tree tree(mesh);
      ADD_FAILURE() << "not refused: " << why;
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  refused({}, "no faces");
  Mesh3d open = m;
  open.faces.pop_back();
  refused(open, "3 edges have one face only");
  Mesh3d turned = m;
  std::swap(turned.faces[5][0], turned.faces[5][1]);
  refused(turned, "3 edges have faces that run the same way");
  Mesh3d inside_out = m;
  for (auto& f : inside_out.faces) std::swap(f[0], f[1]);
  refused(inside_out, "inside out");
  for (const Mesh3d& no_solid : {open, turned, inside_out}) EXPECT_THROW(Tree{no_solid}, NotASolid);
  Mesh3d broken = m;
  broken.vertices[9][1] = NAN;
  refused(broken, "vertex 9 is not finite");
  const Tree a(m), b(moved(m, Vec3d{1, 0, 0}));
  EXPECT_THROW(merged(a, b, Merge::unite), InvalidInput);
  EXPECT_THROW(a.locate({0, NAN, 0}), InvalidInput);
}

Mesh3d together(const Mesh3d& a, const Mesh3d& b) {
  Mesh3d m = a;
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  m.vertices.insert(m.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& f : b.faces) m.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  return m;
}
Mesh3d turned_around(Mesh3d m) {
  for (auto& f : m.faces) std::swap(f[0], f[1]);
  return m;
}
/// What a build of any kind says; empty: nothing.
std::string told(const Mesh3d& mesh) {
  std::string all;
  for (const auto& [how, options] : strategies()) try {
      Tree tree(mesh, options);
      all += "taken ";
    } catch (const NotASolid& e) {
      all += std::string(e.what()) + " ";
    }
  return all;
}
testing::AssertionResult all_refuse(const Mesh3d& mesh, const std::string& why) {
  const std::string s = told(mesh);
  if (s.find("taken") == std::string::npos && s.find(why) != std::string::npos)
    return testing::AssertionSuccess();
  return testing::AssertionFailure() << s;
}
const std::string all_take = "taken taken taken ";

// Sheets that run through each other: what lies in both would be called outside without a word.
TEST(SolidCrossings, AreRefused) {
  const Mesh3d box = box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(all_refuse(together(box, box_mesh({0.75, 0.25, 0.25}, {1.75, 1.25, 1.25})), "run through"));
  EXPECT_TRUE(all_refuse(together(box, box_mesh({-1, 0.25, 0.25}, {2, 0.75, 0.75})), "run through"));
  Pcg32 random(21);
  const Mesh3d ball = on_grid(spiky<double>(2, 1));
  int crossing = 0;
  for (int i = 0; i < 40; ++i) {
    const Mesh3d other = on_grid(moved(ball, random_vec<double>(random) * 1.5));
    // They cross if some corner of one lies in the other and some outside.
    bool in = false, out = false;
    for (const Vec3d& p : other.vertices) (parity(ball, p, random) == Location::inside ? in : out) = true;
    if (!in || !out) continue;
    ++crossing;
    EXPECT_TRUE(all_refuse(together(ball, other), "run through")) << i;
  }
  EXPECT_GT(crossing, 10);
  SolidOptions options;
  options.may_cross_itself = true;
  EXPECT_NO_THROW(Tree(together(box, box_mesh({0.75, 0.25, 0.25}, {1.75, 1.25, 1.25})), options));
}

// Boxes on a grid: the faces of those that overlap often meet along edges or lie flush, and do not cross.
TEST(SolidCrossings, OverlappingBoxesAreRefusedTouchingOnesAreNot) {
  Pcg32 random(5);
  const auto some = [&] {
    Vec3d low, high;
    for (int a = 0; a < 3; ++a) {
      low[a] = random.below(5), high[a] = low[a] + 1 + random.below(4);
    }
    return geometry::Box3d{low, high};
  };
  int overlapping = 0, apart = 0;
  for (int i = 0; i < 150; ++i) {
    const geometry::Box3d a = some(), b = some();
    bool overlap = true;
    for (int k = 0; k < 3; ++k) overlap = overlap && a.low[k] < b.high[k] && b.low[k] < a.high[k];
    const Mesh3d both = together(box_mesh(a.low, a.high), box_mesh(b.low, b.high));
    ++(overlap ? overlapping : apart);
    if (overlap)
      EXPECT_TRUE(all_refuse(both, "solid: ")) << i;
    else
      EXPECT_NO_THROW(Tree{both}) << i;
  }
  EXPECT_GT(overlapping, 25);
  EXPECT_GT(apart, 100);
}

TEST(SolidCrossings, TouchingIsNone) {
  const Mesh3d box = box_mesh({0, 0, 0}, {1, 1, 1});
  // In a face, in part of one, at an edge, at a corner, and a corner on a face.
  for (const Vec3d& low :
       {Vec3d{1, 0, 0}, Vec3d{1, 0.25, 0.5}, Vec3d{1, 1, 0.5}, Vec3d{1, 1, 1}, Vec3d{2, 0, 0}})
    EXPECT_EQ(told(together(box, box_mesh(low, low + Vec3d::filled(1)))), all_take) << low[0] << low[1];
  Mesh3d spike = box_mesh({0, 0, 0}, {1, 1, 1});
  for (auto& p : spike.vertices) p = {1 + p[0] + p[1] + p[2], p[1] - p[0] + 0.5, p[2] - p[0] + 0.5};
  EXPECT_EQ(told(together(box, spike)), all_take);
}

TEST(SolidParts, ThatDoNotBoundOneSolidAreRefused) {
  const Mesh3d box = box_mesh({0, 0, 0}, {1, 1, 1}), inner = box_mesh({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75}),
               apart = box_mesh({4, 0, 0}, {4.5, 0.5, 0.5});
  EXPECT_EQ(told(together(box, apart)), all_take);
  EXPECT_EQ(told(together(box, turned_around(inner))), all_take);  // a hollow
  EXPECT_TRUE(all_refuse(together(box, inner), "lies in another one that faces the same way"));
  EXPECT_TRUE(all_refuse(together(box, turned_around(apart)), "is inside out"));
  EXPECT_NE(told(together(box, inner)).find("has face 1"), std::string::npos);  // of the inner one's twelve
  EXPECT_EQ(told(on_grid(nested())), all_take);
}

/// A square tube of one part along a way in the plane, each of whose corners is a right angle.
Mesh3d tube(const std::vector<Vec2d>& way) {
  Mesh3d m;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Vec2d into = i > 0 ? way[i] - way[i - 1] : way[1] - way[0],
                out = i + 1 < way.size() ? way[i + 1] - way[i] : into;
    const Vec2d a = into / length(into), b = out / length(out);
    const Vec2d left = a == b ? Vec2d{-a[1], a[0]} : Vec2d{-a[1] - b[1], a[0] + b[0]};
    for (const auto& [side, z] : {std::pair{-0.5, 0.0}, {0.5, 0.0}, {0.5, 1.0}, {-0.5, 1.0}})
      m.vertices.push_back({way[i][0] + side * left[0], way[i][1] + side * left[1], z});
  }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    m.faces.push_back({a, b, c}), m.faces.push_back({a, c, d});
  };
  const auto last = static_cast<std::uint32_t>(4 * (way.size() - 1));
  quad(0, 3, 2, 1), quad(last, last + 1, last + 2, last + 3);
  for (std::uint32_t r = 0; r < last; r += 4)
    for (std::uint32_t k = 0; k < 4; ++k) quad(r + k, r + (k + 1) % 4, r + 4 + (k + 1) % 4, r + 4 + k);
  return m;
}

// A ring whose end stops short of its start, meets it, or lies in it, flush on four sides.
TEST(SolidParts, OneThatLiesInItselfIsRefused) {
  const auto ring = [](double end) { return tube({{1, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {end, 0}}); };
  EXPECT_EQ(told(ring(0.75)), all_take);
  EXPECT_NO_THROW(Tree{ring(1)});
  EXPECT_EQ(Tree(ring(0.75)).volume(), 3 + 4 + 4 + 4 + 0.75);
  EXPECT_TRUE(all_refuse(ring(2), "lies in another one that faces the same way, or runs through it"));
}

// What is enclosed twice may lie anywhere along a seam: of many parts that touch, two lie in one another.
TEST(SolidParts, AreFoundAmongManyThatTouch) {
  Mesh3d wall;
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 5; ++k) {
      const Vec3d low{double(i), double(k), 0};
      const Mesh3d brick = box_mesh(low, low + Vec3d::filled(1));
      wall = wall.faces.empty() ? brick : together(wall, brick);
    }
  EXPECT_NO_THROW(Tree{wall});
  EXPECT_TRUE(all_refuse(together(wall, box_mesh({2, 2, 0}, {3, 4, 1})), "solid: "));
  EXPECT_TRUE(
      all_refuse(together(wall, box_mesh({2.25, 2.25, 0.25}, {2.75, 2.75, 0.75})), "lies in another"));
}

TEST(Solid, VerticesThatNoFaceNamesDoNotMatter) {
  const Mesh3d mesh = on_grid(sphere<double>(2));
  Mesh3d more = mesh;
  more.vertices.push_back({1e9, 0, 0}), more.vertices.push_back({NAN, 0, 0});
  const Tree tree(more);
  EXPECT_EQ(tree.grid(), Tree(mesh).grid());
  EXPECT_EQ(tree.stats().moved, 0u);
  EXPECT_EQ(tree.locate({0, 0, 0}), Location::inside);
}

TEST(Solid, PaintsForNoEyeThatIsNone) {
  const Tree tree(on_grid(sphere<double>(1)));
  const auto nothing = [](Id, std::span<const Vec3d>) {};
  EXPECT_THROW(tree.paint({0, NAN, 0}, nothing), InvalidInput);
  EXPECT_THROW(tree.paint({INFINITY, 0, 0}, nothing), InvalidInput);
}

TEST(SolidGrid, MovesVerticesByHalfAStepAtMost) {
  const Mesh3d mesh = moved(sphere<double>(3), Vec3d{1000, -3, 0.1}, 0.3);
  const Tree tree(mesh);
  const SolidGrid g = tree.grid();
  EXPECT_LE(g.spacing, 0.6 * 0x1p-24);
  EXPECT_GT(tree.stats().moved, 0u);
  tree.paint({0, 0, 0}, [&](Id face, std::span<const Vec3d> outline) {
    const Triangle3d t = mesh.triangle(face);
    if (outline.size() != 3 || std::abs(area(outline) - t.area()) > 1e-12) return;  // a part
    for (const Vec3d& p : outline)
      EXPECT_LE(std::min({largest(p - t.a), largest(p - t.b), largest(p - t.c)}), g.spacing / 2 * (1 + 1e-9));
  });
}

}  // namespace
}  // namespace treeline::test
