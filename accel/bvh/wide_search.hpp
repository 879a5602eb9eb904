// Searches of the wide tree over points.
//
// Nearest first: a node costs one pass over its 16 boxes; the distances carry the number of their lane in the
// last four bits, so that one minimum names both the next child and how near it is. The way to the first
// leaf has no branch but its length. Siblings wait in one vector a level and are compared anew, when their
// turn comes, with what has been found by then. Box and point distances are computed by the same operations
// in the same order, all monotone under rounding (see point_set.hpp), so no true neighbour is ever cut off.
// What waits within the limit is prefetched: leaves of a million points miss the caches, and their latencies
// then overlap.
#pragma once

#include <algorithm>
#include <bit>
#include <vector>

#include "accel/bvh/wide_layout.hpp"
#include "accel/point_measure.hpp"
#include "accel/simd/doubles16.hpp"
#include "accel/simd/sorted_keys.hpp"

namespace treeline::accel::wide {

using simd::Floats16;
using simd::Ints16;
template <class T>
using Lanes = std::conditional_t<std::is_same_v<T, float>, Floats16, simd::Doubles16>;

/// Coordinates of a query, each in all lanes. For doubles see wide_double.hpp.
template <int D, class T = float>
struct Query {
  Floats16 x[D];
  explicit Query(const geometry::Vec<float, D>& p) {
    for (int a = 0; a < D; ++a) x[a] = Floats16::broadcast(p[a]);
  }
};

template <int D>
Floats16 distances(const Leaf<D>& leaf, const Query<D>& q) {
  Floats16 d = Floats16::load(leaf.x[0]) - q.x[0];
  Floats16 sum = d * d;
  for (int a = 1; a < D; ++a) {
    d = Floats16::load(leaf.x[a]) - q.x[a];
    sum = sum + d * d;
  }
  return sum;
}

/// NaN for absent boxes: max() keeps its second argument's.
template <int D>
Floats16 distances(const Node<D>& node, const Query<D>& q) {
  const Floats16 zero = Floats16::broadcast(0);
  Floats16 sum;
  for (int a = 0; a < D; ++a) {
    const Floats16 right = q.x[a] - Floats16::load(node.high[a]), left = Floats16::load(node.low[a]) - q.x[a];
    const Floats16 d = simd::max(zero, simd::max(right, left));
    sum = a == 0 ? d * d : sum + d * d;
  }
  return sum;
}

/// Of the corner farthest from the query; NaN for absent boxes.
template <int D>
Floats16 farthest(const Node<D>& node, const Query<D>& q) {
  Floats16 sum;
  for (int a = 0; a < D; ++a) {
    const Floats16 right = q.x[a] - Floats16::load(node.low[a]), left = Floats16::load(node.high[a]) - q.x[a];
    const Floats16 d = simd::max(right, left);
    sum = a == 0 ? d * d : sum + d * d;
  }
  return sum;
}

template <class T>
void prefetch(const T* object, std::size_t bytes = sizeof(T)) {
  for (std::size_t i = 0; i < bytes; i += 64) __builtin_prefetch(reinterpret_cast<const char*>(object) + i);
}
/// Children of node number `at` of a level, those whose bits are set.
template <int D, class T>
void prefetch_children(const Tree<D, T>& tree, int level, std::size_t at, std::uint32_t bits) {
  for (; bits != 0; bits &= bits - 1) {
    const std::size_t child = at * lanes + static_cast<std::size_t>(std::countr_zero(bits));
    if (level == 1)
      prefetch(&tree.leaves[child]);
    else
      prefetch(&tree.level(level - 1)[child], offsetof(Node<D>, first_id));
  }
}

inline std::int32_t bits_of(float x) { return std::bit_cast<std::int32_t>(x); }

// ---- what a search for the k nearest collects ----------------------------------------------------------
//
// `limit` is the squared distance, as bits, beyond which a box cannot matter.

/// One neighbour: the least key, found without a branch.
class NearestOne {
 public:
  static constexpr int prefetched = 0;
  explicit NearestOne(std::size_t, float within) : best_(simd::key_of(within, no_id)) {}
  std::int32_t limit() const { return simd::distance_bits(best_); }
  Id last_id() const { return simd::id_of(best_); }
  void take(const Floats16& distance2, const Id* ids) {
    best_ = std::min(best_, simd::smallest_key(distance2, ids));
  }
  void write(std::span<Neighbor<float>> out) const { out[0] = simd::neighbor_of(best_); }

