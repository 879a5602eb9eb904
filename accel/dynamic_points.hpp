// Points that come and go: a forest of static trees, whose parts are rebuilt, and a few points in no tree.
//
// The logarithmic method (Bentley and Saxe 1980): what comes waits in a block of loose points; a full block
// becomes a tree, together with all trees that are no larger (or `growth` times as large), so that each point
// is rebuilt O(log n) times. Removed points are marked, skipped in answers, and dropped when their tree is
// next rebuilt, at the latest when half of it is gone. Queries ask every tree, the largest first and the
// others only as far as what has been found, and the loose points, and merge; the answers are those of one
// tree over the points that are there, to the bit (see dynamic_measure.hpp).
//
// Cost: insertion O(log n) rebuilds a point, amortised; a query visits every tree, at most log2(n / block) +
// 1 of them. Known weakness: queries are slower than on one tree (rebuild() makes it one), and a search among
// many removed points asks for more than it returns. Parts of very different size, some of which alone would
// be scaled and together are not, are asked twice. Not safe to change while it is queried.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>

#include "accel/batch.hpp"
#include "accel/concepts.hpp"
#include "accel/dynamic_measure.hpp"
#include "accel/loose_points.hpp"
#include "accel/point_checks.hpp"
#include "accel/point_set.hpp"

namespace treeline::accel {

struct DynamicOptions {
  /// So many points wait in no tree, and every query looks at them all.
  std::size_t block = 128;
  /// At least 1: a new tree takes in those up to so many times as large. More leave fewer and larger trees;
  /// insertions then take longer (at 1e5 points, one at a time: 4 instead of 1 by 1.6 to 1.7 times), and what
  /// queries gain depends on the cloud and the moment (half their time in an even cube, none where half of a
  /// scanned street's largest tree is removed).
  double growth = 4;
};

/// Tree: one of this library's over points, of which it also needs measure().
template <NeighborIndex Tree>
class DynamicPoints {
 public:
  using Scalar = typename Tree::Scalar;
  using Point = typename Tree::Point;
  using Box = typename Tree::Box;
  using Found = Neighbor<Scalar>;
  static constexpr int dimension = Point::dimension;

  /// Throws InvalidInput for options that its trees or it refuse.
  explicit DynamicPoints(typename Tree::Options tree_options = {}, DynamicOptions options = {});

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

  // ---- queries: see NeighborIndex; answers and refusals are the same ----------------------------------
  // max_leaves counts for each tree.

  std::size_t nearest(const Point& q, std::size_t k, std::span<Found> out) const {
    return nearest(q, k, NearestOptions<Scalar>{}, out);
  }
  template <WorkCounter W>
  std::size_t nearest(const Point& q, std::size_t k, std::span<Found> out, W& work) const {
    return nearest(q, k, NearestOptions<Scalar>{}, out, work);
  }
  std::size_t nearest(const Point& q, std::size_t k, const NearestOptions<Scalar>& options,
                      std::span<Found> out) const {
    NoWork work;
    return nearest(q, k, options, out, work);
  }
  template <WorkCounter W>
  std::size_t nearest(const Point& q, std::size_t k, const NearestOptions<Scalar>& options,
                      std::span<Found> out, W& work) const;
  void within(const Point& q, Scalar radius, std::vector<Found>& out) const {
    NoWork work;
    within(q, radius, out, work);
  }
  template <WorkCounter W>
  void within(const Point& q, Scalar radius, std::vector<Found>& out, W& work) const;
  void within(const Point& q, Scalar radius, const WithinOptions& options, std::vector<Found>& out) const {
    NoWork work;
    within(q, radius, options, out, work);
  }
  template <WorkCounter W>
  void within(const Point& q, Scalar radius, const WithinOptions& options, std::vector<Found>& out,
              W& work) const;
  void within_squared(const Point& q, Scalar radius2, std::vector<Found>& out) const;
  std::size_t count_within(const Point& q, Scalar radius) const;
  void inside(const Box& box, std::vector<Id>& out) const {
    NoWork work;
    inside(box, out, work);
  }
  template <WorkCounter W>
  void inside(const Box& box, std::vector<Id>& out, W& work) const;

