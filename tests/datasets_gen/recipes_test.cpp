// Recipes: the same bits for any number of threads and on any machine, the size asked for, and the shape
// promised.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>

#include "datasets_gen/dataset.hpp"
#include "geometry/adjacency.hpp"

namespace treeline::datasets {
namespace {

using geometry::Vec3d;

class EveryRecipe : public testing::TestWithParam<Recipe> {};
INSTANTIATE_TEST_SUITE_P(Recipes, EveryRecipe, testing::ValuesIn(recipes().begin(), recipes().end()),
                         [](const auto& info) { return info.param.name; });

TEST_P(EveryRecipe, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return generate(GetParam().name, 30'000, 3).hash();
  };
  const std::uint64_t one = with(1);
  EXPECT_EQ(one, with(2));
  EXPECT_EQ(one, with(7));
}

TEST_P(EveryRecipe, GivesTheSameBitsOnEveryMachine) {
  // These may change only where a recipe is changed on purpose; then its rows are no longer comparable,
  // either.
  static const std::map<std::string, std::uint64_t> pinned{
      {"uniform_cube", 0x6770e2bb0ef90935ull},
      {"uniform_ball", 0x660d3a221eaba528ull},
      {"displaced_sphere", 0xdca1c68113182ad3ull},
      {"clusters", 0x3d0f27842a91ee20ull},
      {"lidar", 0x70b9610fc8650c01ull},
      {"filaments", 0x0df0c5fa72f6f79eull},
      {"grid", 0xa2b4614710d8e137ull},
      {"georeferenced", 0x86980a4ab9b240c3ull},
      {"icosphere", 0x156288b6e7912cfdull},
      {"terrain", 0x7cd55aa213da2dbcull},
      {"architecture", 0x11157ee9226fb09full},
      {"forest", 0x4e432956167b88abull},
      {"nested_shells", 0x38dea7fb9f844471ull},
      {"torus_knot", 0x15753d39da347004ull},
      {"descriptors_8", 0x6dbd9e3454409496ull},
      {"descriptors_32", 0x8baadbbcb7c125b2ull},
      {"descriptors_128", 0xc1351a206d728920ull},
      {"uniform_8", 0x5000969fd23040d7ull},
      {"uniform_32", 0xabfc523ff6597e5full},
      {"uniform_128", 0x1ba1bbf048794efeull},
      {"noise", 0xbe2031b7579b8a3full},
      {"ramp", 0x0a3fbcfbbc9da65full},
      {"checkers", 0xa824f012847b0a8full},
      {"mask", 0x973e6960cd6d0f99ull},
      {"star", 0xb98df844c67b891dull},
      {"marble", 0xe81cc63c418e46f2ull},
  };
  ASSERT_TRUE(pinned.contains(GetParam().name));
  EXPECT_EQ(generate(GetParam().name, 5000, 7).hash(), pinned.at(GetParam().name));
}

TEST_P(EveryRecipe, ComesNearTheSizeAskedFor) {
  for (const auto& [n, share] : {std::pair{1000, 0.07}, std::pair{5000, 0.03}, std::pair{100'000, 0.01}}) {
    const Dataset d = generate(GetParam().name, static_cast<std::size_t>(n), 1);
    EXPECT_NEAR(static_cast<double>(d.size()), n, share * n);
    EXPECT_EQ(d.kind, GetParam().kind);
    EXPECT_EQ(d.name, GetParam().name);
  }
}

TEST_P(EveryRecipe, IsFiniteAndNamesOnlyVerticesThatExist) {
  const Dataset d = generate(GetParam().name, 20'000, 1);
  for (const auto& p : d.cloud.points) EXPECT_TRUE(is_finite(p));
  for (const auto& p : d.mesh.vertices) EXPECT_TRUE(is_finite(p));
  EXPECT_TRUE(std::ranges::all_of(d.vectors.scalars, [](float x) { return std::isfinite(x); }));
  EXPECT_TRUE(std::ranges::all_of(d.image.values, [](float x) { return x >= 0 && x <= 1; }));
  std::vector<bool> used(d.mesh.vertices.size());
  for (const auto& f : d.mesh.faces)
    for (const auto v : f) {
      ASSERT_LT(v, used.size());
      used[v] = true;
    }
  EXPECT_EQ(std::ranges::count(used, false), 0) << "vertices without a face";
}

TEST_P(EveryRecipe, ChangesWithTheSeed) {
  if (GetParam().name == "grid") GTEST_SKIP() << "a grid has no chance in it";
  EXPECT_NE(generate(GetParam().name, 2000, 1).hash(), generate(GetParam().name, 2000, 2).hash());
}

TEST_P(EveryRecipe, IsClosedWherePromised) {
  const Dataset d = generate(GetParam().name, 20'000, 1);
  EXPECT_EQ(d.closed, GetParam().closed);
  if (!GetParam().closed) return;
  const geometry::Adjacency adjacency(d.mesh);
  EXPECT_TRUE(adjacency.closed());
  EXPECT_TRUE(adjacency.oriented());
  EXPECT_TRUE(adjacency.manifold());
  EXPECT_EQ(adjacency.repeated_vertex_faces(), 0u);
  EXPECT_EQ(adjacency.boundary_edges(), 0u);
}

double volume(const geometry::Mesh3f& mesh) {
  double v = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const auto t = geometry::Triangle3d(mesh.triangle(i));
    v += dot(t.a, cross(t.b, t.c)) / 6;
  }
  return v;
}
long euler(const geometry::Mesh3f& mesh) {
  return static_cast<long>(mesh.vertices.size()) -
         static_cast<long>(geometry::Adjacency(mesh).edges().size()) + static_cast<long>(mesh.faces.size());
}

// Distances of 1000 rows: the mean to the nearest other row, over the mean to all others.
double nearness(const std::string& name) {
  const Vectors v = generate(name, 1000, 1).vectors;
  double nearest = 0, all = 0;
  for (std::size_t i = 0; i < 200; ++i) {
    double least = 1e30, sum = 0;
    for (std::size_t j = 0; j < v.size(); ++j) {
      double square = 0;
      for (std::size_t a = 0; a < v.columns; ++a) {
        const double d = static_cast<double>(v.row(i)[a]) - static_cast<double>(v.row(j)[a]);
        square += d * d;
      }
      if (j != i) least = std::min(least, std::sqrt(square)), sum += std::sqrt(square);
    }
    nearest += least, all += sum / 999;
  }
  return nearest / all;
}

TEST(Vectors, DescriptorsHaveNeighboursAndUniformRowsOfManyColumnsHaveNone) {
  for (const char* name : {"descriptors_8", "descriptors_32", "descriptors_128"})
    EXPECT_LT(nearness(name), 0.5) << name;
  EXPECT_GT(nearness("uniform_32"), 0.6);
  EXPECT_GT(nearness("uniform_128"), 0.8);
}

TEST(Vectors, OfOneRecipeStartAlikeWhateverTheNumber) {
  const Vectors few = generate("descriptors_32", 1000, 5).vectors;
  const Vectors many = generate("descriptors_32", 1500, 5).vectors;
  EXPECT_TRUE(std::ranges::equal(few.scalars, std::span(many.scalars).first(few.scalars.size())));
}

TEST(Meshes, HaveTheTopologyOfTheirNames) {
  EXPECT_EQ(euler(generate("icosphere", 20'000, 1).mesh), 2);
  EXPECT_EQ(euler(generate("nested_shells", 20'000, 1).mesh), 2 * 8);
  EXPECT_EQ(euler(generate("torus_knot", 20'000, 1).mesh), 0);
}

TEST(Meshes, FaceOutward) {
  const double ball = 4.18879;
  EXPECT_NEAR(volume(generate("icosphere", 20'000, 1).mesh), ball, 0.15 * ball);
  // A tube of radius 0.15 along a knot of length 14.6 (by quadrature of its closed form); roughness cancels
  // nearly.
  EXPECT_NEAR(volume(generate("torus_knot", 20'000, 1).mesh), 14.6 * 3.14159 * 0.15 * 0.15, 0.1);
  // Shells of radius 1, 0.9 … 0.3, solid and hollow in turn.
  double shells = 0;
  for (int k = 0; k < 8; ++k) shells += (k % 2 == 0 ? ball : -ball) * std::pow(1 - 0.1 * k, 3);
  EXPECT_NEAR(volume(generate("nested_shells", 20'000, 1).mesh), shells, 0.05 * shells);
}

TEST(Meshes, ShellsLieInsideEachOther) {
  // Vertices come shell by shell; radii of neighbouring shells must not overlap.
  const Dataset d = generate("nested_shells", 50'000, 3);
  std::map<int, std::pair<double, double>> range;
  for (const auto& p : d.mesh.vertices) {
    const double r = length(Vec3d(p));
    auto& [low, high] = range.try_emplace(static_cast<int>(r * 10 + 0.5), 9, 0).first->second;
    low = std::min(low, r), high = std::max(high, r);
  }
  ASSERT_EQ(range.size(), 8u);
  for (const auto& [tenth, limits] : range) EXPECT_LT(limits.second - limits.first, 0.04) << tenth;
}

TEST(Meshes, ArchitectureMixesSizesAndSlenderTriangles) {
  const Dataset d = generate("architecture", 100'000, 1);
  double least = 1e30, largest = 0;
  std::size_t slender = 0;
  for (std::size_t i = 0; i < d.mesh.size(); ++i) {
    const auto t = geometry::Triangle3d(d.mesh.triangle(i));
    const double edge = std::max({length(t.b - t.a), length(t.c - t.b), length(t.a - t.c)});
    least = std::min(least, edge), largest = std::max(largest, edge);
    slender += 2 * t.area() < 0.05 * edge * edge;
  }
  EXPECT_GT(largest / least, 1000);
  EXPECT_GT(slender, d.mesh.size() / 10);
}

TEST(Meshes, ForestIsASoup) {
  const Dataset d = generate("forest", 5000, 1);
  EXPECT_EQ(d.mesh.size(), 5000u);
  EXPECT_EQ(d.mesh.vertices.size(), 15'000u);
  EXPECT_EQ(geometry::Adjacency(d.mesh).boundary_edges(), 15'000u);
}

TEST(Clouds, UniformOnesHaveTheirMoments) {
  constexpr double n = 50'000;
  double x = 0, x2 = 0, r2 = 0;
  for (const auto& p : generate("uniform_cube", 50'000, 1).cloud.points) x += p[0], x2 += p[1] * double(p[1]);
  for (const auto& p : generate("uniform_ball", 50'000, 1).cloud.points) {
    EXPECT_LE(length(Vec3d(p)), 1 + 1e-6);
    r2 += length2(Vec3d(p));
  }
  // Variances: x has 1/12; x² has 1/5 - 1/9; r² in the ball has mean 3/5 and variance 3/7 - 9/25. Bounds: 4
  // sigma.
  EXPECT_LT(std::abs(x / n - 0.5), 4 * std::sqrt(1 / 12.0 / n));
  EXPECT_LT(std::abs(x2 / n - 1 / 3.0), 4 * std::sqrt(4 / 45.0 / n));
  EXPECT_LT(std::abs(r2 / n - 0.6), 4 * std::sqrt((3 / 7.0 - 9 / 25.0) / n));
}

TEST(Clouds, GridPointsAreExactlyOneSpacingApart) {
  const Dataset d = generate("grid", 8000, 1);
  ASSERT_EQ(d.size(), 8000u);
  const float spacing = d.cloud.points[1][0] - d.cloud.points[0][0];
  EXPECT_EQ(spacing, 1 / 32.f);
  for (std::size_t i = 1; i < d.size(); ++i) {
    if (d.cloud.points[i][0] == 0) continue;  // a new row
    EXPECT_EQ(d.cloud.points[i][0] - d.cloud.points[i - 1][0], spacing);
  }
}

TEST(Clouds, LidarDensityFallsWithDistance) {
  double near = 0, far = 0;
  for (const auto& p : generate("lidar", 100'000, 1).cloud.points) {
    if (std::abs(p[2]) > 0.1) continue;  // the ground
    const double r = std::hypot(p[0], p[1]);
    if (r >= 4 && r < 8) near += 1 / (64.0 - 16);
    if (r >= 16 && r < 32) far += 1 / (1024.0 - 256);
  }
  EXPECT_GT(far, 0);
  EXPECT_GT(near, 10 * far);
}

TEST(Clouds, ClusterSharesAreUneven) {
  // Half of all points lie in few clusters, so in a small part of the cells of a coarse grid.
  std::map<int, int> cells;
  for (const auto& p : generate("clusters", 50'000, 1).cloud.points)
    ++cells[static_cast<int>(std::floor(p[0] * 16) * 10'000 + std::floor(p[1] * 16) * 100 +
                             std::floor(p[2] * 16))];
  std::vector<int> counts;
  for (const auto& [cell, count] : cells) counts.push_back(count);
  std::ranges::sort(counts, std::greater<>());
  int sum = 0;
  std::size_t needed = 0;
  while (sum < 25'000) sum += counts[needed++];
  EXPECT_LT(needed, 16u * 16 * 16 / 50);
}

TEST(Generate, RefusesWhatItCannotMake) {
  const auto message = [](auto&& call) {
    try {
      call();
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  const std::string unknown = message([] { generate("cubes", 1000, 1); });
  EXPECT_NE(unknown.find("'cubes'"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("uniform_cube"), std::string::npos) << unknown;
  EXPECT_NE(message([] { generate("grid", 999, 1); }).find("999"), std::string::npos);
  EXPECT_NE(message([] { generate("grid", 10'000'001, 1); }).find("10000001"), std::string::npos);
}

TEST(Generate, IsSilentWhenQuick) {
  int calls = 0;
  generate("uniform_cube", 1000, 1, [&](double) { ++calls; });
  EXPECT_EQ(calls, 0);
}

TEST(Hash, IsOfTheGeometryAlone) {
  Dataset a = generate("icosphere", 1000, 1), b = a;
  b.name = "other", b.seed = 99, b.notes = {"a note"};
  EXPECT_EQ(a.hash(), b.hash());
  b.mesh.vertices[5][1] = std::nextafter(b.mesh.vertices[5][1], 9.f);
  EXPECT_NE(a.hash(), b.hash());
  b = a;
  std::swap(b.mesh.faces[0], b.mesh.faces[1]);
  EXPECT_NE(a.hash(), b.hash());
  b = a;
  b.mesh.vertices.pop_back();
  EXPECT_NE(a.hash(), b.hash());
}

}  // namespace
}  // namespace treeline::datasets
