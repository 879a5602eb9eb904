// One mesh with its points and their truth: what all methods of the task are asked, and how they are judged.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/core/mesh_block.hpp"
#include "bench/inside/judge.hpp"
#include "bench/inside/method.hpp"
#include "bench/inside/queries.hpp"

namespace treeline::bench::inside {

struct BlockInput : MeshInput {
  std::optional<geometry::Mesh3f> whole;  // what a damaged mesh was: the truth is about that
  std::vector<PointSet> sets;
  bool must_answer = false;  // a refusal is a wrong answer
  bool coincident = false;   // some faces lie in one another
  bool given = false;        // a user's mesh: nobody knows whether its faces meet beside their edges
};

class InsideBlock final : public MeshBlock<BlockInput, Method> {
 public:
  InsideBlock(BlockInput input, const std::vector<Method>& methods);

  std::unique_ptr<Subject> build(std::size_t m, const Knobs& build_knobs, int threads) override;
  Errors check(std::size_t m, const Subject& subject, std::size_t query_set,
               const Knobs& query_knobs) override;
  std::size_t n() const override { return input_.mesh.size(); }
  /// Finds the truth of all sets now, for many who will need it.
  void find_truth();

 private:
  const std::vector<Side>& truth_of(std::size_t query_set);
  /// Whether two faces are one, touch beside their edges, or run through each other, be it along edges.
  bool faces_meet();
  /// What a method can be held to where faces meet; empty: nothing.
  std::vector<std::uint8_t> held(const Method& method, std::size_t query_set);

  std::vector<std::optional<std::vector<Side>>> truths_;
  std::optional<bool> faces_meet_;
};

}  // namespace treeline::bench::inside
