#include "bench/light_transport/truth.hpp"

#include <bit>

#include "bench/light_transport/judge.hpp"
#include "bench/light_transport/tracer.hpp"
#include "geometry/random.hpp"
#include "shading/transport/camera_rays.hpp"

namespace treeline::bench::light_transport {
namespace {

using geometry::Vec3d;

constexpr int formula_grid = 8;  // points along a side of a pixel

}  // namespace

Truth formula_truth(const LitScene& room, const RadianceForm& form) {
  const shading::transport::CameraRays rays(room.camera);
  const auto pixels =
      static_cast<std::size_t>(room.camera.width) * static_cast<std::size_t>(room.camera.height);
  Truth truth;
  for (std::size_t p = 0; p < pixels; ++p) {
    Vec3d sum{};
    for (int i = 0; i < formula_grid; ++i)
      for (int j = 0; j < formula_grid; ++j)
        sum += Vec3d(form(rays(p, (static_cast<float>(i) + 0.5f) / formula_grid,
                               (static_cast<float>(j) + 0.5f) / formula_grid)));
    truth.radiance.push_back(sum / double(formula_grid * formula_grid));
  }
  return truth;
}

Truth traced_truth(const LitScene& room, const TruthOptions& options, int threads) {
  Truth truth;
  std::unique_ptr<Tracer> tracer[2];
  std::vector<Film> film;
  for (std::size_t h = 0; h < 2; ++h) {
    tracer[h] = mis_tracer(room, geometry::hash_u64(options.seed, h), options.first);
    film.push_back(tracer[h]->film());
  }
  for (int from = 0, to = options.first; to <= options.most; from = to, to *= 2) {
    for (std::size_t h = 0; h < 2; ++h) tracer[h]->add(film[h], to - from, threads);
    truth.radiance.clear(), truth.samples = 2.0 * to;
    std::vector<Vec3d> off;
    for (std::size_t p = 0; p < film[0].size(); ++p) {
      truth.radiance.push_back(0.5 * (film[0].mean(p) + film[1].mean(p)));
      off.push_back(0.5 * (film[0].mean(p) - film[1].mean(p)));
    }
    truth.floor = relative_rms(off, truth.radiance);
    if (truth.floor < options.wanted) break;
  }
  return truth;
}

Truth wall_truth(const BoxOfWalls& box) {
  Truth truth;
  truth.walls = true;
  truth.bounces = box_radiosity(box.albedo, box.lamp_side, box.emission);
  for (const double x : truth.bounces.sum(truth.bounces.bounces.size()))
    truth.radiance.push_back(Vec3d::filled(x));
  truth.floor = truth.bounces.error;
  return truth;
}

std::uint64_t truth_hash(const TruthOptions& o) {
  std::uint64_t h = geometry::hash_u64(o.seed, std::uint64_t(o.first));
  h = geometry::hash_u64(h, std::uint64_t(o.most));
  return geometry::hash_u64(h, std::bit_cast<std::uint64_t>(o.wanted));
}

}  // namespace treeline::bench::light_transport
