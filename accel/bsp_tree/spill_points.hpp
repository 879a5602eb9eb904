// Spill tree over points (Liu, Moore, Gray and Yang 2004), hybrid: APPROXIMATE nearest neighbours.
//
// Problem: a search in a tree spends most of its time on proving that no other cell holds a nearer point.
// Here the two sides of a plane overlap: points within tau of it are in both. A query goes down its own side
// only (a defeatist search) and is right about each neighbour at most tau away, however it falls to the
// plane; those farther away it may miss. Where the overlap would give a side more than `balance` of the
// node's points, which happens in small nodes, the node is cut without overlap, and searched with
// backtracking by box and plane as in BspTree. Hence recall is below 1 in general, yet 1 wherever the k-th
// neighbour is at most tau away: tau is a distance, as in the paper, and given in units of the cloud's own
// spacing, since a share of each node's extent would copy points at every level. (A share of its points, by
// rank, would make `balance` hold in all nodes or in none.) Each point is its own in one leaf and a copy in
// others. within(), inside() and searches with backtracking look at own points only, so that they are exact
// and never name a point twice; so does a defeatist search that was left with fewer than k points, and starts
// again. Cost: a BSP tree's, times references / n, which grows with tau; and the spacing, 32 n distances.
// Known weakness: far from the points (k-th neighbour beyond tau) it errs freely.
#pragma once

#include "accel/bsp_tree/directions.hpp"
#include "accel/bsp_tree/plane_node.hpp"
#include "accel/point_build.hpp"
#include "accel/point_queries.hpp"

namespace treeline::accel {

template <class Primitives>
class SpillTree;

struct SpillPointOptions : BuildOptions, PlaneDirections {
  double tau =
      2;  ///< half the overlap's width, in median distances between a point and its nearest other one
  double balance = 0.7;  ///< largest share of its points that a node with overlap may pass on; in [0.5, 0.8]
  enum class Search { defeatist, backtracking } search = Search::defeatist;  ///< the latter is exact
};

template <class T, int D>
class SpillTree<Points<T, D>> : public PointQueries<SpillTree<Points<T, D>>, T, D> {
  using Base = PointQueries<SpillTree, T, D>;

 public:
  using typename Base::Box;
  using typename Base::Point;
  using Options = SpillPointOptions;

  explicit SpillTree(std::span<const Point> points, Options options = {});

  /// Half the overlap's width as a distance.
  T overlap() const { return overlap_ * set_.inverse_scale; }
  /// Cells on their own side of each plane; they tile the cloud's box.
  std::vector<SliceCell> slice(int axis, double offset) const {
    return slice_of_planes(std::span<const Node>(nodes_), set_, centre_, axis, offset);
  }

  // ---- see PointQueries, in scaled coordinates
  static constexpr bool searches_itself = true;
  static constexpr std::size_t group_size = 1;
  static constexpr bool keeps_each_point_once = false;
  template <class W>
  void search_nearest(const Point& q, const SearchLimits<T>& limits, std::span<Neighbor<T>> out,
                      W& work) const;
  void search_nearest_group(std::span<const Point> queries, std::size_t k, const SearchLimits<T>& limits,
                            std::span<Neighbor<T>> out) const {
    NoWork work;
    for (std::size_t i = 0; i < queries.size(); ++i)
      search_nearest(queries[i], limits, out.subspan(i * k, k), work);
  }
  std::size_t count_within_limit(const Point& q, T limit) const {
    NoWork work;
    std::vector<Neighbor<T>> list;  // which leaves out what it has seen
    search_within(q, limit, list, work);
    return list.size();
  }
  template <class W>
  void search_within(const Point& q, T limit, std::vector<Neighbor<T>>& list, W& work) const {
    WithinRadius<T> visitor(limit, list);
    visit_near(q, visitor, work);
  }
  template <class W>
  void search_inside(const Box& box, std::vector<Id>& ids, W& work) const;
  /// With backtracking.
  template <class Visitor, class W>
  void visit_near(const Point& q, Visitor& visitor, W& work) const {
    visit<false>(q, visitor, work);
  }

 private:
  using Base::set_;
  using Base::stats_;
  using Entry = PointEntry<T, D>;

  struct Node : PlaneNode<T, D> {
    std::uint32_t own = 0;  // leaf: those of its entries that are no copies; they come first
    bool overlaps = false;  // inner: its children share points
  };
  struct Reference {
    T key;
    bool own;
    Entry entry;
  };
  using References = std::vector<Reference>;

  T along(const Point& normal, const Point& p) const { return dot(normal, p - centre_); }
  T spacing() const;
  void build(References references, std::size_t depth, const Options& options, std::vector<Entry>& entries);
  void add_leaf_of(References references, bool coincident, std::size_t depth, std::vector<Entry>& entries);
  template <bool defeatist, class Visitor, class W>
  void visit(const Point& q, Visitor& visitor, W& work) const;

