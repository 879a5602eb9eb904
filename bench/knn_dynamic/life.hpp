// The life of a cloud: in which batches its points come and go, and what is asked in between.
//
// Of a pool of 2n points all come, in the pool's order; from the n-th on as many go as come, so that n are
// there. Which go is the oldest, as with a scanner that moves on, or random ones, as when one edits.
#pragma once

#include <string>
#include <vector>

#include "bench/knn_dynamic/method.hpp"

namespace treeline::bench::knn_dynamic {

struct Life {
  struct Step {
    std::size_t gone_end = 0;  // in `gone`; begins where the step before ends
    Id first = 0, last = 0;    // of the pool
  };
  std::vector<Id> gone;
  std::vector<Step> steps;

  std::span<const Id> gone_in(std::size_t step) const {
    const std::size_t begin = step == 0 ? 0 : steps[step - 1].gone_end;
    return {gone.data() + begin, steps[step].gone_end - begin};
  }
  /// Points that come and points that go.
  std::size_t changes() const { return gone.size() + (steps.empty() ? 0 : steps.back().last); }
  /// Which points of the pool are there after so many steps.
  std::vector<bool> there(std::size_t step_count, std::size_t pool) const;
};

enum class Goes { oldest, random };

/// Batches of `batch` points; the last may be smaller. Equal arguments give equal lives.
Life life_of(std::size_t pool, std::size_t batch, Goes, std::uint64_t seed);

}  // namespace treeline::bench::knn_dynamic
