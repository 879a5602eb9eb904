// The rays of the sets random, axis and grazing, and the mesh that moves: each is what its header says.
#include <gtest/gtest.h>

#include "bench/ray/block.hpp"
#include "bench/ray/moving.hpp"
#include "bench/ray/stray_rays.hpp"
#include "bench/ray/subject.hpp"
#include "bench/ray/task.hpp"
#include "datasets_gen/dataset.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::bench::ray {
namespace {

using geometry::Mesh3f;
using geometry::Rayf;
using geometry::Vec3d;

Mesh3f ball() { return datasets::generate("icosphere", 1000, 3).mesh; }

const RaySet& set_of(const std::vector<RaySet>& sets, const std::string& name) {
  for (const RaySet& set : sets)
    if (set.name == name) return set;
  throw std::out_of_range(name);
}

TEST(RayStray, RandomRaysStartInTheBox) {
  const geometry::Box3d box{{-1, 2, 3}, {4, 5, 6}};
  const auto rays = random_rays(box, 500, 1);
  ASSERT_EQ(rays.size(), 500u);
  for (const Rayf& r : rays) {
    EXPECT_TRUE(box.contains(Vec3d(r.origin)));
    EXPECT_NEAR(geometry::length(Vec3d(r.direction)), 1, 1e-6);
  }
}

TEST(RayStray, AxisRaysHaveTwoZerosOfEitherSignAndHit) {
  const Mesh3f mesh = ball();
  const auto rays = axis_rays(mesh, solid_faces(mesh), robust_box(mesh), 400, 1);
  ASSERT_EQ(rays.size(), 400u);
  int positive = 0, negative = 0;
  for (const Rayf& r : rays) {
    int zeros = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (r.direction[axis] != 0) continue;
      ++zeros;
      ++(std::signbit(r.direction[axis]) ? negative : positive);
    }
    EXPECT_EQ(zeros, 2);
  }
  EXPECT_GT(std::min(positive, negative), 300);
  std::size_t hits = 0;
  for (const TrueHit& hit : true_closest(mesh, rays, 1)) hits += static_cast<bool>(hit);
  EXPECT_EQ(hits, rays.size()) << "of a closed mesh seen from outside, each";
}

TEST(RayStray, GrazingRaysGraze) {
  const Mesh3f mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const auto rays = grazing_rays(mesh, solid_faces(mesh), 1000, 1);
  ASSERT_EQ(rays.size(), 1000u);
  std::size_t hits = 0, flat = 0;
  for (const Rayf& r : rays) {
    flat += std::abs(r.direction[2]) < 1e-3f;
    EXPECT_LT(std::abs(r.direction[2]), 0.11f);
  }
  for (const TrueHit& hit : true_closest(mesh, rays, 1)) hits += static_cast<bool>(hit);
  EXPECT_NEAR(static_cast<double>(flat), 333, 60) << "a third of the logarithmic range from 1e-4 to 1e-1";
  EXPECT_GT(hits, 950u);
}

TEST(RayStray, ShuffledRaysAreThoseOfTheCamera) {
  const auto sets = make_ray_sets(ball(), 400, 5, 1);
  const RaySet &camera = set_of(sets, "camera"), &shuffled = set_of(sets, "camera_shuffled");
  ASSERT_EQ(shuffled.place.size(), camera.rays.size());
  std::size_t moved = 0;
  for (std::size_t i = 0; i < camera.rays.size(); ++i) {
    EXPECT_EQ(camera.rays[i].direction, shuffled.rays[shuffled.place[i]].direction);
    moved += shuffled.place[i] != i;
  }
  EXPECT_GT(moved, 300u);
}

TEST(RayStray, ATwistTurnsAndKeepsHeights) {
  const Mesh3f mesh = ball(), turned = twisted(mesh, 8);
  const auto box = robust_box(mesh);
  EXPECT_EQ(turned.faces, mesh.faces);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3d p = Vec3d(mesh.vertices[i]) - box.centre(), q = Vec3d(turned.vertices[i]) - box.centre();
    EXPECT_NEAR(p[2], q[2], 1e-6);
    EXPECT_NEAR(std::hypot(p[0], p[1]), std::hypot(q[0], q[1]), 1e-6);
    if (std::hypot(p[0], p[1]) < 0.1) continue;
    const double angle = std::remainder(std::atan2(q[1], q[0]) - std::atan2(p[1], p[0]), 2 * M_PI);
    EXPECT_NEAR(angle, 0.8 * p[2] / box.extent()[2], 1e-4);
  }
  EXPECT_EQ(twisted(mesh, 0).vertices.size(), mesh.vertices.size());
}

/// Brute force that can be refitted: it copies the mesh. With `stale` it says so and does not.
class Refitted final : public Index {
 public:
  Refitted(const Mesh3f& mesh, bool stale) : mesh_(mesh), stale_(stale) {}
  void closest(std::span<const Rayf> rays, std::span<RayAnswer> out, const Knobs&, int) const override {
    const auto truth = true_closest(mesh_, rays, 1);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      out[i] = {};
      if (truth[i]) out[i].t = static_cast<float>(truth[i].t), out[i].primitive = truth[i].primitive;
    }
  }
  void any(std::span<const Rayf>, std::span<std::uint8_t>, const Knobs&, int) const override {}
  bool refit(const Mesh3f& mesh) override {
    if (!stale_) mesh_ = mesh;
    return true;
  }

 private:
  Mesh3f mesh_;
  bool stale_;
};

