// Gaussian clusters of uneven size: the k-th holds a share proportional to 1/k (Zipf), and widths differ
// 50-fold.
#include <algorithm>
#include <array>

#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

geometry::Cloud3f clusters(const Job& job) {
  constexpr int count = 64;
  struct Cluster {
    Vec3d centre;
    double width;
    double share;  // of this cluster and all before it
  };
  std::array<Cluster, count> all;
  double total = 0;
  for (int k = 0; k < count; ++k) {
    Draws draws(~job.seed, static_cast<std::uint64_t>(k));
    all[k].centre = draws.in_box({0, 0, 0}, {1, 1, 1});
    all[k].width = 0.05 / draws.uniform(1, 50);
    all[k].share = total += 1.0 / (k + 1);
  }
  return job.cloud(job.n, [&](std::size_t i) {
    Draws draws(job.seed, i);
    const double u = draws.uniform() * total;
    const auto it = std::ranges::lower_bound(all, u, {}, &Cluster::share);
    const Cluster& c = it == all.end() ? all.back() : *it;
    return sum(c.centre, scaled(draws.normal(), c.width));
  });
}

}  // namespace treeline::datasets
