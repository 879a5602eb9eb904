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
    index_->nearest(narrowed<Vec3f>(queries), k, knobs, threads, ids);
  }
  void within(std::span<const Vec3d> queries, double radius, const Knobs& knobs, int threads,
              Lists<Id>& ids) const override {
    index_->within(narrowed<Vec3f>(queries), static_cast<float>(radius), knobs, threads, ids);
  }
  void inside(std::span<const geometry::Box3d> boxes, const Knobs& knobs, int threads,
              Lists<Id>& ids) const override {
    index_->inside(narrowed<Box3f>(boxes), knobs, threads, ids);
  }

  std::optional<Visits> nearest_visits(std::span<const Vec3d> queries, std::size_t k,
                                       const Knobs& knobs) const override {
    return index_->nearest_visits(narrowed<Vec3f>(queries), k, knobs);
  }
  std::optional<Visits> within_visits(std::span<const Vec3d> queries, double radius) const override {
    return index_->within_visits(narrowed<Vec3f>(queries), static_cast<float>(radius));
  }
  std::optional<Visits> inside_visits(std::span<const geometry::Box3d> boxes) const override {
    return index_->inside_visits(narrowed<Box3f>(boxes));
  }

 private:
  Vec3f rounded(const Vec3d& p) const { return Vec3f(p - origin_); }
  Box3f rounded(const geometry::Box3d& b) const { return {rounded(b.low), rounded(b.high)}; }
  template <class Narrow, class Asked>
  std::vector<Narrow> narrowed(std::span<const Asked> asked) const {
    std::vector<Narrow> r;
    r.reserve(asked.size());
    for (const Asked& a : asked) r.push_back(rounded(a));
    return r;
  }

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
