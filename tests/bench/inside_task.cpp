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
  const std::string command =
      std::string("'") + INSIDE_TEST_PROGRAM + "' --dataset terrain:1000 >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) != 0);
}

}  // namespace
}  // namespace treeline::bench::inside
