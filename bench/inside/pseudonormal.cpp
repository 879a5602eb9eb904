// Our binary hierarchy's closest point, and on which side of it the query lies: by angle-weighted normals of
// faces, edges and corners; and, to show what these are for, by the plane of the face found alone.
#include "accel/signed_distance/pseudonormal.hpp"

#include "accel/bvh/triangles.hpp"
#include "bench/inside/sign_index.hpp"

namespace treeline::bench::inside {
namespace {

using Tree = accel::Bvh<accel::Triangles<float>>;

class FaceNormal final : public Index {
 public:
  FaceNormal(const geometry::Mesh3f& mesh, int threads)
      : mesh_(mesh), tree_(mesh, tree_options<Tree>(threads)) {}

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
  Tree tree_;
};

// The exact answer to a closest point of float: a part of the surface that is not nearest may be found.
[[maybe_unused]] const bool weighted = Registry<Method>::instance().add(
    {.info = {.name = "bvh_pseudonormal", .family = "bvh", .claim = Claim::approximate, .ladder = 40},
     .build = [](const geometry::Mesh3f& mesh, const Knobs&,
                 int threads) { return build_sign<Tree, accel::Pseudonormal>(mesh, {}, threads); },
     .by_nearest_face = true});
// To be seen failing, so not held to hard cases.
[[maybe_unused]] const bool face = Registry<Method>::instance().add(
    {.info = {.name = "bvh_face_normal",
              .family = "bvh",
              .claim = Claim::approximate,
              .stress_builds = {},
              .ladder = 10,
              .scales = false},
     .build = [](const geometry::Mesh3f& mesh, const Knobs&, int threads) -> std::unique_ptr<Index> {
       return std::make_unique<FaceNormal>(mesh, threads);
     },
     .by_nearest_face = true});

}  // namespace
}  // namespace treeline::bench::inside
