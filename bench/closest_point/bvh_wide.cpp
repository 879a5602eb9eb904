// Our wide bounding volume hierarchy. Methods bvh_wide, whose answers are those of double, and
// bvh_wide_exact, which decides exactly which triangle is nearest and how far; the point on a sliver is as
// double finds it. The knob order: batches as they are given, or along a curve through space, a few
// neighbours together.
#include "accel/bvh/wide_triangles.hpp"

#include "bench/closest_point/tree_index.hpp"

namespace treeline::bench::closest_point {
namespace {

using Tree = accel::Bvh<accel::Triangles<float>, accel::Wide>;

template <bool exact>
class WideIndex final : public TreeIndex<Tree> {
 public:
  using TreeIndex<Tree>::TreeIndex;

  void closest(const Queries& queries, Answers& out, const Knobs& knobs, int threads) const override {
    const auto order =
        knobs.value("order", "curve") == "given" ? accel::QueryOrder::given : accel::QueryOrder::curve;
    tree().closest_point<double>(queries.floats, {.exact = exact}, out.fill<double>(queries.size()), threads,
                                 order);
  }
};

template <bool exact>
std::unique_ptr<Index> build(const geometry::Mesh3f& mesh, const Knobs&, int threads) {
  return std::make_unique<WideIndex<exact>>(
      Tree(mesh, {.non_finite = accel::NonFinite::drop, .threads = threads}));
}

bool add(const char* name, Claim claim, int ladder, auto build) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "bvh",
                .claim = claim,
                .query_knobs = {Knobs{{"order", "curve"}}, Knobs{{"order", "given"}}},
                .ladder = ladder},
       .build = build});
}

const bool registered =
    add("bvh_wide", Claim::bounded, 15, build<false>) && add("bvh_wide_exact", Claim::exact, 16, build<true>);

}  // namespace
}  // namespace treeline::bench::closest_point
