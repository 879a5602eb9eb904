// What tasks about one mesh have in common: how a block over it is opened, and what it says of itself.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/core/all_threads.hpp"
#include "bench/core/task.hpp"

namespace treeline::bench {

struct MeshInput {
  geometry::Mesh3f mesh;
  std::uint64_t seed = 0, dataset_hash = 0;
  bool quick = false;  // time is short
  int threads = 1;     // for queries and their truth, which nobody times; 1 starts no thread pool
  std::string truth_cache;
  int version = 0;  // of the task
};

/// Throws std::invalid_argument for a dataset without triangles; `what` the task needs.
inline void require_triangles(const datasets::Dataset& dataset, const std::string& what) {
  if (dataset.kind == datasets::Kind::mesh && !dataset.mesh.faces.empty()) return;
  throw std::invalid_argument("'" + dataset.name + "' " +
                              (dataset.kind == datasets::Kind::mesh ? "has no triangles" : "is no mesh") +
                              "; " + what);
}

/// Takes the mesh.
inline void take_mesh(MeshInput& input, datasets::Dataset&& dataset, const RunContext& context, int version) {
  input.dataset_hash = dataset.hash(), input.seed = dataset.seed;
  input.quick = context.profile == Profile::quick;
  input.threads = all_threads();
  input.truth_cache = context.truth_cache;
  input.version = version;
  input.mesh = std::move(dataset.mesh);
}

/// The mesh of a hard case. Its truth is found by one thread: hard cases run in children of a fork, which
/// must not have a thread pool.
inline void take_hard_mesh(MeshInput& input, geometry::Mesh3f&& mesh, const RunContext& context,
                           int version) {
  datasets::Dataset dataset;
  dataset.kind = datasets::Kind::mesh, dataset.seed = context.seed;
  dataset.mesh = std::move(mesh);
  take_mesh(input, std::move(dataset), context, version);
  input.quick = false, input.threads = 1;
}

/// A set that says the same of many more queries, where threads share them: "near" becomes "near_threads".
/// Calls kept(set, its new number) for those that stay.
template <class Sets, class F>
void keep_for_threads(Sets& sets, std::initializer_list<std::string_view> names, F&& kept) {
  std::erase_if(sets, [&](const auto& set) { return std::ranges::find(names, set.name) == names.end(); });
  for (std::size_t i = 0; i < sets.size(); ++i) {
    sets[i].name += "_threads";
    kept(sets[i], i);
  }
}

/// Numbers of at most `most` of `size` queries, evenly spread.
inline std::vector<std::size_t> evenly_spread(std::size_t size, std::size_t most) {
  std::vector<std::size_t> r(std::min(size, most));
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = i * size / r.size();
  return r;
}

/// Input derives from MeshInput; Method has a warm_up(threads), which may be empty.
template <std::derived_from<MeshInput> Input, class Method>
class MeshBlock : public Block {
 public:
  const std::vector<QuerySet>& query_sets() const final { return query_sets_; }
  std::uint64_t seed() const final { return input_.seed; }
  std::uint64_t dataset_hash() const final { return input_.dataset_hash; }
  bool quick() const final { return input_.quick; }
  /// On several threads everybody's: a library that is not asked may keep the others from having them.
  void warm_up(std::size_t m, int threads) final {
    for (const Method& method : methods_)
      if (method.warm_up && (threads > 1 || &method == &methods_[m])) method.warm_up(threads);
  }

 protected:
  MeshBlock(Input input, const std::vector<Method>& methods) : input_(std::move(input)), methods_(methods) {}

  Input input_;
  const std::vector<Method>& methods_;
  std::vector<QuerySet> query_sets_;
};

}  // namespace treeline::bench
