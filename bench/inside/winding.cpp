// Our winding numbers: groups of faces from afar, and the exact sum over all faces.
#include "accel/signed_distance/winding.hpp"

#include "bench/inside/sign_index.hpp"

namespace treeline::bench::inside {
namespace {

/// The sums need no other tree.
class WindingIndex final : public Index {
 public:
  WindingIndex(const geometry::Mesh3f& mesh, double reach, int threads) : winding_(mesh, reach, threads) {}

  void inside(std::span<const geometry::Vec3f> points, std::span<std::uint8_t> out, const Knobs&,
              int threads) const override {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!geometry::is_finite(points[i]))
        throw accel::InvalidInput("query " + std::to_string(i) + " has a coordinate that is not finite");
    accel::each_query(points, threads, [&](std::size_t i) {
      const accel::WindingNumber w = winding_(points[i]);
      out[i] = w.on_surface || w.value > 0.5;
    });
  }

 private:
  accel::WindingTree<float> winding_;
};

std::unique_ptr<Index> build_near(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  return std::make_unique<WindingIndex>(mesh, knobs.at("reach").get<double>(), threads);
}
std::unique_ptr<Index> build_exact(const geometry::Mesh3f& mesh, const Knobs&, int threads) {
  return std::make_unique<WindingIndex>(mesh, std::numeric_limits<double>::infinity(), threads);
}

[[maybe_unused]] const bool near = Registry<Method>::instance().add(
    {.info = {.name = "winding",
              .family = "bvh",
              .claim = Claim::approximate,
              .build_knobs = {Knobs{{"reach", 2.0}}, Knobs{{"reach", 1.3}}, Knobs{{"reach", 4.0}}},
              .ladder = 50,
              .quick_builds = 2},
     .build = build_near});
[[maybe_unused]] const bool exact = Registry<Method>::instance().add({.info = {.name = "winding_sum",
                                                                               .family = "brute",
                                                                               .claim = Claim::bounded,
                                                                               .ladder = 60,
                                                                               .largest_n = 20'000,
                                                                               .quick_largest_n = 6'000,
                                                                               .scales = false},
                                                                      .build = build_exact});

}  // namespace
}  // namespace treeline::bench::inside
