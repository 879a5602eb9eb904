// One mesh with its ray sets and their truth: what all methods of the task are asked, and how they are
// judged.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/core/mesh_block.hpp"
#include "bench/ray/judge.hpp"
#include "bench/ray/method.hpp"
#include "bench/ray/queries.hpp"

namespace treeline::bench::ray {

struct BlockInput : MeshInput {
  std::vector<geometry::Mesh3f> moved;  // frames 1, 2, …: the same faces with other vertices
  std::vector<RaySet> sets;
  bool closed = false;            // a ray that passes through a surface is a leak
  bool from_inside = false;       // closed, and every ray starts inside: each that meets nothing is a leak
  std::size_t judged = SIZE_MAX;  // at most so many rays a set are judged, evenly spread
};

class RayBlock final : public MeshBlock<BlockInput, Method> {
 public:
  RayBlock(BlockInput input, const std::vector<Method>& methods);

  std::unique_ptr<Subject> build(std::size_t m, const Knobs& build_knobs, int threads) override;
  Errors check(std::size_t m, const Subject& subject, std::size_t query_set,
               const Knobs& query_knobs) override;
  std::size_t n() const override { return frames_.front().size(); }
  /// Finds the truth of all sets now, for many who will need it.
  void find_truth();

 private:
  struct Truth {
    std::vector<std::size_t> rays;  // numbers of those judged
    std::vector<TrueHit> hits;
  };
  const Truth& truth_of(std::size_t query_set);

  std::vector<geometry::Mesh3f> frames_;  // the mesh, and what it moves to; the input has neither any more
  std::vector<std::optional<Truth>> truths_;
  std::vector<Judge> float_judges_, double_judges_;  // one a truth
};

}  // namespace treeline::bench::ray
