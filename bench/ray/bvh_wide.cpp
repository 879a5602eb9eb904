// Our wide bounding volume hierarchy, watertight and exact. (A variant that is only fast would not be
// faster.) The knob batch: streams, several rays in flight, or singly, one after the other.
#include "accel/bvh/wide_triangles.hpp"

#include "bench/ray/tree_index.hpp"

namespace treeline::bench::ray {
namespace {

template <class Tree>
class WideIndex final : public Index {
 public:
  explicit WideIndex(Tree tree) : tree_(std::move(tree)) {}

  void closest(std::span<const geometry::Rayf> rays, std::span<RayAnswer> out, const Knobs& knobs,
               int threads) const override {
    tree_.closest_hit(rays, out, threads, batch(knobs));
  }
  void any(std::span<const geometry::Rayf> rays, std::span<std::uint8_t> out, const Knobs& knobs,
           int threads) const override {
    tree_.any_hit(rays, out, threads, batch(knobs));
  }
  std::optional<std::pair<double, double>> work(std::span<const geometry::Rayf> rays,
                                                bool any) const override {
    return work_of(tree_, rays, any);
  }
  std::vector<accel::SliceCell> slice(int axis, double offset) const override {
    return tree_.slice(axis, offset);
  }

 private:
  static accel::RayBatch batch(const Knobs& knobs) {
    if (!knobs.contains("batch")) return accel::RayBatch::automatic;
    return knobs.at("batch") == "singly" ? accel::RayBatch::singly : accel::RayBatch::streams;
  }

  Tree tree_;
};

template <class Policy>
std::unique_ptr<Index> build(const geometry::Mesh3f& mesh, const Knobs&, int threads) {
  using Tree = accel::Bvh<accel::Triangles<float, Policy>, accel::Wide>;
  return std::make_unique<WideIndex<Tree>>(
      Tree(mesh, {.non_finite = accel::NonFinite::drop, .threads = threads}));
}

template <class Policy>
bool add(const char* name, Claim claim, int ladder) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "bvh",
                .claim = claim,
                .query_knobs = {{{"batch", "streams"}}, {{"batch", "singly"}}},
                .ladder = ladder},
       .build = build<Policy>});
}

[[maybe_unused]] const bool registered = add<geometry::Watertight>("bvh_wide", Claim::bounded, 11) &&
                                         add<geometry::Exact>("bvh_wide_exact", Claim::exact, 12);

}  // namespace
}  // namespace treeline::bench::ray
