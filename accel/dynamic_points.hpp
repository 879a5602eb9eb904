// Points that come and go: a forest of static trees, whose parts are rebuilt.
//
// The logarithmic method (Bentley and Saxe 1980): trees of sizes that double; what is inserted merges with
// all trees that are no larger and becomes one new tree, so that each point is rebuilt O(log n) times.
// Removed points are marked, skipped in answers, and dropped when their tree is next rebuilt, at the latest
// when a quarter of it is gone. Queries ask every tree and merge; the answers are those of one tree over the
// points that are there.
//
// Cost: insertion O(log n) rebuilds a point, amortised; a query costs that of one tree times the number of
// trees, at most log2(n / block) + 1. Known weakness: queries are slower than on one tree (rebuild() makes it
// one), and a search among many removed points asks for more than it returns. Not safe to change while it is
// queried.
#pragma once

#include <algorithm>
#include <memory>

#include "accel/batch.hpp"
#include "accel/concepts.hpp"

namespace treeline::accel {

struct DynamicOptions {
  std::size_t block = 256;  ///< trees smaller than this are merged with the next insertion
};

template <NeighborIndex Tree>
class DynamicPoints {
 public:
  using Scalar = typename Tree::Scalar;
  using Point = typename Tree::Point;
  using Box = typename Tree::Box;
  using Found = Neighbor<Scalar>;

  explicit DynamicPoints(typename Tree::Options tree_options = {}, DynamicOptions options = {})
      : tree_options_(tree_options), options_(options) {
    if (options.block == 0) throw InvalidInput("block is 0; it must be at least 1");
  }

  /// Adds points; returns the id of the first, the others follow. Ids are never used twice.
  /// Throws InvalidInput, and adds none, for a point that is not finite, or if the ids run out.
  Id insert(std::span<const Point> points);
  /// Removes a point. Returns false if there is no such id, or no longer.
  bool erase(Id id);
  /// Makes one tree of all that is there.
  void rebuild();

  std::size_t size() const { return alive_; }
  std::size_t tree_count() const { return parts_.size(); }
  std::size_t bytes() const;

  // See NeighborIndex; answers and refusals are the same.
  std::size_t nearest(const Point& q, std::size_t k, std::span<Found> out) const;
  void within(const Point& q, Scalar radius, std::vector<Found>& out) const;
  void inside(const Box& box, std::vector<Id>& out) const;
  void nearest(std::span<const Point> queries, std::size_t k, std::span<Found> out, int threads = 1) const;

 private:
  struct Part {
    std::vector<Point> points;
    std::vector<Id> ids;  // ascending, so that ties by a tree's own numbers are ties by id
    std::unique_ptr<Tree> tree;
    std::size_t dead = 0;
  };
  static constexpr std::uint32_t nowhere = 0xffffffffu;

  void copy_alive(const Part& part, std::vector<std::pair<Id, Point>>& points) const;
  Part built(std::vector<std::pair<Id, Point>> points) const;
  void add(Part part);
  void nearest_of(const Part& part, const Point& q, std::size_t k, std::vector<Found>& list) const;

  typename Tree::Options tree_options_;
  DynamicOptions options_;
  std::vector<Part> parts_;  // largest first
  std::vector<bool> there_;  // by id
  std::size_t alive_ = 0;
};

// ---- change --------------------------------------------------------------------------------------------

template <NeighborIndex Tree>
Id DynamicPoints<Tree>::insert(std::span<const Point> points) {
  if (points.size() >= no_id - there_.size())
    throw InvalidInput(std::to_string(points.size()) + " points more than ids are left for");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!geometry::is_finite(points[i]))
      throw InvalidInput("point " + std::to_string(i) + " has a coordinate that is not finite");
  const Id first = static_cast<Id>(there_.size());
  std::vector<std::pair<Id, Point>> merged;
  for (std::size_t i = 0; i < points.size(); ++i) merged.emplace_back(first + static_cast<Id>(i), points[i]);
  if (merged.empty()) return first;
  std::size_t kept = parts_.size();
  while (kept > 0 &&
         (parts_[kept - 1].ids.size() <= merged.size() || parts_[kept - 1].ids.size() < options_.block))
    copy_alive(parts_[--kept], merged);
  Part part = built(std::move(merged));  // what may throw comes before anything changes
  there_.resize(there_.size() + points.size(), true), alive_ += points.size();
  parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(kept), parts_.end());
  add(std::move(part));
  return first;
}

