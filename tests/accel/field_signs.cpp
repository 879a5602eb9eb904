// Signs of sampled fields where faces coincide, cross or are missing, and whether the report tells.
#include "accel/bvh/wide_triangles.hpp"
#include "accel/kd_tree/triangles.hpp"
#include "accel/signed_distance.hpp"
#include "geometry/exact/column_grid.hpp"
#include "tests/accel/field_common.hpp"

namespace treeline::accel::field::test {
namespace {

Mesh3f boxes(std::initializer_list<geometry::Box3f> of) {
  Mesh3f mesh;
  for (const auto& box : of) accel::test::add_box(mesh, box);
  return mesh;
}

FieldOptions resolution(int n) {
  FieldOptions o;
  o.resolution = n;
  return o;
}

/// Every sample's sign is the winding number's, and look-ups keep to their bounds.
template <class AnyTree>
void expect_right(const Mesh3f& mesh, int cells, const std::string& name) {
  const AnyTree tree(mesh);
  const auto s = sample_mesh<BrickSamples>(mesh, tree, resolution(cells));
  ASSERT_TRUE(s.report().certain()) << name;
  const Lattice& l = s.lattice();
  for (int k = 0; k < l.samples(2); ++k)
    for (int j = 0; j < l.samples(1); ++j)
      for (int i = 0; i < l.samples(0); ++i) {
        const float value = s.value(i, j, k);
        if (std::abs(double(value)) <= s.widths().rounding) continue;
        ASSERT_EQ(value<0, winding(mesh, l.position(i, j, k))> 0.5)
            << name << " at " << l.position(i, j, k)[0] << " " << l.position(i, j, k)[1] << " "
            << l.position(i, j, k)[2];
      }
  const Trilinear field(s);
  Pcg32 random(11);
  for (int n = 0; n < 3000; ++n) {
    const Vec3d p = in_box(random, s.bounds());
    const FieldSample f = field.sample(p);
    const double truth = true_distance(mesh, p);
    if (f.known)
      ASSERT_LE(std::abs(f.distance - truth), f.error) << name;
    else
      ASSERT_LE(std::abs(f.distance), std::abs(truth)) << name;
  }
}

const geometry::Box3f left{{0, 0, 0}, {1, 1, 1}}, right{{1, 0, 0}, {2, 1, 1}},
    part{{1, 0.25f, 0.25f}, {1.5f, 0.75f, 0.75f}};

template <class AnyTree>
void expect_right_where_shells_touch() {
  for (const int cells : {8, 12, 24}) {
    const std::string at = " at " + std::to_string(cells);
    expect_right<AnyTree>(boxes({left, right}), cells, "touching" + at);
    expect_right<AnyTree>(boxes({right, left}), cells, "touching, the other order" + at);
  }
  for (const int cells : {9, 16}) {
    const std::string at = " at " + std::to_string(cells);
    expect_right<AnyTree>(boxes({left, part}), cells, "touching in part" + at);
    expect_right<AnyTree>(boxes({part, left}), cells, "touching in part, the other order" + at);
  }
}
TEST(FieldSigns, WhereShellsTouchOverTheBinaryTree) { expect_right_where_shells_touch<Tree>(); }
TEST(FieldSigns, WhereShellsTouchOverTheWideTree) {
  expect_right_where_shells_touch<Bvh<Triangles<float>, Wide>>();
}
TEST(FieldSigns, WhereShellsTouchOverTheKdTree) {
  expect_right_where_shells_touch<KdTree<Triangles<float>>>();
}

TEST(FieldSigns, WhereShellsCrossNestAndCoincide) {
  const geometry::Box3f across{{0.5f, 0.25f, 0.25f}, {2, 2, 2}},
      within{{0.25f, 0.25f, 0.25f}, {0.5f, 0.5f, 0.5f}};
  for (const int cells : {9, 24}) {
    expect_right<Tree>(boxes({left, across}), cells, "crossing");
    expect_right<Tree>(boxes({left, within}), cells, "nested, facing the same way");
    expect_right<Tree>(boxes({left, left}), cells, "twice");
  }
}

// Turned inside out a mesh encloses nothing: the same distances, all of them positive.
TEST(FieldSigns, AMeshInsideOutEnclosesNothing) {
  for (const Mesh3f& mesh : {boxes({left}), boxes({left, right}), nested(2)}) {
    Mesh3f turned = mesh;
    for (auto& face : turned.faces) std::swap(face[1], face[2]);
    const auto straight = sample_mesh<BrickSamples>(mesh, Tree(mesh), resolution(16));
    const auto s = sample_mesh<BrickSamples>(turned, Tree(turned), resolution(16));
    EXPECT_FALSE(straight.report().inside_out);
    EXPECT_EQ(straight.report().parts_inside_out, 0u);
    EXPECT_TRUE(s.report().inside_out);
    EXPECT_GE(s.report().parts_inside_out, 1u);
    EXPECT_TRUE(s.report().certain());
    const bool hollow = mesh.size() > 100;  // nested: its hollow is enclosed once when all is turned
    const Lattice& l = s.lattice();
    for (int k = 0; k < l.samples(2); ++k)
      for (int j = 0; j < l.samples(1); ++j)
        for (int i = 0; i < l.samples(0); ++i) {
          const float value = s.value(i, j, k);
          ASSERT_EQ(std::abs(value), std::abs(straight.value(i, j, k)));
          if (!hollow && std::abs(double(value)) > s.widths().rounding) {
            ASSERT_GT(value, 0);
          }
        }
    if (!hollow) expect_right<Tree>(turned, 12, "inside out");
  }
}

// A part that looks inward takes away from those around it, alone it has no inside.
TEST(FieldSigns, PartsThatLookInwardAreHollowsOrNothing) {
  Mesh3f mesh = boxes({left, {{0.25f, 0.25f, 0.25f}, {0.75f, 0.75f, 0.75f}}, {{3, 0, 0}, {3.5f, 1, 1}}});
  for (std::size_t f = 12; f < 36; ++f) std::swap(mesh.faces[f][1], mesh.faces[f][2]);
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), resolution(48));
  EXPECT_FALSE(s.report().inside_out);         // 1 - 1/8 - 1/2 is positive
  EXPECT_EQ(s.report().parts_inside_out, 1u);  // not the hollow
  Mesh3f soup;
  for (std::size_t f = 0; f < mesh.size(); ++f) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : mesh.faces[f]) soup.vertices.push_back(mesh.vertices[v]);
    soup.faces.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(sample_mesh<BrickSamples>(soup, Tree(soup), resolution(16)).report().parts_inside_out, 1u);
  const Trilinear field(s);
  EXPECT_LT(field.distance({0.1, 0.5, 0.5}), 0);
  EXPECT_GT(field.distance({0.5, 0.5, 0.5}), 0);
  EXPECT_GT(field.distance({3.25, 0.5, 0.5}), 0);
  expect_right<Tree>(mesh, 20, "parts that look inward");
}

