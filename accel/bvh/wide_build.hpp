// Builds the wide tree over points: splits by rank until 16 are left. Either in halves along the widest side
// of the points' box, or, slower to build, where the two boxes' perimeters times their points sum to least,
// as the surface area heuristic does for rays (MacDonald and Booth 1990); perimeters, since a ball meets a
// long box that has next to no area, too. Measured at 3e5 points, k = 8, leaves visited by rank and by
// perimeter: scanner sweep 4.0 and 3.0; from off the cloud clusters 14.0 and 12.1, threads 11.7 and 10.6, a
// surface 15.9 and 15.0; cube 5.6 and 5.5.
//
// Each split finds its rank by sampling (Floyd and Rivest 1975): two bounds that almost surely enclose the
// wanted rank send nearly all points to their side in one pass without a branch, into the other of two
// buffers; only those between the bounds are selected among. Ranks are multiples of the size of a full
// subtree, so that all leaves and nodes but the last are full. Cost: O(n log n); about log2(n / 16) passes
// over the points. Ties are cut anywhere; a run of equal points is put in order of id, so that the lowest
// come first. Points of more digits than float come rounded, from a source that tells ties apart and measures
// runs anew that float resolves badly. The tree does not depend on the number of threads.
#pragma once

#include <bit>
#include <cstring>

#include "accel/batch.hpp"
#include "accel/bvh/wide_layout.hpp"
#include "accel/point_set.hpp"

namespace treeline::accel::wide {

/// Where the builder's entries come from: here they are the points themselves. Elsewhere (wide_double.hpp)
/// they are rounded from points of more digits, which the source keeps.
template <int D>
struct OwnPoints {
  static constexpr bool rounded = false;
  const geometry::Vec<float, D>& point(const PointEntry<float, D>& e) const { return e.point; }
  Id id(const PointEntry<float, D>& e) const { return e.id; }
};

template <int D, class TreeType = Tree<D>, class Source = OwnPoints<D>>
class Builder {
 public:
  using Entry = PointEntry<float, D>;
  using Box = geometry::Box<float, D>;

  /// Reorders `entries`, whose coordinates are finite.
  Builder(std::span<Entry> entries, bool by_perimeter, int threads, Source source = {})
      : here_(entries), by_perimeter_(by_perimeter), threads_(threads), source_(source) {}

  void build(TreeType& tree) {
    if (here_.empty()) return;
    std::unique_ptr<Entry[]> other(new Entry[here_.size()]);
    there_ = other.get();
    tree_ = &tree;
    std::size_t unit = lanes;  // points below a child of the root
    for (int l = 1; l < tree.top; ++l) unit *= lanes;
    in_arena([&] { split({0, here_.size(), unit}, false); });
    for (int l = 1; l <= tree.top; ++l) fill_level(l);
  }

 private:
  static constexpr std::size_t parallel_size = 1 << 15;  // below, a task costs more than it brings
  static constexpr std::size_t small_size = 64;          // below, ranks are counted
  static constexpr std::size_t most_counted = 128;       // values whose ranks are counted at all

  struct Range {
    std::size_t first, size, unit;
  };

  template <class F>
  void in_arena(F&& f) {
    if (threads_ == 1) return f();
    tbb::task_arena arena(allowed_threads(threads_));
    arena.execute(f);
  }

  /// Splits until leaves are left. The range's points are in `there_` if swapped, else in `here_`.
  void split(Range r, bool swapped) {
    while (r.unit > lanes && r.size <= r.unit) r.unit /= lanes;
    Entry* const from = (swapped ? there_ : here_.data()) + r.first;
    Box box = box_of(from, r.size);
    if constexpr (Source::rounded)
      if (r.size > lanes && source_.vague(box)) box = source_.rebase(std::span(from, r.size));
    if (r.size <= lanes || box.low == box.high) return write_leaves(r, from, box.low == box.high);
    Entry* const to = (swapped ? here_.data() : there_) + r.first;
    const std::size_t units = (r.size + r.unit - 1) / r.unit;
    const auto [left, axis] = by_perimeter_ ? cut_by_perimeter(from, r, units)
                                            : Cut{r.unit * std::bit_floor(units - 1), box.widest_axis()};
    partition(from, to, r.size, left, axis);
    const Range parts[] = {{r.first, left, r.unit}, {r.first + left, r.size - left, r.unit}};
    if (threads_ > 1 && r.size >= parallel_size) {
      both([&] { split(parts[0], !swapped); }, [&] { split(parts[1], !swapped); });
    } else {
      split(parts[0], !swapped), split(parts[1], !swapped);
    }
  }