TEST(RayStray, FramesAreJudgedAgainstTheMovedMesh) {
  for (const bool stale : {false, true}) {
    const std::vector<Method> methods{
        {.info = {.name = "refitted", .family = "brute", .claim = Claim::bounded},
         .build = [stale](const Mesh3f& mesh, const Knobs&, int) -> std::unique_ptr<Index> {
           return std::make_unique<Refitted>(mesh, stale);
         }}};
    BlockInput input;
    input.mesh = ball();
    input.moved = {twisted(input.mesh, 16)};
    input.sets.push_back({.name = "random", .rays = random_rays(robust_box(input.mesh), 200, 1)});
    add_moving_sets(input.sets, input.moved, {16}, 400, 1);
    RayBlock block(std::move(input), methods);
    const auto subject = block.build(0, {}, 1);
    for (std::size_t set = 0; set < 3; ++set) {
      const bool refit = block.query_sets()[set].name == "frame16_refit";
      subject->prepare(set, 1);
      subject->run(set, {}, 1);
      const Errors errors = block.check(0, *subject, set, {});
      EXPECT_EQ(errors.within_claim, !(stale && refit)) << block.query_sets()[set].name << errors.reason;
      EXPECT_EQ(errors.extra.at("ray_update_s").is_null(), set == 0);
    }
  }
}

/// Answers the truth, t off by a length.
class Shifted final : public Index {
 public:
  Shifted(const Mesh3f& mesh, float by) : mesh_(mesh), by_(by) {}
  void closest(std::span<const Rayf> rays, std::span<RayAnswer> out, const Knobs&, int) const override {
    const auto truth = true_closest(mesh_, rays, 1);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      out[i] = {};
      if (truth[i]) out[i].t = static_cast<float>(truth[i].t) + by_, out[i].primitive = truth[i].primitive;
    }
  }
  void any(std::span<const Rayf>, std::span<std::uint8_t>, const Knobs&, int) const override {}

 private:
  const Mesh3f& mesh_;
  float by_;
};

TEST(RayStray, ErrorsOfTAreToldInUlpAndBeyondTheTriangle) {
  // Square to the rays: the triangle takes up a single t, 2, where floats are 2^-22 apart.
  const Mesh3f mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const std::vector<Rayf> rays{
      {{0.25f, 0.25f, 2}, {0, 0, -1}}, {{0.125f, 0.5f, 2}, {0, 0, -1}}, {{3, 3, 2}, {0, 0, -1}}};
  struct Case {
    float by;
    double ulp;
    std::size_t outside;
  };
  for (const Case c : {Case{0, 0, 0}, Case{0x1p-21f, 2, 0}, Case{0.25f, 0x1p20, 2}}) {
    const std::vector<Method> methods{
        {.info = {.name = "shifted", .family = "brute", .claim = Claim::bounded},
         .build = [c](const Mesh3f& m, const Knobs&, int) -> std::unique_ptr<Index> {
           return std::make_unique<Shifted>(m, c.by);
         }}};
    BlockInput input;
    input.mesh = mesh;
    input.sets.push_back({.name = "closest", .rays = rays});
    RayBlock block(std::move(input), methods);
    const auto subject = block.build(0, {}, 1);
    subject->run(0, {}, 1);
    const Errors errors = block.check(0, *subject, 0, {});
    EXPECT_EQ(errors.extra.at("ray_t_ulp_max"), c.ulp);
    EXPECT_EQ(errors.extra.at("ray_t_ulp_mean"), c.ulp);
    EXPECT_EQ(errors.extra.at("ray_t_outside"), c.outside);
    EXPECT_EQ(errors.extra.at("ray_surplus"), 0);
    EXPECT_TRUE(errors.extra.at("ray_leaks_per_million").is_null());
  }
}

TEST(RayStray, AMethodWithoutRefitSaysSo) {
  const RayTask task;
  RunContext context;
  context.profile = Profile::smoke;
  const auto block = task.open(BlockSpec{"icosphere", 1000}, context);
  for (std::size_t m = 0; m < task.methods().size(); ++m) {
    const auto& info = task.methods()[m];
    if (info.name != "cgal_aabb" && info.name != "embree_single") continue;
    for (const Knobs& knobs : info.build_knobs) {
      const auto subject = block->build(m, knobs, 1);
      for (std::size_t set = 0; set < block->query_sets().size(); ++set) {
        if (!block->query_sets()[set].name.ends_with("_refit")) continue;
        if (knobs.value("quality", "") == "refit") {
          subject->prepare(set, 1);
          subject->run(set, {}, 1);
          EXPECT_TRUE(block->check(m, *subject, set, {}).within_claim);
        } else {
          EXPECT_THROW(subject->prepare(set, 1), Unsupported) << info.name;
        }
      }
    }
  }
}

TEST(RayStray, NoOffsetHitsTheSurfaceAndALargeOneDoesNot) {
  for (const auto& c : datasets::hard_cases()) {
    if (c.outward.empty()) continue;
    const auto hits = [&](const std::string& name) {
      for (const auto& out : c.outward)
        if (out.name == name) {
          std::size_t n = 0;
          for (const TrueHit& hit : true_closest(c.mesh, out.rays, 1)) n += static_cast<bool>(hit);
          return static_cast<double>(n) / static_cast<double>(out.rays.size());
        }
      return -1.0;
    };
    EXPECT_GT(hits("offset_0"), 0.3);
    EXPECT_EQ(hits("offset_1e-5"), 0);
    EXPECT_EQ(hits("waechter_binder"), 0);
  }
}

}  // namespace
}  // namespace treeline::bench::ray