// Two unit boxes: a ray along x meets the first of them 1 from its start, from either end.
TEST(FieldSigns, RaysMeetTheNearerOfTwoBoxesThatTouch) {
  for (const auto& mesh : {boxes({left, right}), boxes({right, left})})
    for (const int cells : {8, 12, 24}) {
      const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), resolution(cells));
      const Trilinear field(s);
      for (int i = 1; i < 20; ++i)
        for (const bool from_right : {false, true}) {
          const Rayd ray{{from_right ? 3.0 : -1.0, i / 20.0 + 0.003, 0.453}, {from_right ? -1.0 : 1.0, 0, 0}};
          const Trace found = sphere_trace(field, ray);
          ASSERT_EQ(found.status, TraceStatus::hit) << cells << " " << i;
          ASSERT_NEAR(found.t, 1, s.lattice().spacing) << cells << " " << i;
        }
    }
}

TEST(FieldSigns, AFaceThatIsNotFiniteOpensTheMesh) {
  Mesh3f mesh = accel::test::sphere<float>(3);
  mesh.vertices[mesh.faces[40][0]][1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(is_closed_cycle(mesh));
  Tree::Options drop;
  drop.non_finite = NonFinite::drop;
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh, drop), resolution(16));
  EXPECT_FALSE(s.report().closed);
  EXPECT_FALSE(s.report().certain());
}

struct Undecided {
  bool inside(const Vec3f&) const { return false; }
  std::optional<bool> decided(const Vec3f&) const { return std::nullopt; }
};

TEST(FieldSigns, WhatNobodyCouldTellIsNotCertain) {
  const Mesh3f mesh = boxes({left});
  const auto s = sample_mesh<BrickSamples>(mesh, Tree(mesh), Undecided{}, resolution(16));
  EXPECT_TRUE(s.report().closed);
  EXPECT_EQ(s.report().undecided_signs, s.report().inside_queries);
  EXPECT_FALSE(s.report().certain());
}

// Far from both boxes, where no brick is kept, a policy calls a slab inside.
TEST(FieldSigns, ConflictsOfEmptyBricksAreCounted) {
  const Mesh3f mesh = boxes({{{-10, 0, 0}, {-9, 1, 1}}, {{9, 0, 0}, {10, 1, 1}}});
  const Tree tree(mesh);
  const InsideBy slab([](const Vec3f& p) { return std::abs(p[0]) < 4; });
  const auto s = sample_mesh<BrickSamples>(mesh, tree, slab, resolution(160));
  ASSERT_LT(Trilinear(s).distance({0, 0.5, 0.5}), 0);
  ASSERT_GT(Trilinear(s).distance({-7, 0.5, 0.5}), 0);
  EXPECT_GT(s.report().sign_conflicts, 0u);
  EXPECT_FALSE(s.report().certain());
}

