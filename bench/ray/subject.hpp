// One built index with its answers, and what it becomes where the mesh moves.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bench/core/task.hpp"
#include "bench/ray/method.hpp"
#include "bench/ray/queries.hpp"

namespace treeline::bench::ray {

class RaySubject final : public Subject {
 public:
  /// frames: the mesh as it was built over, then as it moved; they and the sets outlive the subject.
  RaySubject(const Method& method, const Knobs& knobs, int threads,
             const std::vector<geometry::Mesh3f>& frames, const std::vector<RaySet>& sets);

  /// For sets of a frame: refits or rebuilds, and takes the time of that.
  void prepare(std::size_t set, int threads) override;
  void run(std::size_t set, const Knobs& knobs, int threads) override;
  std::optional<std::pair<double, double>> work(std::size_t set, const Knobs&) override;

  const Index& index() const { return moved_ ? *moved_ : *index_; }
  /// Seconds that the last frame's update took.
  std::optional<double> update_seconds() const { return update_seconds_; }

  std::vector<RayAnswer> hits;
  std::vector<std::uint8_t> blocked;

 private:
  const Method& method_;
  Knobs knobs_;
  const std::vector<geometry::Mesh3f>& frames_;
  const std::vector<RaySet>& sets_;
  std::unique_ptr<Index> index_, moved_;  // moved_: over the mesh of a later frame
  std::optional<double> update_seconds_;
};

}  // namespace treeline::bench::ray