template <NeighborIndex Tree>
bool DynamicPoints<Tree>::erase(Id id) {
  if (id >= there_.size() || !there_[id]) return false;
  there_[id] = false, --alive_;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Part& part = parts_[p];
    if (!std::binary_search(part.ids.begin(), part.ids.end(), id)) continue;
    if (4 * ++part.dead <= part.ids.size()) break;
    std::vector<std::pair<Id, Point>> left;
    copy_alive(part, left);
    if (left.empty()) {
      parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(p));
    } else {
      Part smaller = built(std::move(left));
      parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(p));
      add(std::move(smaller));
    }
    break;
  }
  return true;
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::rebuild() {
  std::vector<std::pair<Id, Point>> all;
  for (const Part& part : parts_) copy_alive(part, all);
  if (all.empty()) return parts_.clear();
  Part whole = built(std::move(all));
  parts_.clear();
  add(std::move(whole));
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::copy_alive(const Part& part, std::vector<std::pair<Id, Point>>& points) const {
  for (std::size_t i = 0; i < part.ids.size(); ++i)
    if (there_[part.ids[i]]) points.emplace_back(part.ids[i], part.points[i]);
}

template <NeighborIndex Tree>
auto DynamicPoints<Tree>::built(std::vector<std::pair<Id, Point>> points) const -> Part {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  Part part;
  for (const auto& [id, point] : points) part.ids.push_back(id), part.points.push_back(point);
  part.tree = std::make_unique<Tree>(std::span<const Point>(part.points), tree_options_);
  return part;
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::add(Part part) {
  const auto smaller = [&](const Part& other) { return other.ids.size() < part.ids.size(); };
  parts_.insert(std::find_if(parts_.begin(), parts_.end(), smaller), std::move(part));
}

template <NeighborIndex Tree>
std::size_t DynamicPoints<Tree>::bytes() const {
  std::size_t sum = sizeof(*this) + there_.capacity() / 8;
  for (const Part& part : parts_)
    sum += part.tree->bytes() + part.ids.capacity() * sizeof(Id) + part.points.capacity() * sizeof(Point);
  return sum;
}

// ---- queries -------------------------------------------------------------------------------------------

/// Appends the k nearest that are alive. What is removed takes places, so more are asked for until enough are
/// left.
template <NeighborIndex Tree>
void DynamicPoints<Tree>::nearest_of(const Part& part, const Point& q, std::size_t k,
                                     std::vector<Found>& list) const {
  const std::size_t before = list.size();
  for (std::size_t want = k;; want *= 2) {
    want = std::min(want, part.ids.size());
    std::vector<Found> found(want);
    part.tree->nearest(q, want, std::span<Found>(found));
    list.resize(before);
    for (const Found& f : found)
      if (const Id id = part.ids[f.id]; there_[id] && list.size() < before + k)
        list.push_back({f.distance2, id});
    if (list.size() == before + k || want == part.ids.size()) return;
  }
}

template <NeighborIndex Tree>
std::size_t DynamicPoints<Tree>::nearest(const Point& q, std::size_t k, std::span<Found> out) const {
  if (k == 0) throw InvalidInput("k is 0; it must be at least 1");
  if (!geometry::is_finite(q)) throw InvalidInput("query has a coordinate that is not finite");
  const std::size_t m = std::min(k, size());
  if (out.size() < m)
    throw InvalidInput("out holds " + std::to_string(out.size()) + " answers; it must hold " +
                       std::to_string(m));
  std::vector<Found> list;
  for (const Part& part : parts_) nearest_of(part, q, m, list);
  std::partial_sort_copy(list.begin(), list.end(), out.begin(), out.begin() + static_cast<std::ptrdiff_t>(m));
  return m;
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::nearest(std::span<const Point> queries, std::size_t k, std::span<Found> out,
                                  int threads) const {
  if (k == 0) throw InvalidInput("k is 0; it must be at least 1");
  if (out.size() / k < queries.size())
    throw InvalidInput("out holds " + std::to_string(out.size()) + " answers; it must hold " +
                       std::to_string(k) + " for each query");
  for (std::size_t i = 0; i < queries.size(); ++i)
    if (!geometry::is_finite(queries[i]))
      throw InvalidInput("query " + std::to_string(i) + " has a coordinate that is not finite");
  parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<Found> row = out.subspan(i * k, k);
      for (std::size_t n = nearest(queries[i], k, row); n < k; ++n) row[n] = {};
    }
  });
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::within(const Point& q, Scalar radius, std::vector<Found>& out) const {
  if (!(radius >= 0)) throw InvalidInput("radius is " + std::to_string(radius) + "; it must be at least 0");
  if (!geometry::is_finite(q)) throw InvalidInput("query has a coordinate that is not finite");
  out.clear();
  std::vector<Found> found;
  for (const Part& part : parts_) {
    part.tree->within(q, radius, found);
    for (const Found& f : found)
      if (const Id id = part.ids[f.id]; there_[id]) out.push_back({f.distance2, id});
  }
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::inside(const Box& box, std::vector<Id>& out) const {
  out.clear();
  std::vector<Id> found;
  for (const Part& part : parts_) {
    part.tree->inside(box, found);
    for (const Id local : found)
      if (const Id id = part.ids[local]; there_[id]) out.push_back(id);
  }
}

}  // namespace treeline::accel