  void nearest(std::span<const Point> queries, std::size_t k, std::span<Found> out, int threads = 1) const {
    nearest(queries, k, NearestOptions<Scalar>{}, out, threads);
  }
  void nearest(std::span<const Point> queries, std::size_t k, const NearestOptions<Scalar>& options,
               std::span<Found> out, int threads = 1) const;
  void within(std::span<const Point> queries, Scalar radius, Lists<Found>& out, int threads = 1) const;
  void inside(std::span<const Box> boxes, Lists<Id>& out, int threads = 1) const;

 private:
  struct Part {
    std::vector<Point> points;
    std::vector<Id> ids;  // ascending, so that ties by a tree's own numbers are ties by id
    std::unique_ptr<Tree> tree;
    std::size_t dead = 0;

    /// Where the point of an id is, if it is or was here.
    std::optional<std::size_t> place(Id id) const {
      const auto at = std::lower_bound(ids.begin(), ids.end(), id);
      if (at == ids.end() || *at != id) return {};
      return static_cast<std::size_t>(at - ids.begin());
    }
  };

  using Checks = PointChecks<Scalar, dimension>;
  using Measure = PointMeasure<Scalar, dimension>;
  using Query = DynamicQuery<Scalar, dimension>;
  using Ranked = Neighbor<SquareOf<Scalar>>;         // its distance is a rank
  using Listed = std::vector<std::pair<Id, Point>>;  // ascending by id
  template <class Item>
  struct Gathered {
    std::vector<Item> best, more, merged;
  };
  struct Scratch {
    Gathered<Found> plain;
    Gathered<Ranked> ranked;
    std::vector<Found> told;
  };

  /// Whether squared distances in the caller's units compare as ranks do: trees scale their points to keep
  /// squares in range, but answer in the caller's units.
  bool is_sound(Scalar distance2) const { return lowest_sound_ <= distance2 && distance2 <= highest_sound_; }
  void measure_anew();

  void merge_alive(const Part& part, Listed& points) const;
  void merge_loose(Listed& points) const;
  Part built(const Listed& points) const;
  void add(Part part);
  void shrink(std::size_t part);

  bool is_there(const Part& part, Id local) const { return part.dead == 0 || there_[part.ids[local]]; }
  template <class W, class F>
  void each_within(const Point& q, Scalar radius, W& work, F&& f) const;
  std::size_t asked_of(const Part& part, std::size_t k) const;
  template <class Item, class W>
  bool gather(const Point& q, const Query& query, std::size_t k, const NearestOptions<Scalar>& options,
              std::span<const Found> first, Scratch& s, Gathered<Item>& g, W& work) const;
  template <class W>
  void gather_widely(const Point& q, const Query& query, std::size_t k, Scalar max_distance, Scratch& s,
                     W& work) const;
  template <class W>
  std::size_t find_nearest(const Point& q, const NearestOptions<Scalar>& options,
                           std::span<const Found> first, std::span<Found> out, Scratch& s, W& work) const;

