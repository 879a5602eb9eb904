// The closest point of our hierarchies, and on which side of it the query lies: by angle-weighted normals of
// faces, edges and corners; and, to show what these are for, by the plane of the face found alone.
#include "accel/signed_distance/pseudonormal.hpp"

#include "accel/bvh/triangles.hpp"
#include "bench/inside/sign_index.hpp"

namespace treeline::bench::inside {
namespace {

using Binary = accel::Bvh<accel::Triangles<float>>;

class FaceNormal final : public Index {
 public:
  FaceNormal(const geometry::Mesh3f& mesh, int threads)
      : mesh_(mesh), tree_(mesh, tree_options<WideTree>(threads)) {}

  void inside(std::span<const geometry::Vec3f> points, std::span<std::uint8_t> out, const Knobs&,
              int threads) const override {
    std::vector<accel::ClosestPoint<float>> closest(points.size());
    tree_.closest_point(points, std::numeric_limits<float>::infinity(), closest, threads);
    for (std::size_t i = 0; i < points.size(); ++i) {
      out[i] = 0;
      if (!closest[i]) continue;
      const auto t = mesh_.triangle(closest[i].primitive);
      out[i] = geometry::orientation(t.a, t.b, t.c, points[i]) <= 0;
    }
  }

 private:
  geometry::Mesh3f mesh_;
  WideTree tree_;
};

/// Approximate, as the closest point is: where two parts of the surface are as far to the last digits, the
/// one found need not be the nearest.
template <class Tree>
bool add_pseudonormal(const char* name, int ladder) {
  return Registry<Method>::instance().add(
      {.info = {.name = name, .family = "bvh", .claim = Claim::approximate, .ladder = ladder},
       .build = [](const geometry::Mesh3f& mesh, const Knobs&,
                   int threads) { return build_sign<Tree, accel::Pseudonormal>(mesh, {}, threads); },
       .by_nearest_face = true});
}
[[maybe_unused]] const bool wide = add_pseudonormal<WideTree>("wide_pseudonormal", 40);
[[maybe_unused]] const bool binary = add_pseudonormal<Binary>("bvh_pseudonormal", 41);
// To be seen failing, so not held to hard cases.
[[maybe_unused]] const bool face = Registry<Method>::instance().add(
    {.info = {.name = "wide_face_normal",
              .family = "bvh",
              .claim = Claim::approximate,
              .stress_builds = {},
              .ladder = 10,
              .scales = false},
     .build = [](const geometry::Mesh3f& mesh, const Knobs&, int threads) -> std::unique_ptr<Index> {
       return std::make_unique<FaceNormal>(mesh, threads);
     },
     .by_nearest_face = true,
     .promises_nothing = true});

}  // namespace
}  // namespace treeline::bench::inside
