// Our sampled fields as methods: samples of either kind, look-ups of either kind.
#pragma once

#include <cmath>

#include "accel/batch.hpp"
#include "accel/bvh/triangles.hpp"
#include "accel/bvh/wide_triangles.hpp"
#include "accel/distance_field.hpp"
#include "bench/core/registry.hpp"
#include "bench/distance_field/method.hpp"

namespace treeline::bench::distance_field {

/// The wide tree where it answers closest points.
using WideTree = accel::Bvh<accel::Triangles<float>, accel::Wide>;
using Tree =
    std::conditional_t<accel::ClosestPointIndex<WideTree>, WideTree, accel::Bvh<accel::Triangles<float>>>;

inline Tree tree_of(const Input& input) {
  Tree::Options options;
  if constexpr (requires { options.threads; }) options.threads = input.threads;
  return Tree(input.mesh, options);
}
inline accel::field::FieldOptions options_of(const Input& input, accel::field::Support support) {
  accel::field::FieldOptions options;
  options.spacing = input.spacing, options.band = input.band, options.threads = input.threads;
  options.support = support;
  return options;
}

template <class Samples, template <class> class LookUp>
class Sampled final : public Field {
 public:
  /// Of the look-up: how far its samples reach.
  static constexpr auto support = std::is_same_v<LookUp<Samples>, accel::field::Tricubic<Samples>>
                                      ? accel::field::Support::tricubic
                                      : accel::field::Support::trilinear;

  explicit Sampled(Samples samples) : samples_(std::move(samples)), look_up_(samples_) {}

  void distances(std::span<const geometry::Vec3f> points, const Knobs&, int threads,
                 std::span<float> out) const override {
    accel::parallel_ranges(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        out[i] = static_cast<float>(look_up_.distance(geometry::Vec3d(points[i])));
    });
  }
  void trace(std::span<const geometry::Rayf> rays, const Knobs&, int threads,
             std::span<TraceAnswer> out) const override {
    accel::field::TraceOptions options;
    options.tolerance = hit_tolerance * samples_.lattice().spacing;
    accel::parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const geometry::Rayf& r = rays[i];
        const auto found = sphere_trace(
            look_up_, {geometry::Vec3d(r.origin), geometry::Vec3d(r.direction), r.t_min, r.t_max}, options);
        out[i] = {};
        out[i].steps = static_cast<std::uint32_t>(found.steps), out[i].doubtful = found.doubtful;
        out[i].exhausted = found.status == accel::field::TraceStatus::exhausted;
        if (found.status == accel::field::TraceStatus::hit) out[i].t = static_cast<float>(found.t);
      }
    });
  }
  std::optional<accel::field::FieldSample> certain(const geometry::Vec3d& p, const Knobs&) const override {
    if (!samples_.report().certain()) return std::nullopt;
    return look_up_.sample(p);
  }
  std::vector<Sample> samples(std::size_t most) const override {
    const auto& l = samples_.lattice();
    const double band = samples_.widths().band;
    const std::size_t stride = stride_for(samples_.report().known_samples, most);
    std::vector<Sample> r;
    std::size_t seen = 0;
    for (int z = 0; z < l.bricks[2]; ++z)
      for (int y = 0; y < l.bricks[1]; ++y)
        for (int x = 0; x < l.bricks[0]; ++x) {
          if (!samples_.entry(x, y, z).kept()) continue;
          for (int n = 0; n < accel::field::brick_size; ++n) {
            const int i = 8 * x + n % 8, j = 8 * y + n / 8 % 8, k = 8 * z + n / 64;
            const double d = samples_.value(i, j, k);
            if (std::abs(d) <= band && seen++ % stride == 0) r.push_back({l.position(i, j, k), d});
          }
        }
    return r;
  }
  Knobs facts() const override {
    const auto& report = samples_.report();
    double bound = 0;
    for (const auto& e : samples_.table())
      if (e.kept()) bound += double(cubic ? e.cubic_bound : e.bound);
    const auto bricks = static_cast<double>(std::max<std::size_t>(report.kept_bricks, 1));
    return {{"distance_field_told_closed", report.closed},
            {"distance_field_told_inside_out", report.inside_out},
            {"distance_field_sign_conflicts", report.sign_conflicts},
            {"distance_field_undecided_signs", report.undecided_signs},
            {"distance_field_known_samples", report.known_samples},
            {"distance_field_bound_cells", bound / bricks / samples_.lattice().spacing}};
  }

 private:
  static constexpr bool cubic = support == accel::field::Support::tricubic;

  Samples samples_;
  LookUp<Samples> look_up_;
};

template <class Samples, template <class> class LookUp>
bool register_sampled(const char* name, int ladder) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "field",
                .claim = Claim::bounded,
                .build_knobs = resolutions(),
                .stress_builds = {2},
                .ladder = ladder,
                .quick_builds = 3},
       .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Field> {
         const Tree tree = tree_of(input);
         return std::make_unique<Sampled<Samples, LookUp>>(accel::field::sample_mesh<Samples>(
             input.mesh, tree, options_of(input, Sampled<Samples, LookUp>::support)));
       }});
}

}  // namespace treeline::bench::distance_field
