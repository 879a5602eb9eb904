#include "bench/knn_dynamic/life.hpp"

#include <algorithm>

#include "geometry/random.hpp"

namespace treeline::bench::knn_dynamic {

std::vector<bool> Life::there(std::size_t step_count, std::size_t pool) const {
  std::vector<bool> r(pool, false);
  for (std::size_t s = 0; s < step_count; ++s) {
    for (const Id id : gone_in(s)) r[id] = false;
    for (Id id = steps[s].first; id < steps[s].last; ++id) r[id] = true;
  }
  return r;
}

Life life_of(std::size_t pool, std::size_t batch, Goes goes, std::uint64_t seed) {
  geometry::Pcg32 random(seed, 8);  // a stream of its own, apart from those of recipes and queries
  const std::size_t most = pool - pool / 2;
  Life life;
  std::vector<Id> here;  // only where random ones go
  std::size_t count = 0;
  Id oldest = 0;
  for (std::size_t first = 0; first < pool; first += batch) {
    const std::size_t last = std::min(first + batch, pool);
    for (; count + (last - first) > most && count > 0; --count) {
      if (goes == Goes::oldest) {
        life.gone.push_back(oldest++);
        continue;
      }
      std::swap(here[random.below(static_cast<std::uint32_t>(here.size()))], here.back());
      life.gone.push_back(here.back());
      here.pop_back();
    }
    if (goes == Goes::random)
      for (std::size_t id = first; id < last; ++id) here.push_back(static_cast<Id>(id));
    count += last - first;
    life.steps.push_back({life.gone.size(), static_cast<Id>(first), static_cast<Id>(last)});
  }
  return life;
}

}  // namespace treeline::bench::knn_dynamic
