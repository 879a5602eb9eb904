// Our BSP trees of meshes as solids: exact planes, by how they choose what to cut with; and planes in
// floating point with an epsilon, to be seen failing.
//
// What the exact tree is exact about is the mesh with its corners moved to whole numbers, by 2^-26 of the
// extent at most, hence bounded. It does not take meshes that are not closed and oriented, are inside out,
// run through themselves or have parts in one another that face the same way.
#include "accel/bsp_solid.hpp"

#include <optional>

#include "accel/signed_distance/each_query.hpp"
#include "bench/core/registry.hpp"
#include "bench/inside/method.hpp"

namespace treeline::bench::inside {
namespace {

using accel::SolidOptions;

template <class Space>
class SolidIndex final : public Index {
 public:
  using Tree = accel::BspTree<accel::Solid<Space>>;

  SolidIndex(const geometry::Mesh3f& mesh, const SolidOptions& options) {
    if (!mesh.faces.empty()) try {
        tree_.emplace(mesh, options);
      } catch (const accel::NotASolid& e) {
        throw Unsupported(e.what());
      }
  }

  void inside(std::span<const geometry::Vec3f> points, std::span<std::uint8_t> out, const Knobs&,
              int threads) const override {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!geometry::is_finite(points[i]))
        throw accel::InvalidInput("query " + std::to_string(i) + " has a coordinate that is not finite");
    if (!tree_) return std::fill(out.begin(), out.end(), std::uint8_t{0});  // nothing has no inside
    accel::each_query(points, threads,
                      [&](std::size_t i) { out[i] = tree_->contains(geometry::Vec3d(points[i])); });
  }

  Knobs facts() const override {
    if (!tree_) return Knobs::object();
    const auto& s = tree_->stats();
    return {{"inside_fragments", static_cast<double>(s.fragments) / static_cast<double>(s.faces)},
            {"inside_depth", s.depth}};
  }

 private:
  std::optional<Tree> tree_;
};

template <class Space>
std::unique_ptr<Index> build(const geometry::Mesh3f& mesh, const SolidOptions& options) {
  return std::make_unique<SolidIndex<Space>>(mesh, options);
}

SolidOptions options_of(const Knobs& knobs) {
  SolidOptions options;
  options.axis_levels = knobs.at("axis_levels").get<int>();
  options.candidates = knobs.at("candidates").get<int>();
  return options;
}

// Axis medians, then the best of 16 faces; the best of 16 faces; the first face, whose trees grow fastest.
[[maybe_unused]] const bool exact =
    Registry<Method>::instance().add({.info = {.name = "bsp_solid",
                                               .family = "bsp",
                                               .claim = Claim::bounded,
                                               .build_knobs = {Knobs{{"axis_levels", 24}, {"candidates", 16}},
                                                               Knobs{{"axis_levels", 0}, {"candidates", 16}},
                                                               Knobs{{"axis_levels", 0}, {"candidates", 1}}},
                                               .stress_builds = {0, 1, 2},
                                               .ladder = 65,
                                               .sweep_up_to_n = 20'000,
                                               .largest_n = 200'000,
                                               .scales = false},
                                      .build = [](const geometry::Mesh3f& mesh, const Knobs& knobs, int) {
                                        return build<accel::solid::ExactSpace>(mesh, options_of(knobs));
                                      }});

// Measured near the surface of 10 000 faces: of 2048 answers 75 wrong at 1e-8, none at 1e-6, 45 at 1e-4.
[[maybe_unused]] const bool rounded = Registry<Method>::instance().add(
    {.info = {.name = "bsp_solid_rounded",
              .family = "bsp",
              .claim = Claim::approximate,
              .build_knobs = {Knobs{{"epsilon", 1e-8}}, Knobs{{"epsilon", 1e-6}}, Knobs{{"epsilon", 1e-4}}},
              .stress_builds = {},
              .ladder = 15,
              .quick_builds = 2,
              .largest_n = 200'000,
              .quick_largest_n = 20'000,
              .scales = false},
     .build =
         [](const geometry::Mesh3f& mesh, const Knobs& knobs, int) {
           SolidOptions options;
           options.epsilon = knobs.at("epsilon").get<double>();
           return build<accel::solid::RoundedSpace<float>>(mesh, options);
         },
     .promises_nothing = true});

}  // namespace
}  // namespace treeline::bench::inside
