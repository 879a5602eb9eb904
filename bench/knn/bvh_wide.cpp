// Our wide bounding volume hierarchy, three ways: exact; with distances bounded by epsilon; stopped after a
// number of leaves. And over clouds that need doubles: as doubles, or rounded.
#include "accel/bvh/wide_points.hpp"

#include "bench/knn/rounded.hpp"
#include "bench/knn/tree_index.hpp"

namespace treeline::bench::knn {
namespace {

template <bool drawn, class T = float>
std::unique_ptr<IndexOf<T>> build(const InputOf<T>& input, const Knobs& knobs) {
  using Tree = accel::Bvh<accel::Points<T, 3>, accel::Wide>;
  typename Tree::Options options;
  options.threads = input.threads;
  if (knobs.contains("split") && knobs.at("split") == "perimeter")
    options.split = Tree::Options::Split::perimeter;
  return build_tree<Tree>(input, options, knobs, drawn);
}

const std::vector<Knobs> both_splits{{{"split", "rank"}}, {{"split", "perimeter"}}};

bool add(const char* name, Claim claim, int ladder, std::vector<Knobs> query_knobs) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "bvh",
                .claim = claim,
                .build_knobs = claim == Claim::exact ? both_splits : std::vector<Knobs>{both_splits[1]},
                .query_knobs = std::move(query_knobs),
                .ladder = ladder,
                .scales = claim == Claim::exact},
       .build = claim == Claim::exact ? build<true> : build<false>});
}

[[maybe_unused]] const bool registered =
    add("bvh_wide", Claim::exact, 12, {{{"batch", true}}, {{"batch", false}}}) &&
    add("bvh_wide_epsilon", Claim::bounded, 9, {{{"epsilon", 0.5}}, {{"epsilon", 2.0}}}) &&
    add("bvh_wide_leaves", Claim::approximate, 8, {{{"leaves", 1}}, {{"leaves", 4}}, {{"leaves", 16}}});

[[maybe_unused]] const bool registered_double =
    Registry<Method>::instance().add({.info = {.name = "bvh_wide_double",
                                               .family = "bvh",
                                               .build_knobs = both_splits,
                                               .query_knobs = {{{"batch", true}}, {{"batch", false}}},
                                               .ladder = 22,
                                               .scales = false},
                                      .build_double = build<false, double>}) &&
    Registry<Method>::instance().add({.info = {.name = "bvh_wide_rounded",
                                               .family = "bvh",
                                               .claim = Claim::approximate,
                                               .build_knobs = with_origins({both_splits[1]}),
                                               .query_knobs = {{{"batch", true}}, {{"batch", false}}},
                                               .ladder = 13,
                                               .scales = false},
                                      .build_double = [](const InputOf<double>& input, const Knobs& knobs)
                                          -> std::unique_ptr<IndexOf<double>> {
                                        return std::make_unique<Rounded>(input, build<false, float>, knobs);
                                      },
                                      .rounds_points = true});

}  // namespace
}  // namespace treeline::bench::knn