  static Box box_of(const Entry* e, std::size_t n) {
    Box box;
    std::size_t i = 0;
    if constexpr (sizeof(Entry) == 16) {
      // Four points a step, their ids among the lanes: what those hold as floats matters to no other.
      auto low = simd::Floats16::broadcast(infinity), high = simd::Floats16::broadcast(-infinity);
      for (; i + 4 <= n; i += 4) {
        const auto four = simd::Floats16::load(e[i].point.v);
        low = simd::min(four, low), high = simd::max(four, high);
      }
      alignas(64) float lows[lanes], highs[lanes];
      low.store(lows), high.store(highs);
      for (int j = 0; j < lanes; ++j)
        if (const int a = j % 4; a < D)
          box.low[a] = std::min(box.low[a], lows[j]), box.high[a] = std::max(box.high[a], highs[j]);
    }
    for (; i < n; ++i) box.grow(e[i].point);
    return box;
  }

  // ---- where to split -------------------------------------------------------------------------------

  struct Cut {
    std::size_t left;  // points
    int axis;
  };

  /// Tries every border between full subtrees along every axis, on a sample.
  static Cut cut_by_perimeter(const Entry* from, const Range& r, std::size_t units) {
    constexpr std::size_t most = 512;  // where there are many points, and few splits; else 64
    const std::size_t size = std::min<std::size_t>(r.size, r.size >= 16384 ? most : 64);
    Entry sample[most];
    for (std::size_t i = 0; i < size; ++i) sample[i] = from[i * r.size / size];
    Cut best{r.unit * std::bit_floor(units - 1), 0};
    double best_cost = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < D; ++axis) {
      alignas(64) float x[most];
      alignas(64) std::int32_t not_above[most];
      for (std::size_t i = 0; i < size; ++i) x[i] = sample[i].point[axis];
      count_not_above(x, size, not_above);
      Box boxes[lanes];                // of the sample's points in each subtree
      std::int32_t taken[most + 1]{};  // equal values take one rank each
      for (std::size_t i = 0; i < size; ++i) {
        const std::int32_t last = not_above[i], in_sample = last - 1 - taken[last]++;
        const std::size_t rank = static_cast<std::size_t>(in_sample) * r.size / size;
        boxes[rank / r.unit].grow(sample[i].point);
      }
      double right[lanes];  // perimeter of all from a subtree on
      Box sum;
      for (std::size_t u = units; u-- > 1;) sum.grow(boxes[u]), right[u] = perimeter(sum);
      sum = {};
      for (std::size_t u = 1; u < units; ++u) {
        sum.grow(boxes[u - 1]);
        const std::size_t left = u * r.unit;
        const double cost =
            perimeter(sum) * static_cast<double>(left) + right[u] * static_cast<double>(r.size - left);
        if (cost < best_cost) best_cost = cost, best = {left, axis};
      }
    }
    return best;
  }
  static double perimeter(const Box& box) {
    double sum = 0;
    if (!box.empty())
      for (int a = 0; a < D; ++a) sum += static_cast<double>(box.high[a]) - static_cast<double>(box.low[a]);
    return sum;
  }
  /// For each value how many are not above it. x and counts have room for a multiple of 32.
  static void count_not_above(float* x, std::size_t n, std::int32_t* counts) {
    std::fill(x + n, x + (n + 2 * lanes - 1) / (2 * lanes) * (2 * lanes), infinity);
    for (std::size_t i = 0; i < n; i += 2 * lanes) {
      const simd::Floats16 here[] = {simd::Floats16::load(x + i), simd::Floats16::load(x + i + lanes)};
      simd::Ints16 count[] = {simd::Ints16::broadcast(0), simd::Ints16::broadcast(0)};
      for (std::size_t j = 0; j < n; ++j) {
        const auto other = simd::Floats16::broadcast(x[j]);
        count[0] = simd::counted_le(count[0], other, here[0]);
        count[1] = simd::counted_le(count[1], other, here[1]);
      }
      count[0].store(counts + i), count[1].store(counts + i + lanes);
    }
  }

  // ---- one split ------------------------------------------------------------------------------------

