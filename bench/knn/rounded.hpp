// Doubles made floats: what a user does whose cloud needs doubles and whose index takes floats.
//
// Points and queries are rounded, at once or after the middle of the cloud was taken from them in doubles
// (build knob `origin`: file or middle). Queries pay for their own rounding. Its answers are the index's own
// to a slightly different cloud, hence approximate.
#pragma once

#include "bench/knn/method.hpp"

namespace treeline::bench::knn {

class Rounded final : public IndexOf<double> {
 public:
  using Build = std::unique_ptr<Index> (*)(const Input&, const Knobs&);

  Rounded(const InputOf<double>& input, Build build, const Knobs& knobs) {
    if (knobs.at("origin") == "middle") {
      geometry::Box<double, 3> box;
      for (const Vec3d& p : input.points)
        if (geometry::is_finite(p)) box.grow(p);
      origin_ = box.centre();
    }
    points_.reserve(input.points.size());
    for (const Vec3d& p : input.points) points_.push_back(rounded(p));
    index_ = build({points_, input.finite, input.spacing, input.threads}, knobs);
  }

  void nearest(std::span<const Vec3d> queries, std::size_t k, const Knobs& knobs, int threads,
               std::span<Id> ids) const override {
    std::vector<Vec3f> near;
    near.reserve(queries.size());
    for (const Vec3d& q : queries) near.push_back(rounded(q));
    index_->nearest(near, k, knobs, threads, ids);
  }
  void within(std::span<const Vec3d> queries, double radius, const Knobs& knobs, int threads,
              Lists<Id>& ids) const override {
    std::vector<Vec3f> near;
    near.reserve(queries.size());
    for (const Vec3d& q : queries) near.push_back(rounded(q));
    index_->within(near, static_cast<float>(radius), knobs, threads, ids);
  }
  void inside(std::span<const geometry::Box3d> boxes, const Knobs& knobs, int threads,
              Lists<Id>& ids) const override {
    std::vector<Box3f> near;
    near.reserve(boxes.size());
    for (const geometry::Box3d& b : boxes) near.push_back({rounded(b.low), rounded(b.high)});
    index_->inside(near, knobs, threads, ids);
  }

 private:
  Vec3f rounded(const Vec3d& p) const { return Vec3f(p - origin_); }

  Vec3d origin_{};
  std::vector<Vec3f> points_;  // of which some indices keep no copy
  std::unique_ptr<Index> index_;
};

/// Every combination of these build knobs with both origins, the middle first.
inline std::vector<Knobs> with_origins(const std::vector<Knobs>& builds) {
  std::vector<Knobs> r;
  for (const char* origin : {"middle", "file"})
    for (Knobs knobs : builds) {
      knobs["origin"] = origin;
      r.push_back(std::move(knobs));
    }
  return r;
}

}  // namespace treeline::bench::knn