/// The share of the samples that are farther than half a cell from the surface and not on the side that the
/// whole mesh says.
double wrong_share(const BrickSamples& s, const Mesh3f& whole) {
  const geometry::ColumnGrid columns(whole);
  const Lattice& l = s.lattice();
  std::size_t wrong = 0, all = 0;
  for (int k = 0; k < l.samples(2); ++k)
    for (int j = 0; j < l.samples(1); ++j)
      for (int i = 0; i < l.samples(0); ++i) {
        const float value = s.value(i, j, k);
        if (std::abs(double(value)) < 0.5 * l.spacing) continue;
        ++all, wrong += (value < 0) != (columns(l.position(i, j, k)).winding > 0);
      }
  return double(wrong) / double(all);
}

using WideTree = Bvh<Triangles<float>, Wide>;
template <class Rule>
BrickSamples by(const Mesh3f& mesh, int cells) {
  const WideTree tree(mesh);
  return sample_mesh<BrickSamples>(mesh, tree, SignBy<Rule, WideTree>(mesh, tree), resolution(cells));
}

TEST(FieldSigns, AnyRuleForTheSignWillDoWhereTheMeshIsWhole) {
  const Mesh3f mesh = nested(2);
  for (const auto& s : {by<FirstHit>(mesh, 24), by<RayParity>(mesh, 24), by<Pseudonormal>(mesh, 24),
                        by<Winding>(mesh, 24), sample_mesh<BrickSamples>(mesh, Tree(mesh), resolution(24))}) {
    EXPECT_TRUE(s.report().certain());
    EXPECT_EQ(wrong_share(s, mesh), 0);
  }
}

// Where rays of one octant leave, a small cap of the sphere is missing. In the bricks that span the hole what
// hangs together through it gets one side, so that a brick's worth of samples may be wrong by any rule.
TEST(FieldSigns, OfAMeshWithAHoleTheWindingNumberMakesTheMost) {
  const Mesh3f whole = accel::test::sphere<float>(4);
  Mesh3f mesh = whole;
  std::erase_if(mesh.faces, [&](const auto& f) {
    return dot(Vec3d(mesh.vertices[f[0]]), normalized(Vec3d{0.48, 0.36, 0.8})) > 0.98;
  });
  const auto winding = by<Winding>(mesh, 32), parity = by<RayParity>(mesh, 32),
             first = by<FirstHit>(mesh, 32);
  for (const auto* s : {&winding, &parity, &first}) EXPECT_FALSE(s->report().certain());
  const double best = wrong_share(winding, whole);
  EXPECT_LT(best * double(winding.lattice().sample_count()), brick_size);
  EXPECT_GT(wrong_share(parity, whole), 2 * best + 0.0005);
  EXPECT_GT(wrong_share(first, whole), 2 * best + 0.0005);
}

// Between two shells that face the same way the mesh goes around a point once, within the inner one twice.
TEST(FieldSigns, RulesDifferWhereShellsFaceTheSameWay) {
  const Mesh3f mesh = boxes({{{-1, -1, -1}, {1, 1, 1}}, {{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}}});
  EXPECT_EQ(wrong_share(by<Winding>(mesh, 24), mesh), 0);
  EXPECT_EQ(wrong_share(sample_mesh<BrickSamples>(mesh, Tree(mesh), resolution(24)), mesh), 0);
  const auto parity = by<RayParity>(mesh, 24);
  EXPECT_GT(Trilinear(parity).distance({}), 0);
  EXPECT_EQ(parity.report().sign_conflicts, 0u);
}

TEST(FieldSigns, RefusesFacesThatAreNotThereAndTreesOverOthers) {
  const Mesh3f mesh = boxes({left});
  const Tree tree(mesh);
  Mesh3f wrong = mesh;
  wrong.faces[3][1] = 99;
  const auto refused = [](auto&& f) -> std::string {
    try {
      f();
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "not refused";
  };
  EXPECT_EQ(refused([&] { sample_mesh<BrickSamples>(wrong, tree); }), "face 3 names vertex 99 of 8");
  const InsideBy nowhere([](const Vec3f&) { return false; });
  EXPECT_EQ(refused([&] { sample_mesh<BrickSamples>(wrong, tree, nowhere); }), "face 3 names vertex 99 of 8");
  Mesh3f fewer = mesh;
  fewer.faces.pop_back();
  EXPECT_EQ(refused([&] { sample_mesh<BrickSamples>(fewer, tree); }),
            "the tree is over 12 faces, the mesh has 11");
}

}  // namespace
}  // namespace treeline::accel::field::test