  /// Moves so that to[0 … left) are not above and to[left … n) not below each other along the axis. `from`
  /// is left in pieces.
  void partition(Entry* from, Entry* to, std::size_t n, std::size_t left, int axis) const {
    const auto [low, high] =
        n <= small_size ? value_of_rank(from, n, left, axis) : bounds_of_rank(from, n, left, axis);
    // Each point is written to all three ends, and the end that it belongs to moves on. Together they have
    // taken fewer than n, so the ends in `to` do not meet; those between gather where `from` has been read.
    Entry *below = to, *above = to + n, *between = from;
    std::size_t i = 0;
#if TREELINE_SIMD == 512
    if constexpr (sizeof(Entry) == 16) i = deal_by_four(from, n, axis, low, high, below, above, between);
#endif
    for (; i < n; ++i) {
      const Entry e = from[i];
      const bool is_below = e.point[axis]<low, is_above = e.point[axis]> high;
      *below = e, below += is_below;
      above[-1] = e, above -= is_above;
      *between = e, between += !(is_below | is_above);
    }
    Entry* const middle = to + left;
    const auto less = [this, axis](const Entry& a, const Entry& b) {
      if constexpr (Source::rounded)
        if (a.point[axis] == b.point[axis]) return source_.less(a, b, axis);
      return a.point[axis] < b.point[axis];
    };
    if (below < middle && middle < above && (low < high || Source::rounded)) {
      const auto count = static_cast<std::size_t>(between - from),
                 rank = static_cast<std::size_t>(middle - below);
      if (low < high && count <= n / 2) return partition(from, below, count, rank, axis);
      std::nth_element(from, from + rank, between, less);  // many of few values, which no sample tells apart
    }
    std::copy(from, between, below);
    if (middle < below)  // the sample misled
      std::nth_element(to, middle, below, less);
    else if (middle > above)
      std::nth_element(above, middle, to + n, less);
  }

#if TREELINE_SIMD == 512
  /// The same for four points a step; returns how many have been dealt.
  static std::size_t deal_by_four(Entry* from, std::size_t n, int axis, float low, float high, Entry*& below,
                                  Entry*& above, Entry*& between) {
    const __m512i keys = _mm512_add_epi32(
        _mm512_set1_epi32(axis), _mm512_setr_epi32(0, 4, 8, 12, 0, 4, 8, 12, 0, 4, 8, 12, 0, 4, 8, 12));
    const __m128 lows = _mm_set1_ps(low), highs = _mm_set1_ps(high);
    const auto words = [](std::uint32_t points) {
      return static_cast<__mmask16>(_pdep_u32(points, 0x1111) * 0xf);
    };
    std::size_t i = 0;
    for (; i + 4 <= n; i += 4) {
      const __m512i four = _mm512_loadu_si512(from + i);
      const __m128 x = _mm512_maskz_extractf32x4_ps(
          simd::all8, _mm512_maskz_permutexvar_ps(simd::all16, keys, _mm512_castsi512_ps(four)), 0);
      const std::uint32_t is_below = _mm_cmp_ps_mask(x, lows, _CMP_LT_OQ),
                          is_above = _mm_cmp_ps_mask(x, highs, _CMP_GT_OQ);
      const std::uint32_t is_between = ~(is_below | is_above) & 0xfu;
      _mm512_storeu_si512(below, _mm512_maskz_compress_epi32(words(is_below), four));
      below += std::popcount(is_below);
      const int count = std::popcount(is_above);
      above -= count;
      _mm512_mask_storeu_epi32(above, static_cast<__mmask16>((1u << 4 * count) - 1),
                               _mm512_maskz_compress_epi32(words(is_above), four));
      _mm512_storeu_si512(between, _mm512_maskz_compress_epi32(words(is_between), four));
      between += std::popcount(is_between);
    }
    return i;
  }
#endif

  struct Bounds {
    float low, high;
  };

  static Bounds value_of_rank(const Entry* from, std::size_t n, std::size_t rank, int axis) {
    alignas(64) float x[small_size];
    for (std::size_t i = 0; i < n; ++i) x[i] = from[i].point[axis];
    return values_of_ranks(x, n, rank, rank);
  }