  typename Tree::Options tree_options_;
  DynamicOptions options_;
  std::vector<Part> parts_;  // largest first
  LoosePoints<Scalar, dimension> loose_;
  std::vector<bool> there_;  // by id
  std::size_t alive_ = 0;
  ExponentCounts<Scalar, dimension> counts_;  // of what is there
  Measure measure_;
  bool alike_ = true;  // every part is scaled as all of it is
  Scalar lowest_sound_ = 0, highest_sound_ = 0;
};

// ---- change --------------------------------------------------------------------------------------------

template <NeighborIndex Tree>
DynamicPoints<Tree>::DynamicPoints(typename Tree::Options tree_options, DynamicOptions options)
    : tree_options_(tree_options), options_(options) {
  if (options.block == 0) throw InvalidInput("block is 0; it must be at least 1");
  if (!(options.growth >= 1) || std::isinf(options.growth))
    throw InvalidInput("growth is " + std::to_string(options.growth) + "; it must be finite and at least 1");
  static_cast<void>(Tree(std::span<const Point>(), tree_options));  // refuses what it must now, not later
  measure_anew();
}

template <NeighborIndex Tree>
Id DynamicPoints<Tree>::insert(std::span<const Point> points) {
  if (points.size() >= no_id - there_.size())
    throw InvalidInput(std::to_string(points.size()) + " points more than ids are left for");
  for (std::size_t i = 0; i < points.size(); ++i) Checks::check_query(points[i], "point", i);
  const Id first = static_cast<Id>(there_.size());
  if (loose_.size() + points.size() < options_.block) {
    there_.resize(there_.size() + points.size(), true);
    for (std::size_t i = 0; i < points.size(); ++i) loose_.add(first + static_cast<Id>(i), points[i]);
    alive_ += points.size();
    for (const Point& p : points) counts_.add(p);
    measure_anew();
    return first;
  }
  Listed merged;
  merged.reserve(loose_.size() + points.size());
  merge_loose(merged);
  for (std::size_t i = 0; i < points.size(); ++i) merged.emplace_back(first + static_cast<Id>(i), points[i]);
  std::size_t kept = parts_.size();
  while (kept > 0 && static_cast<double>(parts_[kept - 1].ids.size()) <=
                         options_.growth * static_cast<double>(merged.size())) {
    merge_alive(parts_[--kept], merged);
  }
  there_.reserve(there_.size() + points.size());
  Part part = built(merged);  // what may throw comes before anything changes
  there_.resize(there_.size() + points.size(), true), alive_ += points.size();
  parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(kept), parts_.end());
  loose_.clear();
  add(std::move(part));
  for (const Point& p : points) counts_.add(p);
  measure_anew();
  return first;
}

template <NeighborIndex Tree>
bool DynamicPoints<Tree>::erase(Id id) {
  if (id >= there_.size() || !there_[id]) return false;
  there_[id] = false, --alive_;
  if (const auto point = loose_.erase(id)) {
    counts_.remove(*point);
    measure_anew();
    return true;
  }
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Part& part = parts_[p];
    const auto place = part.place(id);
    if (!place) continue;
    counts_.remove(part.points[*place]);
    if (2 * ++part.dead > part.ids.size()) shrink(p);
    break;
  }
  measure_anew();
  return true;
}

/// Drops what is removed from a part.
template <NeighborIndex Tree>
void DynamicPoints<Tree>::shrink(std::size_t p) {
  Listed left;
  merge_alive(parts_[p], left);
  Part smaller;
  if (!left.empty()) smaller = built(left);
  parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(p));
  if (!left.empty()) add(std::move(smaller));
}

/// After every change.
template <NeighborIndex Tree>
void DynamicPoints<Tree>::measure_anew() {
  using Limits = std::numeric_limits<Scalar>;
  measure_ = Measure(counts_.exponents());
  alike_ = std::ranges::all_of(
      parts_, [&](const Part& part) { return part.tree->measure().scale == measure_.scale; });
  lowest_sound_ =
      std::max(Limits::min() / Limits::epsilon(), measure_.unscaled_square(vague_square<Scalar>()));
  highest_sound_ = std::min(Limits::max(), measure_.unscaled_square(Limits::max()));
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::rebuild() {
  Listed all;
  merge_loose(all);
  for (std::size_t p = parts_.size(); p-- > 0;) merge_alive(parts_[p], all);
  if (all.empty()) return parts_.clear();
  Part whole = built(all);
  parts_.clear(), loose_.clear();
  add(std::move(whole));
  measure_anew();
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::merge_loose(Listed& points) const {
  for (std::size_t i = 0; i < loose_.size(); ++i) points.emplace_back(loose_.id(i), loose_.point(i));
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
  std::size_t sum = sizeof(*this) + there_.capacity() / 8 + loose_.bytes() + counts_.bytes();
  for (const Part& part : parts_)
    sum += part.tree->bytes() + part.ids.capacity() * sizeof(Id) + part.points.capacity() * sizeof(Point);
  return sum;
}

}  // namespace treeline::accel

#include "accel/dynamic_queries.hpp"
