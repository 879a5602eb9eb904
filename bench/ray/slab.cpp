// No tree, one box: the slab test alone, for meshes that are a box. Methods slab_textbook, slab_padded.
//
// slab_textbook is the sentence that courses repeat, taken literally in single precision: a ray misses a box
// if t_enter ≥ t_exit or t_exit < 0 (Kay and Kajiya 1986). slab_padded is the test that our trees use
// (geometry/intersect_box.hpp). They answer any-hit queries of the hard cases of the family box_rays, and
// refuse every other mesh. A box has no triangles to name, so there is no closest hit.
#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/ray/method.hpp"
#include "geometry/intersect_box.hpp"

namespace treeline::bench::ray {
namespace {

using geometry::Box3f;
using geometry::Rayf;

struct Textbook {
  static bool meets(const Box3f& box, const Rayf& ray) {
    float enter = -std::numeric_limits<float>::infinity(), exit = -enter;
    for (int axis = 0; axis < 3; ++axis) {
      const float a = (box.low[axis] - ray.origin[axis]) / ray.direction[axis];
      const float b = (box.high[axis] - ray.origin[axis]) / ray.direction[axis];
      enter = std::max(enter, std::min(a, b)), exit = std::min(exit, std::max(a, b));
    }
    return !(enter >= exit || exit < 0);
  }
};

struct Padded {
  static bool meets(const Box3f& box, const Rayf& ray) {
    float enter, exit;
    return geometry::BoxTest<float>(ray)(box, ray.t_min, ray.t_max, enter, exit);
  }
};

template <class Test>
class Slab final : public Index {
 public:
  explicit Slab(const geometry::Mesh3f& mesh) : box_(mesh.box()) {
    bool is_box = mesh.size() == 12 && mesh.vertices.size() == 8;
    for (const auto& v : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis)
        is_box = is_box && (v[axis] == box_.low[axis] || v[axis] == box_.high[axis]);
    if (!is_box) throw Unsupported("answers for a box alone");
  }
  void closest(std::span<const Rayf>, std::span<RayAnswer>, const Knobs&, int) const override {
    throw Unsupported("a box has no triangles to name");
  }
  void any(std::span<const Rayf> rays, std::span<std::uint8_t> out, const Knobs&,
           int threads) const override {
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) out[i] = Test::meets(box_, rays[i]);
    });
  }

 private:
  Box3f box_;
};

template <class Test>
bool register_slab(const char* name, Claim claim) {
  return Registry<Method>::instance().add(
      {.info = {.name = name, .family = "box", .claim = claim, .ladder = 1, .hard_cases_only = true},
       .build = [](const geometry::Mesh3f& mesh, const Knobs&, int) -> std::unique_ptr<Index> {
         return std::make_unique<Slab<Test>>(mesh);
       }});
}

const bool registered = register_slab<Textbook>("slab_textbook", Claim::approximate) &&
                        register_slab<Padded>("slab_padded", Claim::bounded);

}  // namespace
}  // namespace treeline::bench::ray