  /// By counting for each value how many are not above it: quadratic, and the fastest for few. x has room for
  /// a multiple of 32.
  static Bounds values_of_ranks(float* x, std::size_t n, std::size_t low, std::size_t high) {
    alignas(64) std::int32_t counts[most_counted];
    count_not_above(x, n, counts);
    simd::Floats16 lowest = simd::Floats16::broadcast(infinity), highest = lowest;
    for (std::size_t i = 0; i < n; i += lanes) {
      const auto here = simd::Floats16::load(x + i);
      const auto count = simd::Ints16::load(counts + i);
      lowest = simd::min(lowest, simd::chosen(count, static_cast<std::int32_t>(low), here, lowest));
      highest = simd::min(highest, simd::chosen(count, static_cast<std::int32_t>(high), here, highest));
    }
    return {simd::smallest(lowest), simd::smallest(highest)};
  }

  /// From a sample: 2.5 standard deviations of the rank to either side.
  static Bounds bounds_of_rank(const Entry* from, std::size_t n, std::size_t rank, int axis) {
    constexpr std::size_t most = 1024;
    alignas(64) float x[most];
    const std::size_t size = n >= 32768 ? most : n >= 2048 ? 128 : n >= 256 ? 64 : 32, step = n / size;
    for (std::size_t i = 0; i < size; ++i) x[i] = from[i * step].point[axis];
    const double share = static_cast<double>(rank) / static_cast<double>(n),
                 count = static_cast<double>(size);
    const double margin = 2.5 * std::sqrt(count * share * (1 - share)) + 1;
    const double low = share * count - margin, high = share * count + margin;
    const auto at = [&](double r) { return static_cast<std::size_t>(std::clamp(r, 0.0, count - 1)); };
    Bounds bounds;
    if (size < most) {
      bounds = values_of_ranks(x, size, at(low), at(high));
    } else {
      std::nth_element(x, x + at(high), x + size);
      bounds.high = x[at(high)];
      std::nth_element(x, x + at(low), x + at(high));
      bounds.low = x[at(low)];
    }
    if (low < 0) bounds.low = -infinity;
    if (high >= count) bounds.high = infinity;
    return bounds;
  }

  // ---- leaves and nodes -----------------------------------------------------------------------------

  /// One leaf, or a run of them whose points are all equal.
  void write_leaves(const Range& r, Entry* from, bool coincident) {
    if (coincident && r.size > lanes)
      std::sort(from, from + r.size, [](const Entry& a, const Entry& b) { return a.id < b.id; });
    for (std::size_t i = 0; i < r.size; i += lanes) {
      const std::size_t number = (r.first + i) / lanes, count = std::min<std::size_t>(r.size - i, lanes);
      auto& leaf = tree_->leaves[number];
      typename TreeType::Box box;
      for (std::size_t j = 0; j < lanes; ++j) {
        if (j < count) {
          const auto& p = source_.point(from[i + j]);
          if constexpr (Source::rounded) box.grow(p);
          for (int a = 0; a < D; ++a) leaf.x[a][j] = p[a];
        } else {
          for (int a = 0; a < D; ++a) leaf.x[a][j] = infinity;
        }
        leaf.id[j] = j < count ? source_.id(from[i + j]) : no_id;
      }
      if (tree_->top == 0) continue;
      if constexpr (!Source::rounded) box = box_of(from + i, count);
      set_child(*tree_, 1, number, box, *std::min_element(leaf.id, leaf.id + count));
    }
  }

  /// The boxes of a level from those of the level below, and the absent ones of its last node.
  void fill_level(int l) {
    using TreeBox = typename TreeType::Box;
    const std::size_t below = tree_->size(l - 1);
    if (l > 1)
      for (std::size_t i = 0; i < below; ++i) {
        TreeBox box;
        Id first_id = no_id;
        const std::size_t last = std::min((i + 1) * lanes, tree_->size(l - 2));
        for (std::size_t j = i * lanes; j < last; ++j) {
          box.grow(child_box(*tree_, l - 1, j));
          first_id = std::min(first_id, tree_->level(l - 1)[i].first_id[j % lanes]);
        }
        set_child(*tree_, l, i, box, first_id);
      }
    TreeBox none;
    none.low = none.high = decltype(none.low)::filled(std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = below; i < (below + lanes - 1) / lanes * lanes; ++i)
      set_child(*tree_, l, i, none, no_id);
  }

  std::span<Entry> here_;
  Entry* there_ = nullptr;
  TreeType* tree_ = nullptr;
  bool by_perimeter_;
  int threads_;
  [[no_unique_address]] Source source_;
};

}  // namespace treeline::accel::wide
