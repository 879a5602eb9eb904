// One mesh with its ray sets and their truth: what all methods of the task are asked, and how they are
// judged.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/core/task.hpp"
#include "bench/ray/judge.hpp"
#include "bench/ray/method.hpp"
#include "bench/ray/queries.hpp"

namespace treeline::bench::ray {

struct BlockInput {
  geometry::Mesh3f mesh;
  std::vector<RaySet> sets;
  std::uint64_t seed = 0, dataset_hash = 0;
  bool from_inside = false;       // closed, and every ray starts inside: a miss is a leak
  std::size_t judged = SIZE_MAX;  // at most so many rays a set are judged, evenly spread
  int threads = 1;                // for the truth; 1 starts no thread pool
  std::string truth_cache;
  int version = 0;
};

class RayBlock final : public Block {
 public:
  RayBlock(BlockInput input, const std::vector<Method>& methods);

  const std::vector<QuerySet>& query_sets() const override { return query_sets_; }
  std::unique_ptr<Subject> build(std::size_t m, const Knobs& build_knobs, int threads) override;
  Errors check(std::size_t m, const Subject& subject, std::size_t query_set,
               const Knobs& query_knobs) override;
  std::size_t n() const override { return input_.mesh.size(); }
  std::uint64_t seed() const override { return input_.seed; }
  std::uint64_t dataset_hash() const override { return input_.dataset_hash; }

 private:
  struct Truth {
    std::vector<std::size_t> rays;  // numbers of those judged
    std::vector<TrueHit> hits;
  };
  const Truth& truth_of(std::size_t query_set);

  BlockInput input_;
  const std::vector<Method>& methods_;
  std::vector<QuerySet> query_sets_;
  std::vector<std::optional<Truth>> truths_;
  std::vector<Judge> float_judges_, double_judges_;  // one a truth
};

}  // namespace treeline::bench::ray
