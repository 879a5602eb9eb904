// Builds the wide tree over points: halves by rank along the widest side of the points' box, until 16 are
// left.
//
// Each split finds its rank by sampling (Floyd and Rivest 1975): two bounds that almost surely enclose the
// wanted rank send nearly all points to their side in one pass without a branch, into the other of two
// buffers; only those between the bounds are selected among. Ranks are multiples of the size of a full
// subtree, so that all leaves and nodes but the last are full. Cost: O(n log n); about log2(n / 16) passes
// over the points. Ties are cut anywhere; a run of equal points is put in order of id, so that the lowest
// come first. The tree does not depend on the number of threads.
#pragma once

#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <bit>
#include <cstring>

#include "accel/batch.hpp"
#include "accel/bvh/wide_layout.hpp"
#include "accel/point_set.hpp"

namespace treeline::accel::wide {

template <int D>
class Builder {
 public:
  using Entry = PointEntry<float, D>;
  using Box = geometry::Box<float, D>;

  /// Reorders `entries`, whose coordinates are finite.
  Builder(std::span<Entry> entries, int threads) : here_(entries), threads_(threads) {}

  Tree<D> build() {
    Tree<D> tree(here_.size());
    if (here_.empty()) return tree;
    std::unique_ptr<Entry[]> other(new Entry[here_.size()]);
    there_ = other.get();
    tree_ = &tree;
    std::size_t unit = lanes;  // points below a child of the root
    for (int l = 1; l < tree.top; ++l) unit *= lanes;
    in_arena([&] { split({0, here_.size(), unit}, false); });
    for (int l = 1; l <= tree.top; ++l) fill_level(l);
    return tree;
  }

 private:
  static constexpr std::size_t parallel_size = 1 << 15;  // below, a task costs more than it brings
  static constexpr std::size_t small_size = 64;          // below, ranks are counted

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
    const Box box = box_of(from, r.size);
    if (r.size <= lanes || box.low == box.high) return write_leaves(r, from, box.low == box.high);
    Entry* const to = (swapped ? here_.data() : there_) + r.first;
    const std::size_t units = (r.size + r.unit - 1) / r.unit;
    const std::size_t left = r.unit * std::bit_floor(units - 1);
    partition(from, to, r.size, left, box.widest_axis());
    const Range parts[] = {{r.first, left, r.unit}, {r.first + left, r.size - left, r.unit}};
    if (threads_ > 1 && r.size >= parallel_size) {
      tbb::task_group group;
      group.run([&] { split(parts[0], !swapped); });
      group.run_and_wait([&] { split(parts[1], !swapped); });
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

  // ---- one split ------------------------------------------------------------------------------------

  /// Moves so that to[0 … left) are not above and to[left … n) not below each other along the axis. `from`
  /// is left in pieces.
  static void partition(Entry* from, Entry* to, std::size_t n, std::size_t left, int axis) {
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
    const auto less = [axis](const Entry& a, const Entry& b) { return a.point[axis] < b.point[axis]; };
    if (below < middle && middle < above && low < high) {
      const auto count = static_cast<std::size_t>(between - from),
                 rank = static_cast<std::size_t>(middle - below);
      if (count <= n / 2) return partition(from, below, count, rank, axis);
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
    std::fill(x + n, x + (n + 2 * lanes - 1) / (2 * lanes) * (2 * lanes), infinity);
    simd::Floats16 lowest = simd::Floats16::broadcast(infinity), highest = lowest;
    for (std::size_t i = 0; i < n; i += 2 * lanes) {
      const simd::Floats16 here[] = {simd::Floats16::load(x + i), simd::Floats16::load(x + i + lanes)};
      simd::Ints16 count[] = {simd::Ints16::broadcast(0), simd::Ints16::broadcast(0)};
      for (std::size_t j = 0; j < n; ++j) {
        const auto other = simd::Floats16::broadcast(x[j]);
        count[0] = simd::counted_le(count[0], other, here[0]);
        count[1] = simd::counted_le(count[1], other, here[1]);
      }
      for (int half = 0; half < 2; ++half) {
        lowest =
            simd::min(lowest, simd::chosen(count[half], static_cast<std::int32_t>(low), here[half], lowest));
        highest = simd::min(highest,
                            simd::chosen(count[half], static_cast<std::int32_t>(high), here[half], highest));
      }
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
      Leaf<D>& leaf = tree_->leaves[number];
      for (std::size_t j = 0; j < lanes; ++j) {
        for (int a = 0; a < D; ++a) leaf.x[a][j] = j < count ? from[i + j].point[a] : infinity;
        leaf.id[j] = j < count ? from[i + j].id : no_id;
      }
      if (tree_->top == 0) continue;
      Id first_id = no_id;
      for (std::size_t j = 0; j < count; ++j) first_id = std::min(first_id, leaf.id[j]);
      write_child(tree_->level(1), number, box_of(from + i, count), first_id);
    }
  }

  static void write_child(Node<D>* level, std::size_t number, const Box& box, Id first_id) {
    Node<D>& parent = level[number / lanes];
    const std::size_t lane = number % lanes;
    for (int a = 0; a < D; ++a) parent.low[a][lane] = box.low[a], parent.high[a][lane] = box.high[a];
    parent.first_id[lane] = first_id;
  }

  /// The boxes of a level from those of the level below, and the absent ones of its last node.
  void fill_level(int l) {
    const std::size_t below = tree_->size(l - 1);
    if (l > 1)
      for (std::size_t i = 0; i < below; ++i) {
        const Node<D>& node = tree_->level(l - 1)[i];
        Box box;
        Id first_id = no_id;
        for (std::size_t j = 0; j < lanes && i * lanes + j < tree_->size(l - 2); ++j) {
          for (int a = 0; a < D; ++a) {
            box.low[a] = std::min(box.low[a], node.low[a][j]);
            box.high[a] = std::max(box.high[a], node.high[a][j]);
          }
          first_id = std::min(first_id, node.first_id[j]);
        }
        write_child(tree_->level(l), i, box, first_id);
      }
    const float none = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = below; i < (below + lanes - 1) / lanes * lanes; ++i)
      write_child(tree_->level(l), i,
                  {geometry::Vec<float, D>::filled(none), geometry::Vec<float, D>::filled(none)}, no_id);
  }

  std::span<Entry> here_;
  Entry* there_ = nullptr;
  Tree<D>* tree_ = nullptr;
  int threads_;
};

}  // namespace treeline::accel::wide
