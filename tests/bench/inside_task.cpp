// The task inside as a whole: ours keep their claims on every hard case and the smoke profile, exact ones are
// exact on whole meshes, and what has no inside is refused by name.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <set>

#include "accel/concepts.hpp"
#include "bench/inside/block.hpp"
#include "bench/inside/task.hpp"
#include "datasets_gen/hard/hard_insides.hpp"

namespace treeline::bench::inside {
namespace {

RunContext smoke_context(std::uint64_t seed = 1) {
  RunContext context;
  context.profile = Profile::smoke, context.seed = seed;
  return context;
}

TEST(InsideTask, HasItsMethods) {
  const InsideTask task;
  std::set<std::string> names;
  for (const auto& info : task.methods()) names.insert(info.name);
  for (const auto& [name, package] : task.not_built()) names.insert(name);
  for (const char* name :
       {"wide_first_hit", "wide_parity", "brute_first_hit", "bvh_first_hit", "kd_first_hit", "bsp_first_hit",
        "wide_pseudonormal", "bvh_pseudonormal", "wide_face_normal", "winding", "winding_sum", "bsp_solid",
        "bsp_solid_rounded", "embree_facing", "embree_parity", "cgal_side_of_mesh", "cgal_aabb_parity"})
    EXPECT_TRUE(names.contains(name)) << name;
}

/// Whether a tree of a solid may leave a dataset to others: where the faces bound none.
bool bounds_no_solid(const std::string& dataset) { return dataset.find('+') != std::string::npos; }

/// The errors of every build of ours on every point set of a block.
template <class F>
void each_of_ours(const InsideTask& task, Block& block, const std::string& dataset, F&& f) {
  for (std::size_t m = 0; m < task.methods().size(); ++m) {
    const MethodInfo& info = task.methods()[m];
    if (info.source != Source::ours || info.largest_n < block.n()) continue;
    if (info.stress_builds.empty()) continue;  // it is there to be seen failing
    for (const Knobs& knobs : info.build_knobs) try {
        const auto subject = block.build(m, knobs, 1);
        for (std::size_t set = 0; set < block.query_sets().size(); ++set) {
          subject->run(set, Knobs::object(), 1);
          f(info, block.query_sets()[set].name, block.check(m, *subject, set, Knobs::object()));
        }
      } catch (const accel::InvalidInput&) {
        // What is not finite is refused.
      } catch (const Unsupported& e) {
        EXPECT_TRUE(info.name == "bsp_solid" && bounds_no_solid(dataset)) << info.name << ": " << e.what();
      }
  }
}

TEST(InsideTask, OursKeepTheirClaims) {
  const InsideTask task;
  auto blocks = task.hard_blocks();
  for (const BlockSpec& spec : task.blocks(Profile::smoke)) blocks.push_back(spec);
  for (const BlockSpec& spec : blocks) {
    SCOPED_TRACE(spec.label());
    const auto block = task.open(spec, smoke_context(spec.hard ? 1 : 7));
    each_of_ours(task, *block, spec.dataset,
                 [&](const MethodInfo& info, const std::string& set, const Errors& errors) {
                   EXPECT_TRUE(errors.within_claim) << info.name << " " << set << ": " << errors.reason;
                   if (info.claim == Claim::exact && spec.dataset.find('+') == std::string::npos) {
                     EXPECT_EQ(errors.error.value_or(0), 0) << info.name << " " << set;
                   }
                 });
  }
}

// What the damage does not touch stays right; what it does, shows.
TEST(InsideTask, DamageShowsWhereItShould) {
  const InsideTask task;
  const auto share = [&](const char* damage, const char* method) {
    const BlockSpec spec{std::string("icosphere+") + damage, 2'000};
    const auto block = task.open(spec, smoke_context());
    double worst = 0;
    each_of_ours(task, *block, spec.dataset,
                 [&](const MethodInfo& info, const std::string&, const Errors& errors) {
                   if (info.name == method) worst = std::max(worst, errors.error.value_or(0));
                 });
    return worst;
  };
  for (const char* harmless : {"unwelded", "degenerate_5"})
    for (const char* method :
         {"wide_first_hit", "wide_parity", "wide_pseudonormal", "bvh_pseudonormal", "winding_sum"})
      EXPECT_EQ(share(harmless, method), 0) << harmless << " " << method;
  EXPECT_EQ(share("flipped_10", "wide_parity"), 0);
  EXPECT_GT(share("flipped_10", "wide_first_hit"), 0.02);
  EXPECT_EQ(share("inside_out", "wide_parity"), 0);
  EXPECT_GT(share("inside_out", "wide_first_hit"), 0.3);  // all that are inside
  EXPECT_EQ(share("nested", "winding_sum"), 0);
  EXPECT_GT(share("nested", "wide_parity"), 0.02);
}

std::size_t method_called(const InsideTask& task, const std::string& name) {
  std::size_t m = 0;
  while (task.methods()[m].name != name) ++m;
  return m;
}

/// What a row says of the tree of a solid.
Knobs solid_facts(const InsideTask& task, Block& block, const std::string& method, const Knobs& knobs) {
  const std::size_t m = method_called(task, method);
  const auto subject = block.build(m, knobs, 1);
  subject->run(0, Knobs::object(), 1);
  return block.check(m, *subject, 0, Knobs::object()).extra;
}

// A cube of n² squares a side, each in two: 12 n² faces in six planes. Its tree by faces cuts nothing and is
// six planes deep, whatever plane comes first.
TEST(InsideTask, SolidsTellTheirFragmentsAndDepth) {
  const InsideTask task;
  const BlockSpec cube{"points_on_a_lattice", 0, true};
  const auto block = task.open(cube, smoke_context());
  for (const int candidates : {1, 16}) {
    const Knobs extra =
        solid_facts(task, *block, "bsp_solid", {{"axis_levels", 0}, {"candidates", candidates}});
    EXPECT_EQ(extra.at("inside_fragments"), 1.0);
    EXPECT_EQ(extra.at("inside_depth"), 6);
  }
  const auto rough = task.open({"icosphere", 2'000}, smoke_context());
  const auto fragments = [&](int candidates) {
    return solid_facts(task, *rough, "bsp_solid", {{"axis_levels", 0}, {"candidates", candidates}})
        .at("inside_fragments")
        .get<double>();
  };
  EXPECT_GT(fragments(16), 1.2);
  EXPECT_GT(fragments(1), 1.2 * fragments(16));
}

// With an epsilon in single precision more points near the surface end on the wrong side than an approximate
// method may have, whether it is too small or too large; without one, none does.
TEST(InsideTask, RoundedSolidsAreMeasurablyWrong) {
  const InsideTask task;
  const auto block = task.open({"icosphere", 5'000}, smoke_context());
  const auto share = [&](const std::string& method, const Knobs& knobs) {
    const std::size_t m = method_called(task, method);
    const auto subject = block->build(m, knobs, 1);
    subject->run(0, Knobs::object(), 1);
    EXPECT_EQ(block->query_sets()[0].name, "near");
    return block->check(m, *subject, 0, Knobs::object()).error.value_or(0);
  };
  EXPECT_EQ(share("bsp_solid", {{"axis_levels", 24}, {"candidates", 16}}), 0);
  for (const double epsilon : {1e-8, 1e-4})
    EXPECT_GT(share("bsp_solid_rounded", {{"epsilon", epsilon}}), 0.01) << epsilon;
}

void add_box(geometry::Mesh3f& mesh, const geometry::Vec3f& low, const geometry::Vec3f& high, bool turned) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({(i & 1 ? high : low)[0], (i & 2 ? high : low)[1], (i & 4 ? high : low)[2]});
  for (auto [a, b, c] : std::vector<std::array<std::uint32_t, 3>>{{0, 2, 3},
                                                                  {0, 3, 1},
                                                                  {4, 5, 7},
                                                                  {4, 7, 6},
                                                                  {0, 1, 5},
                                                                  {0, 5, 4},
                                                                  {2, 6, 7},
                                                                  {2, 7, 3},
                                                                  {0, 4, 6},
                                                                  {0, 6, 2},
                                                                  {1, 3, 7},
                                                                  {1, 7, 5}}) {
    if (turned) std::swap(b, c);
    mesh.faces.push_back({first + a, first + b, first + c});
  }
}
datasets::Dataset of_boxes(std::initializer_list<std::array<float, 7>> boxes) {
  datasets::Dataset d;
  d.kind = datasets::Kind::mesh, d.name = "boxes", d.closed = true;
  for (const auto& b : boxes) add_box(d.mesh, {b[0], b[1], b[2]}, {b[3], b[4], b[5]}, b[6] != 0);
  return d;
}

// A user's mesh whose faces lie in one another: the nearest face says nothing between them, and no method is
// held to a claim that it could not keep; those that go by rays keep it all the same.
TEST(InsideTask, BoxesThatTouchAreNobodysFault) {
  const InsideTask task;
  const auto block = task.open(of_boxes({{0, 0, 0, 1, 1, 1, 0}, {1, 0, 0, 2, 1, 1, 0}}), smoke_context());
  double worst_face_normal = 0;
  for (std::size_t m = 0; m < task.methods().size(); ++m) {
    const MethodInfo& info = task.methods()[m];
    if (info.source != Source::ours) continue;
    const auto subject = block->build(m, info.build_knobs.front(), 1);
    for (std::size_t set = 0; set < block->query_sets().size(); ++set) {
      subject->run(set, Knobs::object(), 1);
      const Errors errors = block->check(m, *subject, set, Knobs::object());
      EXPECT_TRUE(errors.within_claim) << info.name << ": " << errors.reason;
      if (info.claim == Claim::exact) {
        EXPECT_EQ(errors.error.value_or(0), 0) << info.name;
        EXPECT_FALSE(errors.extra.contains("inside_faces_meet")) << info.name;
      }
      if (info.name == "wide_face_normal")
        worst_face_normal = std::max(worst_face_normal, errors.error.value_or(0));
    }
  }
  EXPECT_GT(worst_face_normal, 0.01);
}

/// Says of every point what a rule makes of how many of two boxes it is in.
class ByCount final : public Index {
 public:
  using Rule = bool (*)(int boxes);
  explicit ByCount(Rule rule) : rule_(rule) {}
  void inside(std::span<const geometry::Vec3f> points, std::span<std::uint8_t> out, const Knobs&,
              int) const override {
    const auto within = [](const geometry::Vec3f& p, float low, float high) {
      bool in = true;
      for (int k = 0; k < 3; ++k) in = in && p[k] >= low && p[k] <= high;
      return in ? 1 : 0;
    };
    for (std::size_t i = 0; i < points.size(); ++i)
      out[i] = rule_(within(points[i], 0, 1) + within(points[i], 0.5f, 1.5f));
  }

 private:
  Rule rule_;
};

// Where boxes run through each other nobody says what is inside; everywhere else it is as clear as ever.
TEST(InsideTask, WhereFacesMeetClaimsHoldForAllThatIsClear) {
  const auto within_claim = [](ByCount::Rule rule, Claim claim, bool by_facing) {
    static ByCount::Rule current;
    current = rule;
    std::vector<Method> methods(1);
    methods[0].info.name = "by_count", methods[0].info.claim = claim;
    methods[0].build = [](const geometry::Mesh3f&, const Knobs&, int) -> std::unique_ptr<Index> {
      return std::make_unique<ByCount>(current);
    };
    methods[0].by_facing = by_facing;
    BlockInput input;
    input.mesh = of_boxes({{0, 0, 0, 1, 1, 1, 0}, {0.5f, 0.5f, 0.5f, 1.5f, 1.5f, 1.5f, 0}}).mesh;
    input.sets = make_point_sets(input.mesh, {400, 400}, true, 3);
    input.given = true;
    InsideBlock block(std::move(input), methods);
    const auto subject = block.build(0, Knobs::object(), 1);
    subject->run(1, Knobs::object(), 1);
    return block.check(0, *subject, 1, Knobs::object()).within_claim;
  };
  for (const Claim claim : {Claim::exact, Claim::bounded, Claim::approximate}) {
    EXPECT_TRUE(within_claim([](int n) { return n > 0; }, claim, false));
    EXPECT_TRUE(within_claim([](int n) { return n % 2 == 1; }, claim, false)) << "parity";
    EXPECT_FALSE(within_claim([](int) { return false; }, claim, false));
    EXPECT_FALSE(within_claim([](int) { return true; }, claim, false));
    EXPECT_TRUE(within_claim([](int) { return false; }, claim, true)) << "from inside it may meet the other";
    EXPECT_FALSE(within_claim([](int) { return true; }, claim, true));
  }
}

TEST(InsideTask, AsksInOrderToo) {
  const InsideTask task;
  const auto block = task.open({"icosphere", 1'000}, smoke_context());
  std::vector<std::string> names;
  for (const QuerySet& set : block->query_sets()) names.push_back(set.name);
  EXPECT_EQ(names, (std::vector<std::string>{"near", "near_sorted", "uniform", "uniform_sorted", "far",
                                             "centre", "on_vertex"}));
  const auto mesh = datasets::generate("icosphere", 1'000, 1).mesh;
  auto sets = make_point_sets(mesh, {2000, 2000}, false, 1);
  for (const std::size_t i : {0u, 2u}) {
    auto &given = sets[i].points, &sorted = sets[i + 1].points;
    const auto way = [](const std::vector<geometry::Vec3f>& points) {
      double sum = 0;
      for (std::size_t k = 1; k < points.size(); ++k) sum += length(points[k] - points[k - 1]);
      return sum;
    };
    EXPECT_LT(way(sorted), 0.2 * way(given));
    const auto less = [](const geometry::Vec3f& a, const geometry::Vec3f& b) {
      return std::tie(a[0], a[1], a[2]) < std::tie(b[0], b[1], b[2]);
    };
    std::ranges::sort(given, less), std::ranges::sort(sorted, less);
    EXPECT_EQ(given, sorted);
  }
}

TEST(InsideTask, RefusesWhatHasNoInside) {
  const InsideTask task;
  const auto refusal = [&](datasets::Dataset dataset) -> std::string {
    try {
      task.open(std::move(dataset), smoke_context());
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(refusal(datasets::generate("terrain", 1'000, 1)).find("'terrain' is not closed"),
            std::string::npos);
  EXPECT_NE(refusal(datasets::generate("uniform_cube", 1'000, 1)).find("is no mesh"), std::string::npos);
  datasets::Dataset turned = datasets::generate("icosphere", 1'000, 1);
  std::swap(turned.mesh.faces[5][0], turned.mesh.faces[5][1]);
  EXPECT_NE(refusal(turned).find("not oriented"), std::string::npos);
  turned.mesh.faces.clear();
  EXPECT_NE(refusal(turned).find("has no triangles"), std::string::npos);
  EXPECT_NE(refusal(datasets::generate("icosphere+inside_out", 1'000, 1)).find("is inside out"),
            std::string::npos);
  const std::array<float, 7> box{0, 0, 0, 1, 1, 1, 0}, apart{3, 0, 0, 3.5f, 1, 1, 1},
      within{0.25f, 0.25f, 0.25f, 0.75f, 0.75f, 0.75f, 0};
  EXPECT_NE(refusal(of_boxes({box, apart})).find("1 part that looks the wrong way, the first with face 12"),
            std::string::npos);
  EXPECT_NE(refusal(of_boxes({box, within})).find("the first with face 12"), std::string::npos);
  EXPECT_EQ(refusal(of_boxes({box})), "");
  const std::string command =
      std::string("'") + INSIDE_TEST_PROGRAM + "' --dataset terrain:1000 >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) != 0);
}

}  // namespace
}  // namespace treeline::bench::inside
