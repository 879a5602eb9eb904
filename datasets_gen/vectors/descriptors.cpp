// Rows like feature descriptors: many columns, few degrees of freedom. 64 Gaussian clusters in 8 latent
// dimensions, of uneven size (the k-th holds a share proportional to 1/k) and width, are mapped linearly and,
// to a third, by sines, so that they lie on bent sheets; every column gets noise of its own.
#include <algorithm>
#include <array>

#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {
namespace {

constexpr std::size_t latent = 8, count = 64;
using Latent = std::array<double, latent>;

Latent normal_latent(Draws& draws) {
  Latent z;
  for (std::size_t l = 0; l < latent; l += 3) {
    const Vec3d three = draws.normal();
    for (std::size_t j = 0; j < 3 && l + j < latent; ++j) z[l + j] = three[static_cast<int>(j)];
  }
  return z;
}

struct Cluster {
  Latent centre;
  double width;
  double share;  // of this cluster and all before it
};

/// What a column reads from the latent position.
struct Column {
  Latent straight, bent;
  double phase;  // in turns
};

}  // namespace

Vectors descriptors(const Job& job, std::size_t columns) {
  std::array<Cluster, count> clusters;
  double total = 0;
  for (std::size_t k = 0; k < count; ++k) {
    Draws draws(~job.seed, k);
    clusters[k] = {normal_latent(draws), draws.uniform(0.15, 0.5), 0};
    clusters[k].share = total += 1 / static_cast<double>(k + 1);
  }
  std::vector<Column> map(columns);
  for (std::size_t a = 0; a < columns; ++a) {
    Draws draws(~job.seed, count + a);
    map[a] = {normal_latent(draws), normal_latent(draws), draws.uniform()};
  }
  return job.vectors(columns, [&](std::size_t i, std::span<float> row) {
    Draws draws(job.seed, i);
    const double u = draws.uniform() * total;
    const auto it = std::ranges::lower_bound(clusters, u, {}, &Cluster::share);
    const Cluster& cluster = it == clusters.end() ? clusters.back() : *it;
    Latent z = normal_latent(draws);
    for (std::size_t l = 0; l < latent; ++l) z[l] = cluster.centre[l] + cluster.width * z[l];
    for (std::size_t a = 0; a < row.size(); ++a) {
      double straight = 0, bent = 0;
      for (std::size_t l = 0; l < latent; ++l)
        straight += map[a].straight[l] * z[l], bent += map[a].bent[l] * z[l];
      const double wave = sincos_turns(map[a].phase + bent / 16).sin;
      row[a] = static_cast<float>(0.35 * straight + 0.3 * wave + draws.uniform(-0.08, 0.08));
    }
  });
}

}  // namespace treeline::datasets