  std::vector<Node> nodes_;
  std::vector<Box> boxes_;  // of each node's points, copies included
  Point centre_{};
  T radius_ = 0;   // no point is farther from the centre, give or take rounding
  T overlap_ = 0;  // scaled
  bool defeatist_ = true;
};

// ---- build ---------------------------------------------------------------------------------------------

template <class T, int D>
SpillTree<Points<T, D>>::SpillTree(std::span<const Point> points, Options options)
    : Base(points, options), defeatist_(options.search == Options::Search::defeatist) {
  check(static_cast<const PlaneDirections&>(options));
  if (!(options.tau >= 0))
    throw InvalidInput("tau is " + std::to_string(options.tau) + "; it must be at least 0");
  // Above, a node would pass so many points on that the tree were deeper than max_depth.
  if (!(options.balance >= 0.5 && options.balance <= 0.8))
    throw InvalidInput("balance is " + std::to_string(options.balance) + "; it must be between 0.5 and 0.8");
  const std::size_t n = set_.entries.size();
  if (n > 0) {
    centre_ = set_.box.centre();
    radius_ = std::max(length(set_.box.low - centre_), length(set_.box.high - centre_));
    overlap_ = static_cast<T>(std::min(options.tau * static_cast<double>(spacing()),
                                       static_cast<double>(std::numeric_limits<T>::max())));
    References all;
    all.reserve(n);
    for (const Entry& e : set_.entries) all.push_back({T(0), true, e});
    std::vector<Entry> entries;
    build(std::move(all), 0, options, entries);
    entries.shrink_to_fit(), nodes_.shrink_to_fit(), boxes_.shrink_to_fit();
    set_.entries = std::move(entries);
    stats_.references = set_.entries.size();
  }
  stats_.bytes =
      sizeof(*this) + set_.bytes() + nodes_.capacity() * sizeof(Node) + boxes_.capacity() * sizeof(Box);
}

/// The median over some points of the distance to the nearest one that differs; 0 if none do.
template <class T, int D>
T SpillTree<Points<T, D>>::spacing() const {
  const std::size_t n = set_.entries.size(), stride = n / 32 + 1;
  std::vector<T> squares;
  for (std::size_t i = stride / 2; i < n; i += stride) {
    T nearest = std::numeric_limits<T>::max();
    for (const Entry& e : set_.entries)
      if (const T s = squared_distance(e.point, set_.entries[i].point); s > 0) nearest = std::min(nearest, s);
    if (nearest < std::numeric_limits<T>::max()) squares.push_back(nearest);
  }
  if (squares.empty()) return T(0);
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::sqrt(*middle);
}

template <class T, int D>
void SpillTree<Points<T, D>>::build(References references, std::size_t depth, const Options& options,
                                    std::vector<Entry>& entries) {
  const std::size_t count = references.size(), index = nodes_.size();
  Box box;
  for (const Reference& r : references) box.grow(r.entry.point);
  const bool coincident = box.low == box.high;
  nodes_.emplace_back(), boxes_.push_back(box);
  if (coincident || count <= static_cast<std::size_t>(options.leaf_size))
    return add_leaf_of(std::move(references), coincident, depth, entries);

  Point normal;
  {
    std::vector<Entry> points(count);
    for (std::size_t i = 0; i < count; ++i) points[i] = references[i].entry;
    normal = plane_normal(std::span<const Entry>(points), box, centre_, options, index);
  }
  const auto less = [](const Reference& a, const Reference& b) { return a.key < b.key; };
  for (Reference& r : references) r.key = along(normal, r.entry.point);
  const std::size_t half = count / 2;
  const auto middle = references.begin() + static_cast<std::ptrdiff_t>(half);
  std::nth_element(references.begin(), middle, references.end(), less);
  const T below = std::max_element(references.begin(), middle, less)->key, above = middle->key;
  const T offset = below + (above - below) / T(2);

  // So that a query of one side finds all within the overlap on the other, keys may round.
  const T width = overlap_ + geometry::tolerance::plane_bound<T>(D) * (T(2) * radius_ + overlap_);
  const auto near = [&](const Reference& r) { return std::abs(r.key - offset) <= width; };
  const auto share = [&](auto from, auto to, std::size_t mine) {
    return static_cast<double>(std::count_if(from, to, near) + static_cast<std::ptrdiff_t>(mine)) /
           static_cast<double>(count);
  };
  const bool overlaps = overlap_ > 0 && share(middle, references.end(), half) <= options.balance &&
                        share(references.begin(), middle, count - half) <= options.balance;

  References left(references.begin(), middle), right(middle, references.end());
  if (overlaps) {
    const auto copy = [&](auto from, auto to, References& other) {
      for (; from != to; ++from)
        if (near(*from)) other.push_back({T(0), false, from->entry});
    };
    copy(middle, references.end(), left), copy(references.begin(), middle, right);
  }
  References().swap(references);  // before the children's are made
  add_inner(stats_, 0);
  build(std::move(left), depth + 1, options, entries);
  Node& node = nodes_[index];
  node.normal = normal, node.offset = offset, node.overlaps = overlaps;
  node.first = static_cast<std::uint32_t>(nodes_.size());
  build(std::move(right), depth + 1, options, entries);
}

template <class T, int D>
void SpillTree<Points<T, D>>::add_leaf_of(References references, bool coincident, std::size_t depth,
                                          std::vector<Entry>& entries) {
  std::sort(references.begin(), references.end(), [](const Reference& a, const Reference& b) {
    return a.own != b.own ? a.own : a.entry.id < b.entry.id;
  });
  if (entries.size() + references.size() > PointSet<T, D>::largest_size)
    throw InvalidInput("tau makes more copies than can be indexed");
  Node& leaf = nodes_.back();
  leaf.first = static_cast<std::uint32_t>(entries.size());
  leaf.count = static_cast<std::uint32_t>(references.size());
  leaf.coincident = coincident;
  leaf.own = static_cast<std::uint32_t>(
      std::count_if(references.begin(), references.end(), [](const Reference& r) { return r.own; }));
  for (const Reference& r : references) entries.push_back(r.entry);
  add_leaf(stats_, references.size(), depth, 0);
}

// ---- queries -------------------------------------------------------------------------------------------

template <class T, int D>
template <class W>
void SpillTree<Points<T, D>>::search_nearest(const Point& q, const SearchLimits<T>& limits,
                                             std::span<Neighbor<T>> out, W& work) const {
  std::size_t leaves = limits.leaves;
  const auto collect = [&](auto best, bool defeatist) {
    const auto visit_with = [&](auto& visitor) {
      defeatist ? visit<true>(q, visitor, work) : visit<false>(q, visitor, work);
    };
    if (limits.exact) {
      visit_with(best);
    } else {
      Hasty<T, decltype(best)> hasty(best, limits.shrink, leaves, limits.fills());
      visit_with(hasty);
      leaves = hasty.leaves_left();
    }
    best.finish();
  };
  for (const bool defeatist : {true, false}) {
    if (defeatist && !defeatist_) continue;
    if (out.size() <= SortedBest<T>::largest_k)
      collect(SortedBest<T>(out, limits.within), defeatist);
    else
      collect(HeapBest<T>(out, limits.within), defeatist);
    if (out.back().id != no_id || (leaves == 0 && !limits.fills())) return;
  }
}

// Below a node without overlap nothing is shared, and of a node with overlap a defeatist search sees one
// side: no point comes twice.
template <class T, int D>
template <bool defeatist, class Visitor, class W>
void SpillTree<Points<T, D>>::visit(const Point& q, Visitor& visitor, W& work) const {
  struct Far {
    T bound;
    std::uint32_t node;
  };
  Far stack[max_depth];
  int waiting = 0;

  if (this->size() == 0) return;
  const PlaneBound<T, D> beyond(radius_ + length(q - centre_));
  Far here{squared_distance(set_.box, q), 0};
  if (here.bound > visitor.limit()) return;
  while (true) {
    const Node* node = &nodes_[here.node];
    work.node();
    while (!node->leaf()) {
      const T ahead = along(node->normal, q) - node->offset;
      const std::uint32_t left = here.node + 1, right = node->first;
      Far near{here.bound, ahead > 0 ? right : left}, far{here.bound, ahead > 0 ? left : right};
      near.bound = std::max(near.bound, squared_distance(boxes_[near.node], q));
      if (!defeatist || !node->overlaps) {
        // Copies may lie on this side of the plane, but with backtracking they do not count.
        far.bound = std::max({far.bound, beyond(ahead), squared_distance(boxes_[far.node], q)});
        if (far.bound < near.bound) std::swap(near, far);
        if (far.bound <= visitor.limit()) stack[waiting++] = far;
      }
      here = near;
      if (here.bound > visitor.limit()) break;
      node = &nodes_[here.node];
      work.node();
    }
    if (here.bound <= visitor.limit()) {
      const bool equal = node->coincident == 1;
      if (node->own > 0) set_.offer(PointLeaf{node->first, node->own, equal}, q, visitor, work);
      if (defeatist && node->own < node->count)
        set_.offer(PointLeaf{node->first + node->own, node->count - node->own, equal}, q, visitor, work);
    }
    do {
      if (waiting == 0) return;
      here = stack[--waiting];
    } while (here.bound > visitor.limit());
  }
}

template <class T, int D>
template <class W>
void SpillTree<Points<T, D>>::search_inside(const Box& box, std::vector<Id>& ids, W& work) const {
  std::uint32_t stack[max_depth];
  int waiting = 0;
  std::uint32_t index = 0;
  while (true) {
    const Node& node = nodes_[index];
    work.node();
    if (boxes_[index].overlaps(box)) {
      if (!node.leaf()) {
        stack[waiting++] = node.first;
        ++index;
        continue;
      }
      work.primitive(node.own);
      for (std::uint32_t i = node.first; i < node.first + node.own; ++i)
        if (box.contains(set_.entries[i].point)) ids.push_back(set_.entries[i].id);
    }
    if (waiting == 0) return;
    index = stack[--waiting];
  }
}

static_assert(NeighborIndex<SpillTree<Points<float, 3>>> && Inspectable<SpillTree<Points<float, 3>>>);
static_assert(NeighborIndex<SpillTree<Points<double, 2>>> && Inspectable<SpillTree<Points<double, 2>>>);

}  // namespace treeline::accel
