// A static index made anew after every change: what a user does who has no dynamic one.
//
// Holds the points that are there, packed, and their ids; what goes leaves its place to the last one. A
// change costs a build of all points, however few of them changed; queries are as fast as they can be.
#pragma once

#include <vector>

#include "bench/knn_dynamic/method.hpp"

namespace treeline::bench::knn_dynamic {

/// Static: built over points as Static(std::span<const Vec3f>, const Knobs&, threads), with
/// nearest(queries, k, threads, ids) that answers in numbers of those points.
template <class Static>
class Rebuilt final : public Index {
 public:
  Rebuilt(const Input& input, const Knobs& knobs) : input_(input), knobs_(knobs), place_(input.pool.size()) {}

  void change(std::span<const Id> gone, Id first, Id last) override {
    index_.reset();  // it may refer to the points
    for (const Id id : gone) {
      const std::size_t at = place_[id];
      ids_[at] = ids_.back(), points_[at] = points_.back(), place_[ids_[at]] = at;
      ids_.pop_back(), points_.pop_back();
    }
    for (Id id = first; id < last; ++id) {
      place_[id] = ids_.size();
      ids_.push_back(id), points_.push_back(input_.pool[id]);
    }
    index_ = std::make_unique<Static>(std::span<const Vec3f>(points_), knobs_, input_.threads);
  }

  void nearest(std::span<const Vec3f> queries, std::size_t k, int threads, std::span<Id> ids) const override {
    if (!index_) return;
    index_->nearest(queries, k, threads, ids);
    for (Id& id : ids)
      if (id != accel::no_id) id = ids_[id];
  }

 private:
  const Input input_;
  const Knobs knobs_;
  std::vector<std::size_t> place_;  // by id, of those that are there
  std::vector<Vec3f> points_;
  std::vector<Id> ids_;
  std::unique_ptr<Static> index_;
};

}  // namespace treeline::bench::knn_dynamic