 private:
  double best_;
};

/// Keys: SortedKeys<8 … 32> or LongKeys.
template <class Keys>
class NearestFew {
 public:
  static constexpr int prefetched = 2;
  NearestFew(std::size_t k, float within) : keys_(k, within), limit_(Floats16::broadcast(within)) {}
  std::int32_t limit() const { return simd::distance_bits(keys_.last()); }
  Id last_id() const { return simd::id_of(keys_.last()); }
  void take(const Floats16& distance2, const Id* ids) {
    std::uint32_t near = simd::bits_le(distance2, limit_);
    if (near == 0) return;
    alignas(64) float d[lanes];
    distance2.store(d);
    const auto next = [&] {
      if (near == 0) return std::numeric_limits<double>::infinity();
      const int i = std::countr_zero(near);
      near &= near - 1;
      return simd::key_of(d[i], ids[i]);
    };
    do {
      const double a = next(), b = next();
      keys_.insert(std::min(a, b), std::max(a, b));
    } while (near != 0);
    limit_ = Floats16::broadcast(std::bit_cast<float>(limit()));
  }
  void write(std::span<Neighbor<float>> out) const { keys_.write(out); }

 private:
  Keys keys_;
  Floats16 limit_;
};

/// Any k: a heap of keys with the worst on top.
class NearestMany {
 public:
  static constexpr int prefetched = 2;
  NearestMany(std::size_t k, float within) : keys_(k, simd::key_of(within, no_id)) {}
  std::int32_t limit() const { return simd::distance_bits(keys_.front()); }
  Id last_id() const { return simd::id_of(keys_.front()); }
  void take(const Floats16& distance2, const Id* ids) {
    std::uint32_t near = simd::bits_le(distance2, Floats16::broadcast(std::bit_cast<float>(limit())));
    if (near == 0) return;
    alignas(64) float d[lanes];
    distance2.store(d);
    for (; near != 0; near &= near - 1) {
      const int i = std::countr_zero(near);
      const double key = simd::key_of(d[i], ids[i]);
      if (key < keys_.front()) replace_worst(key);
    }
  }
  void write(std::span<Neighbor<float>> out) {
    std::sort(keys_.begin(), keys_.end());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = simd::neighbor_of(keys_[i]);
  }

