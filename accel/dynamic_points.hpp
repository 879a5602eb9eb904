// Points that come and go: a forest of static trees, whose parts are rebuilt.
//
// The logarithmic method (Bentley and Saxe 1980): trees of sizes that double; what is inserted merges with
// all trees that are no larger and becomes one new tree, so that each point is rebuilt O(log n) times.
// Removed points are marked, skipped in answers, and dropped when their tree is next rebuilt, at the latest
// when a quarter of it is gone. Queries ask every tree and merge; the answers are those of one tree over the
// points that are there.
//
// Cost: insertion O(log n) rebuilds a point, amortised; a query visits every tree, at most log2(n / block) +
// 1, but all after the largest only as far as what it has found already. Known weakness: queries are slower
// than on one tree (rebuild() makes it one), and a search among many removed points asks for more than it
// returns. Not safe to change while it is queried.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>

#include "accel/batch.hpp"
#include "accel/concepts.hpp"
#include "accel/point_set.hpp"

namespace treeline::accel {

struct DynamicOptions {
  /// Trees smaller than this are merged with the next insertion. Points that come one by one pay for it (at
  /// 256 three times as much as at 64), queries hardly gain by it.
  std::size_t block = 64;
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

  using Square = typename SquareType<Scalar>::Type;
  using Listed = std::vector<std::pair<Id, Point>>;  // ascending by id
  struct Ranked {
    Square distance2;  // where the scalar's overflows or vanishes, that in a wider type
    Found found;
    bool operator<(const Ranked& o) const {
      return distance2 < o.distance2 || (distance2 == o.distance2 && found.id < o.found.id);
    }
  };
  struct Scratch {
    std::vector<Ranked> best, more, merged;
    std::vector<Found> found;
  };

  /// Whether a squared distance has all its digits: trees scale their points to keep them in range, but
  /// answer in the caller's units.
  static bool is_sound(Scalar distance2) {
    using Limits = std::numeric_limits<Scalar>;
    return distance2 <= Limits::max() && distance2 >= Limits::min() / Limits::epsilon();
  }

  void merge_alive(const Part& part, Listed& points) const;
  Part built(const Listed& points) const;
  void add(Part part);
  void find_nearest(const Point& q, std::size_t k, Scratch& s) const;
  void nearest_of(const Part& part, const Point& q, std::size_t k, Scratch& s) const;

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
  Listed merged;
  for (std::size_t i = 0; i < points.size(); ++i) merged.emplace_back(first + static_cast<Id>(i), points[i]);
  if (merged.empty()) return first;
  std::size_t kept = parts_.size();
  while (kept > 0 &&
         (parts_[kept - 1].ids.size() <= merged.size() || parts_[kept - 1].ids.size() < options_.block))
    merge_alive(parts_[--kept], merged);
  Part part = built(merged);  // what may throw comes before anything changes
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
    Listed left;
    merge_alive(part, left);
    if (left.empty()) {
      parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(p));
    } else {
      Part smaller = built(left);
      parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(p));
      add(std::move(smaller));
    }
    break;
  }
  return true;
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::rebuild() {
  Listed all;
  for (std::size_t p = parts_.size(); p-- > 0;) merge_alive(parts_[p], all);
  if (all.empty()) return parts_.clear();
  Part whole = built(all);
  parts_.clear();
  add(std::move(whole));
}

/// Both are in order of id; where points go as they came, one simply follows the other.
template <NeighborIndex Tree>
void DynamicPoints<Tree>::merge_alive(const Part& part, Listed& points) const {
  Listed all;
  all.reserve(part.ids.size() + points.size());
  for (std::size_t i = 0; i < part.ids.size(); ++i)
    if (there_[part.ids[i]]) all.emplace_back(part.ids[i], part.points[i]);
  const auto middle = static_cast<std::ptrdiff_t>(all.size());
  all.insert(all.end(), points.begin(), points.end());
  const auto by_id = [](const auto& a, const auto& b) { return a.first < b.first; };
  if (middle > 0 && !points.empty() && !by_id(all[static_cast<std::size_t>(middle) - 1], points.front()))
    std::inplace_merge(all.begin(), all.begin() + middle, all.end(), by_id);
  points = std::move(all);
}

template <NeighborIndex Tree>
auto DynamicPoints<Tree>::built(const Listed& points) const -> Part {
  Part part;
  part.ids.reserve(points.size()), part.points.reserve(points.size());
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

/// Merges the nearest of a part that are alive into the k best. What is removed takes places, so more are
/// asked for until enough are left.
template <NeighborIndex Tree>
void DynamicPoints<Tree>::nearest_of(const Part& part, const Point& q, std::size_t k, Scratch& s) const {
  NearestOptions<Scalar> options;
  if (s.best.size() == k && is_sound(s.best.back().found.distance2))  // by a margin for rounding
    options.max_distance =
        std::sqrt(s.best.back().found.distance2) * (1 + 8 * std::numeric_limits<Scalar>::epsilon());
  for (std::size_t want = std::min(k, part.ids.size());; want = std::min(2 * want, part.ids.size())) {
    s.found.resize(want);
    const std::size_t told = part.tree->nearest(q, want, options, std::span<Found>(s.found));
    s.more.clear();
    for (std::size_t i = 0; i < told && s.more.size() < k; ++i) {
      const auto [distance2, local] = s.found[i];
      if (!there_[part.ids[local]]) continue;
      using Wide = geometry::Vec<Square, Point::dimension>;
      const Square ranked =
          is_sound(distance2) ? Square(distance2) : length2(Wide(part.points[local]) - Wide(q));
      s.more.push_back({ranked, {distance2, part.ids[local]}});
    }
    if (s.more.size() == k || told < want || want == part.ids.size()) break;
  }
  s.merged.clear();
  std::merge(s.best.begin(), s.best.end(), s.more.begin(), s.more.end(), std::back_inserter(s.merged));
  if (s.merged.size() > k) s.merged.resize(k);
  s.best.swap(s.merged);
}

/// Into s.best, nearest first.
template <NeighborIndex Tree>
void DynamicPoints<Tree>::find_nearest(const Point& q, std::size_t k, Scratch& s) const {
  s.best.clear();
  for (const Part& part : parts_) nearest_of(part, q, k, s);
}

template <NeighborIndex Tree>
std::size_t DynamicPoints<Tree>::nearest(const Point& q, std::size_t k, std::span<Found> out) const {
  if (k == 0) throw InvalidInput("k is 0; it must be at least 1");
  if (!geometry::is_finite(q)) throw InvalidInput("query has a coordinate that is not finite");
  const std::size_t m = std::min(k, size());
  if (out.size() < m)
    throw InvalidInput("out holds " + std::to_string(out.size()) + " answers; it must hold " +
                       std::to_string(m));
  Scratch s;
  if (m > 0) find_nearest(q, m, s);
  for (std::size_t i = 0; i < m; ++i) out[i] = s.best[i].found;
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
  const std::size_t m = std::min(k, size());
  parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
    Scratch s;
    for (std::size_t i = begin; i < end; ++i) {
      if (m > 0) find_nearest(queries[i], m, s);
      const std::span<Found> row = out.subspan(i * k, k);
      for (std::size_t j = 0; j < k; ++j) row[j] = j < m ? s.best[j].found : Found{};
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
