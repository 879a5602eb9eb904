// What FLANN's indices share: whole chunks of queries handed over as matrices, its native batch interface.
//
// It takes squared radii and leaves out points at exactly the radius. It has no box query. `cores` stays 1:
// the threads are ours, as for every other method.
#pragma once

#include <flann/flann.hpp>

#include "accel/batch.hpp"
#include "bench/knn/method.hpp"

namespace treeline::bench::knn {

/// FLANN copies the points if it reorders them and else refers to them; it never writes to them.
inline flann::Matrix<float> flann_matrix(std::span<const Vec3f> points) {
  return {const_cast<float*>(points.empty() ? nullptr : points[0].v), points.size(), 3};
}

template <class FlannIndex>
void flann_nearest(const FlannIndex& index, std::span<const Vec3f> queries, std::size_t k,
                   const flann::SearchParams& params, int threads, std::span<Id> ids) {
  accel::parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
    // Stretches keep its matrices of 64-bit indices in the cache.
    constexpr std::size_t stretch = 256;
    std::vector<std::size_t> indices(stretch * k);
    std::vector<float> distances(stretch * k);
    for (; begin < end; begin += stretch) {
      const std::size_t count = std::min(stretch, end - begin);
      std::fill_n(indices.begin(), count * k, std::size_t{accel::no_id});
      flann::Matrix<std::size_t> index_rows(indices.data(), count, k);
      flann::Matrix<float> distance_rows(distances.data(), count, k);
      index.knnSearch(flann_matrix(queries.subspan(begin, count)), index_rows, distance_rows, k, params);
      for (std::size_t i = 0; i < count * k; ++i) ids[begin * k + i] = static_cast<Id>(indices[i]);
    }
  });
}

template <class FlannIndex>
void flann_within(const FlannIndex& index, std::span<const Vec3f> queries, float radius,
                  flann::SearchParams params, int threads, Lists<Id>& lists) {
  params.sorted = false;
  params.max_neighbors = -1;
  accel::parallel_lists(queries.size(), threads, lists, [&](std::size_t i, std::vector<Id>& ids) {
    thread_local std::vector<std::vector<std::size_t>> indices;
    thread_local std::vector<std::vector<float>> distances;
    index.radiusSearch(flann_matrix(queries.subspan(i, 1)), indices, distances, radius * radius, params);
    for (const std::size_t id : indices[0]) ids.push_back(static_cast<Id>(id));
  });
}

/// An index that stops after the query knob `checks`: one of FLANN's approximate ones.
template <class FlannIndex>
class FlannApproximate final : public Index {
 public:
  FlannApproximate(const Input& input, const flann::IndexParams& params)
      : index_(flann_matrix(input.points), params) {
    index_.buildIndex();
  }

  void nearest(std::span<const Vec3f> queries, std::size_t k, const Knobs& knobs, int threads,
               std::span<Id> ids) const override {
    flann_nearest(index_, queries, k, flann::SearchParams(knobs.at("checks").get<int>()), threads, ids);
  }
  void within(std::span<const Vec3f> queries, float radius, const Knobs& knobs, int threads,
              Lists<Id>& lists) const override {
    flann_within(index_, queries, radius, flann::SearchParams(knobs.at("checks").get<int>()), threads, lists);
  }

 private:
  FlannIndex index_;
};

}  // namespace treeline::bench::knn