 private:
  void replace_worst(double key) {
    std::size_t hole = 0;
    for (std::size_t child; (child = 2 * hole + 1) < keys_.size(); hole = child) {
      if (child + 1 < keys_.size() && keys_[child] < keys_[child + 1]) ++child;
      if (!(key < keys_[child])) break;
      keys_[hole] = keys_[child];
    }
    keys_[hole] = key;
  }
  std::vector<double> keys_;
};

// ---- nearest -------------------------------------------------------------------------------------------

/// Where a search stands: at a leaf, with what waits on each level above.
template <int D>
struct Path {
  Ints16 waiting[max_levels + 1];
  std::size_t at = 0;
};
inline constexpr std::int32_t nothing = 0x7fffffff;  // in a lane that waits no more

/// One step towards the nearest leaf, from a node of `level` to its nearest child.
template <int D, class T, class W>
[[gnu::always_inline]] inline void descend(const Tree<D, T>& tree, const Query<D, T>& q, int level,
                                           Path<D>& path, W& work) {
  work.node();
  const Ints16 near = simd::tagged(distances(tree.level(level)[path.at], q));
  const std::int32_t first = simd::smallest(near);
  path.waiting[level] = simd::replaced(near, first, nothing);
  path.at = path.at * lanes + static_cast<std::size_t>(first & simd::lane_mask);
}

/// Whether a tagged distance does not tell if the child can matter.
template <class Best>
bool is_close(std::int32_t tagged, const Best& best) {
  return ((tagged ^ best.limit()) & ~simd::lane_mask) == 0;
}
/// Whether a child whose distance has the same upper bits as the limit can hold anything better: it may lie
/// beyond, or its points may all come later in the order of ids.
template <int D, class Best>
[[gnu::noinline]] bool matters(const Node<D>& node, const Query<D>& q, int lane, const Best& best) {
  alignas(64) float d[lanes];
  distances(node, q).store(d);
  const std::int32_t exact = bits_of(d[lane]);
  return exact < best.limit() || (exact == best.limit() && node.first_id[lane] < best.last_id());
}

/// How far an approximate search goes.
struct Effort {
  float shrink = 1;  // boxes farther than the limit times this are left out once there are k
  std::size_t leaves = static_cast<std::size_t>(-1);
  bool fills = true;  // goes on until there are k
};

/// From the first leaf, where `path` leads, to all others that matter.
template <bool exact, int D, class T, class Best, class W>
[[gnu::always_inline]] inline void search(const Tree<D, T>& tree, const Query<D, T>& q, Path<D>& path,
                                          Best& best, Effort effort, W& work) {
  const auto limit = [&] {
    const std::int32_t worst = best.limit();
    if (exact || best.last_id() == no_id) return worst;
    const std::int32_t vague = bits_of(vague_square<float>());
    return std::max(bits_of(std::bit_cast<float>(worst) * effort.shrink), std::min(worst, vague));
  };
  const auto take = [&](std::size_t leaf) {
    work.node(), work.primitive(lanes);
    best.take(distances(tree.leaves[leaf], q), tree.leaves[leaf].id);
  };
  const auto within = [&](const Ints16& waiting) {
    return simd::bits_le(waiting, Ints16::broadcast(limit() | simd::lane_mask));
  };
  if (tree.top == 0) return take(path.at);
  int level = 1;
  std::size_t at = path.at / lanes;
  Ints16 waiting = path.waiting[1];
  std::int32_t next = simd::smallest(waiting);
  if constexpr (Best::prefetched > 0) {
    Ints16 w = waiting;
    std::int32_t n = next;
    for (int i = 0; i < Best::prefetched; ++i) {
      prefetch(&tree.leaves[std::min(at * lanes + static_cast<std::size_t>(n & simd::lane_mask),
                                     tree.leaves.size() - 1)]);
      w = simd::replaced(w, n, nothing), n = simd::smallest(w);
    }
  }
  take(path.at);
  prefetch_children(tree, 1, at, within(waiting));
  for (int l = 2; l <= tree.top; ++l) prefetch_children(tree, l, path.at >> (4 * l), within(path.waiting[l]));
  while (true) {
    if (next > (limit() | simd::lane_mask)) {
      if (++level > tree.top) return;
      at /= lanes;
      waiting = path.waiting[level];
      next = simd::smallest(waiting);
      continue;
    }
    const std::int32_t here = next;
    const int lane = here & simd::lane_mask;
    waiting = simd::replaced(waiting, here, nothing);
    next = simd::smallest(waiting);  // does not wait for what this child brings
    if (is_close(here, best)) [[unlikely]]
      if (!matters(tree.level(level)[at], q, lane, best)) continue;
    const std::size_t child = at * lanes + static_cast<std::size_t>(lane);
    if (level == 1) {
      if constexpr (!exact) {
        if (effort.leaves > 1)
          --effort.leaves;
        else if (!effort.fills || best.last_id() != no_id)
          return;
      }
      take(child);
      continue;
    }
    path.waiting[level--] = waiting;
    at = child;
    work.node();
    waiting = simd::tagged(distances(tree.level(level)[at], q));
    next = simd::smallest(waiting);
    prefetch_children(tree, level, at, within(waiting));
  }
}

// ---- all within a limit --------------------------------------------------------------------------------
//
// Order does not matter here, memory does: children are found and prefetched level by level, and visited when
// up to 64 of them wait, so that the latencies of all leaves overlap. Against going depth first, radius for
// about 30 neighbours at 1e6 points: 15 to 35 % less time.

/// Children of a node to visit and those wholly inside, as bits.
struct Classified {
  std::uint32_t visit = 0, inside = 0;
};

/// Calls leaf(number) for each leaf, and all(first, last) for each run of leaves below a child that
/// `classify` finds wholly inside. classify(node) gives Classified.
template <int D, class T, class Classify, class LeafFunction, class AllFunction, class W>
class Visit {
 public:
  Visit(const Tree<D, T>& tree, Classify& classify, LeafFunction& leaf, AllFunction& all, W& work)
      : tree_(tree), classify_(classify), leaf_(leaf), all_(all), work_(work) {}

  void run() {
    waiting_[tree_.top].push(0);
    drain(tree_.top);
  }

 private:
  /// Nodes (on level 0: leaves) found and not yet visited, and room for those of one more node.
  struct Queue {
    static constexpr int most = 64;
    std::uint32_t at[most + lanes];
    int count = 0;
    void push(std::size_t i) { at[count++] = static_cast<std::uint32_t>(i); }
  };

  void drain(int level) {
    Queue& here = waiting_[level];
    for (int i = 0; i < here.count; ++i) {
      work_.node();
      if (level == 0) {
        leaf_(std::size_t{here.at[i]});
      } else {
        enter(level, here.at[i]);
        if (waiting_[level - 1].count > Queue::most) drain(level - 1);
      }
    }
    here.count = 0;
    if (level > 0) drain(level - 1);
  }

  void enter(int level, std::size_t at) {
    const Classified c = classify_(tree_.level(level)[at]);
    for (std::uint32_t bits = c.inside; bits != 0; bits &= bits - 1) {
      const std::size_t child = at * lanes + static_cast<std::size_t>(std::countr_zero(bits));
      std::size_t size = 1;  // leaves of a full child
      for (int l = 1; l < level; ++l) size *= lanes;
      all_(child * size, std::min((child + 1) * size, tree_.leaves.size()));
    }
    const std::uint32_t met = c.visit & ~c.inside;
    prefetch_children(tree_, level, at, met);
    for (std::uint32_t bits = met; bits != 0; bits &= bits - 1)
      waiting_[level - 1].push(at * lanes + static_cast<std::size_t>(std::countr_zero(bits)));
  }

  const Tree<D, T>& tree_;
  Classify& classify_;
  LeafFunction& leaf_;
  AllFunction& all_;
  W& work_;
  Queue waiting_[max_levels + 1];
};
template <int D, class T, class Classify, class LeafFunction, class AllFunction, class W>
void visit(const Tree<D, T>& tree, Classify&& classify, LeafFunction&& leaf, AllFunction&& all, W& work) {
  Visit<D, T, Classify, LeafFunction, AllFunction, W>(tree, classify, leaf, all, work).run();
}

/// Children of a node that meet a closed box, and those that lie in it.
template <int D>
Classified classify(const Node<D>& node, const geometry::Box<float, D>& box) {
  Classified c{0xffff, 0xffff};
  for (int a = 0; a < D; ++a) {
    const Floats16 low = Floats16::load(node.low[a]), high = Floats16::load(node.high[a]);
    const Floats16 from = Floats16::broadcast(box.low[a]), to = Floats16::broadcast(box.high[a]);
    c.visit &= simd::bits_le(low, to) & simd::bits_le(from, high);
    c.inside &= simd::bits_le(from, low) & simd::bits_le(high, to);
  }
  return c;
}
/// Points of a leaf in a closed box; absent ones have coordinates no finite box reaches.
template <int D, class T>
std::uint32_t points_inside(const Leaf<D, T>& leaf, const geometry::Box<T, D>& box) {
  std::uint32_t in = 0xffff;
  for (int a = 0; a < D; ++a) {
    const auto x = Lanes<T>::load(leaf.x[a]);
    in &= simd::bits_le(Lanes<T>::broadcast(box.low[a]), x) &
          simd::bits_le(x, Lanes<T>::broadcast(box.high[a]));
  }
  return in;
}

/// Gathers items in a small buffer, so that a vector grows by runs and not one by one.
template <class Item>
class Appender {
 public:
  explicit Appender(std::vector<Item>& out) : out_(out) {}
  ~Appender() { flush(); }
  Appender(const Appender&) = delete;
  Appender& operator=(const Appender&) = delete;
  /// Room for 16 more; call taken(n) for those written.
  Item* room() {
    if (count_ + lanes > size) flush();
    return buffer_ + count_;
  }
  void taken(std::size_t n) { count_ += n; }

 private:
  static constexpr std::size_t size = 256;
  void flush() { out_.insert(out_.end(), buffer_, buffer_ + count_), count_ = 0; }
  std::vector<Item>& out_;
  std::size_t count_ = 0;
  Item buffer_[size];
};

}  // namespace treeline::accel::wide
