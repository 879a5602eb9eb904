// The default builder over triangles: binned surface area heuristic (Wald 2007, "On fast construction of
// SAH-based bounding volume hierarchies"), counted in leaf blocks.
//
// Each node tries the planes between bins of centroids along all three axes; a side of n triangles costs its
// area times ceil(n / block), since a leaf tests `block` triangles at once. As Embree does, nodes with few
// triangles get few bins, and boxes are kept with negated high corners so that one minimum grows them.
// Centroids that coincide, areas that overflow and nodes near the depth limit are split by rank in half, so
// that depth is bounded whatever the input. Cost: O(n log n), about 20 cycles a triangle and level. Large
// subtrees are built side by side; the tree does not depend on the number of threads. Known weakness: boxes
// of long thin triangles that are not axis-parallel (see build_spatial.hpp).
#pragma once

#include <algorithm>
#include <bit>
#include <memory>
#include <span>
#include <string>

#include "accel/batch.hpp"
#include "accel/bvh/binary_cost.hpp"
#include "accel/bvh/radix_sort.hpp"
#include "accel/bvh/wide_layout.hpp"
#include "accel/simd/lanes8.hpp"
#include "geometry/triangle.hpp"

namespace treeline::accel {

class BinnedBuilder {
 public:
  /// Finite triangles with an area.
  BinnedBuilder(std::span<const geometry::Triangle<float>> triangles, const BinaryBuildOptions& options)
      : options_(options),
        shift_(std::countr_zero(static_cast<unsigned>(options.block))),
        prims_(triangles.size()) {
    check(options, triangles.size());
    if (!std::has_single_bit(static_cast<unsigned>(options.block)))
      throw InvalidInput("block is " + std::to_string(options.block) + "; it must be a power of two");
    parallel_ranges(triangles.size(), options.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) prims_[i] = prim_of(triangles[i], i);
    });
  }

  BinaryTree build() {
    BinaryTree tree;
    const std::size_t n = prims_.size();
    if (n == 0) return tree;
    Bounds all;
    for (std::size_t i = 0; i < n; ++i) all.grow(prims_[i]);
    Piece whole;
    const auto all_of_it = [&] { whole = subtree({0, n, all, 0}); };
    if (options_.threads == 1) {
      all_of_it();
    } else {
      tbb::task_arena arena(allowed_threads(options_.threads));
      arena.execute(all_of_it);
    }
    tree.nodes.reserve(count(whole));
    tree.nodes.resize(1);
    assemble(whole, 0, tree.nodes);
    tree.references.resize(n);
    for (std::size_t i = 0; i < n; ++i) tree.references[i] = prims_[i].index();
    return tree;
  }

 private:
  using F4 = simd::Floats4;
  using F8 = simd::Floats8;
  using Nodes = std::vector<BinaryNode>;
  static constexpr std::size_t task_size = 1 << 14;  // larger nodes hand their children out as tasks
  static constexpr int most_bins = 32;
  static constexpr std::size_t most_swept = 32;  // of so few triangles every split is tried

  /// Low corner, negated high corner; between them the triangle's number and nothing. The number is biased so
  /// that as a float it lies between 1 and the largest: arithmetic on four lanes takes it along, and were it
  /// denormal, as small numbers are, each operation on it would take many times as long. (Measured on Zen 5:
  /// building over 1e6 triangles of a terrain 185 ms without the bias, 108 ms with it.)
  struct alignas(32) Prim {
    float low[3];
    std::uint32_t biased_index;
    float negated_high[3];
    std::uint32_t unused;

    static constexpr std::uint32_t bias = 0x3f800000;  // 1; the largest index, 2^30 - 2, stays finite
    static_assert(bias + (1u << 30) - 1 == 0x7f7fffff, "the largest float");
    std::uint32_t index() const { return biased_index - bias; }

    F8 box() const { return F8::load(low); }
    /// Twice the centre; the lane to spare holds something.
    F4 centre2() const { return box().low() - box().high(); }
    float centre2(int axis) const { return low[axis] - negated_high[axis]; }
  };
  static F8 nothing() { return F8::broadcast(wide::infinity); }

  /// A box, and the box of centres (twice them), both negated above.
  struct Bounds {
    F8 box = nothing(), centres = box;

    void grow(const Prim& p) {
      box = min(p.box(), box);
      centres = min(both_ways(p.centre2()), centres);
    }
  };
  static F8 both_ways(F4 c) { return F8::joined(c, F4::broadcast(0) - c); }

  struct Range {
    std::size_t begin, end;
    Bounds bounds;
    std::size_t level;
    std::size_t size() const { return end - begin; }
  };
  struct Split {
    float cost = wide::infinity;  // half the area times the blocks
    int axis = -1, bin = 0;
  };
  struct Ranks {
    std::uint8_t of[3][most_swept];  // along each axis
  };
  /// Which bin a centre falls into along each axis, by the same arithmetic wherever asked.
  struct Binning {
    float low[4], scale[4]{};
    int bins;
    bool usable[3];

    Binning(const Bounds& b, int count) : bins(count) {
      float high[4];
      b.centres.low().store(low), b.centres.high().store(high);
      for (int k = 0; k < 3; ++k) {
        scale[k] = 0.999f * static_cast<float>(count) / (-high[k] - low[k]);  // never the bin behind the last
        usable[k] = scale[k] < wide::infinity && scale[k] > 0;
        if (!usable[k]) scale[k] = 0;
      }
    }
    static void of(const Prim& p, F4 low, F4 scale, std::int32_t (&bin)[4]) {
      ((p.centre2() - low) * scale).store_truncated(bin);
    }
  };
  struct Bins {
    struct alignas(32) Box {
      float side[8];
    };
    Box box[most_bins][3];
    std::uint32_t count[most_bins][4];

    explicit Bins(int bins) {
      for (int i = 0; i < bins; ++i)
        for (int k = 0; k < 3; ++k) nothing().store(box[i][k].side), count[i][k] = 0;
    }
    F8 at(int i, int k) const { return F8::load(box[i][k].side); }
    void add(const Prim& p, const std::int32_t (&bin)[4]) {
      const F8 b = p.box();
      for (int k = 0; k < 3; ++k) {
        float* const side = box[bin[k]][k].side;
        min(b, F8::load(side)).store(side);
        ++count[bin[k]][k];
      }
    }
    void add(const Bins& other, int bins) {
      for (int i = 0; i < bins; ++i)
        for (int k = 0; k < 3; ++k)
          min(at(i, k), other.at(i, k)).store(box[i][k].side), count[i][k] += other.count[i][k];
    }
  };

  static Prim prim_of(const geometry::Triangle<float>& t, std::size_t i) {
    Prim p;
    for (int k = 0; k < 3; ++k) {
      p.low[k] = std::min(std::min(t.a[k], t.b[k]), t.c[k]);
      p.negated_high[k] = -std::max(std::max(t.a[k], t.b[k]), t.c[k]);
    }
    p.biased_index = static_cast<std::uint32_t>(i) + Prim::bias, p.unused = 0;
    return p;
  }
  static float half_area(F8 box) {
    const F4 extent = box.low() + box.high();  // negated, which products of two undo
    return (extent * extent.rotated()).sum_of_three();
  }
  static geometry::Box<float, 3> box_of(const Bounds& b) {
    float low[4], high[4];
    b.box.low().store(low), b.box.high().store(high);
    return {{low[0], low[1], low[2]}, {-high[0], -high[1], -high[2]}};
  }
  float blocks(std::size_t n) const {
    return static_cast<float>(static_cast<std::int64_t>((n + (std::size_t{1} << shift_) - 1) >> shift_));
  }

  // ---- recursion ------------------------------------------------------------------------------------

  /// A subtree under construction: its nodes, the root first, or the root alone and what is below it.
  struct Piece {
    Nodes nodes;
    std::unique_ptr<Piece> below[2];
  };

  Piece subtree(const Range& range) {
    Piece piece;
    if (range.size() < task_size) {
      piece.nodes.reserve(range.size() / 2);
      piece.nodes.emplace_back();
      build(range, piece.nodes, 0);
      return piece;
    }
    Range parts[2];
    if (!split(range, parts)) return piece.nodes = {leaf(range)}, std::move(piece);
    piece.nodes = {{box_of(range.bounds), 0, 0}};
    const auto go = [&](int side) { piece.below[side] = std::make_unique<Piece>(subtree(parts[side])); };
    if (options_.threads > 1) {
      both([&] { go(0); }, [&] { go(1); });
    } else {
      go(0), go(1);
    }
    return piece;
  }

  /// Puts the nodes of all pieces behind each other, in an order that does not depend on who was faster.
  static void assemble(const Piece& piece, std::size_t at, Nodes& nodes) {
    if (!piece.below[0]) {
      const std::size_t base = nodes.size() - 1;  // of all but the root, which has its place
      nodes.insert(nodes.end(), piece.nodes.begin() + 1, piece.nodes.end());
      nodes[at] = piece.nodes[0];
      const auto moved = [base](BinaryNode& node) {
        if (node.count == 0) node.first += static_cast<std::uint32_t>(base);
      };
      moved(nodes[at]);
      std::for_each(nodes.begin() + static_cast<std::ptrdiff_t>(base) + 1, nodes.end(), moved);
      return;
    }
    const std::size_t first = nodes.size();
    nodes[at] = {piece.nodes[0].box, static_cast<std::uint32_t>(first), 0};
    nodes.resize(first + 2);
    assemble(*piece.below[0], first, nodes), assemble(*piece.below[1], first + 1, nodes);
  }
  static std::size_t count(const Piece& piece) {
    return piece.nodes.size() + (piece.below[0] ? count(*piece.below[0]) + count(*piece.below[1]) : 0);
  }

  void build(const Range& range, Nodes& nodes, std::size_t at) {
    Range parts[2];
    if (!split(range, parts)) return static_cast<void>(nodes[at] = leaf(range));
    const std::size_t first = nodes.size();
    nodes.resize(first + 2);
    nodes[at] = {box_of(range.bounds), static_cast<std::uint32_t>(first), 0};
    build(parts[0], nodes, first), build(parts[1], nodes, first + 1);
  }

  static BinaryNode leaf(const Range& r) {
    return {box_of(r.bounds), static_cast<std::uint32_t>(r.begin), static_cast<std::uint32_t>(r.size())};
  }

  // ---- one split ------------------------------------------------------------------------------------

  /// False for a leaf.
  bool split(const Range& range, Range (&parts)[2]) {
    const std::size_t n = range.size();
    const auto largest_leaf = static_cast<std::size_t>(options_.largest_leaf);
    if (n == 1 || (n <= largest_leaf && n <= std::size_t{1} << shift_)) return false;
    parts[0].level = parts[1].level = range.level + 1;
    const auto levels_by_rank = static_cast<std::size_t>(std::bit_width(n - 1));
    const bool may_be_uneven = range.level + levels_by_rank < binary_max_depth;
    if (may_be_uneven && n <= most_swept) {
      Ranks ranks;
      const Split best = swept(range, ranks);
      if (n <= largest_leaf && !pays(best, range)) return false;
      if (best.axis >= 0) return part(range, ranks, best, parts), true;
    } else if (may_be_uneven) {
      const int count = static_cast<int>(std::min<std::size_t>(most_bins, 12 + n / 16));
      const Binning binning(range.bounds, count);
      Bins bins(count);
      fill(range, binning, bins);
      const Split best = cheapest(bins, binning);
      if (n <= largest_leaf && !pays(best, range)) return false;
      if (best.axis >= 0) return partition(range, binning, bins, best, parts), true;
    }
    if (n <= largest_leaf) return false;
    by_rank(range, parts);
    return true;
  }

  /// Whether a split is cheaper than a leaf.
  bool pays(const Split& split, const Range& range) const {
    const float area = half_area(range.bounds.box);
    return split.cost + simd::opaque(static_cast<float>(options_.node_cost) * area) <
           blocks(range.size()) * area;
  }

  /// All splits by rank along each axis: the bin of the split is how many go to the left.
  Split swept(const Range& range, Ranks& ranks) const {
    const std::size_t n = range.size();
    const Prim* const prims = prims_.data() + range.begin;
    Split best;
    for (int k = 0; k < 3; ++k) {
      // Centres that differ in their last bits only are ordered by place.
      alignas(64) std::int32_t key[most_swept];
      for (std::size_t i = 0; i < most_swept; ++i) key[i] = std::numeric_limits<std::int32_t>::max();
      for (std::size_t i = 0; i < n; ++i)
        key[i] = std::bit_cast<std::int32_t>(
            ((sortable(prims[i].centre2(k)) ^ 0x80000000u) & ~static_cast<std::uint32_t>(most_swept - 1)) |
            static_cast<std::uint32_t>(i));
      std::uint8_t order[most_swept];
      for (std::size_t i = 0; i < n; ++i) {
        std::int32_t rank = 0;
        for (std::size_t j = 0; j < most_swept; ++j) rank += key[j] < key[i];
        ranks.of[k][i] = static_cast<std::uint8_t>(rank), order[rank] = static_cast<std::uint8_t>(i);
      }
      float right[most_swept];
      F8 box = nothing();
      for (std::size_t i = n - 1; i > 0; --i) {
        box = min(prims[order[i]].box(), box);
        right[i] = half_area(box) * blocks(n - i);
      }
      box = nothing();
      for (std::size_t i = 1; i < n; ++i) {
        box = min(prims[order[i - 1]].box(), box);
        const float cost = simd::opaque(half_area(box) * blocks(i)) + right[i];
        if (cost < best.cost) best = {cost, k, static_cast<int>(i)};
      }
    }
    return best;
  }
  void part(const Range& range, const Ranks& ranks, const Split& best, Range (&parts)[2]) {
    const std::size_t n = range.size(), middle = range.begin + static_cast<std::size_t>(best.bin);
    Prim copy[most_swept];
    std::copy_n(prims_.data() + range.begin, n, copy);
    std::size_t to[2] = {range.begin, middle};
    for (int side = 0; side < 2; ++side) parts[side].bounds = {};
    for (std::size_t i = 0; i < n; ++i) {
      const bool is_right = ranks.of[best.axis][i] >= best.bin;
      prims_[to[is_right]++] = copy[i];
      parts[is_right].bounds.grow(copy[i]);
    }
    divide(range, middle, parts);
  }

  void fill(const Range& range, const Binning& binning, Bins& bins) const {
    const F4 low = F4::load(binning.low), scale = F4::load(binning.scale);
    std::int32_t bin[4];
    std::size_t i = range.begin;
    if (range.size() >= 256) {
      // Two sets by turns, so that neighbours that fall into one bin need not wait for each other.
      Bins others(binning.bins);
      std::int32_t other[4];
      for (; i + 1 < range.end; i += 2) {
        Binning::of(prims_[i], low, scale, bin), Binning::of(prims_[i + 1], low, scale, other);
        bins.add(prims_[i], bin), others.add(prims_[i + 1], other);
      }
      bins.add(others, binning.bins);
    }
    for (; i < range.end; ++i) Binning::of(prims_[i], low, scale, bin), bins.add(prims_[i], bin);
  }

  Split cheapest(const Bins& bins, const Binning& binning) const {
    const int last = binning.bins - 1;
    float right_cost[most_bins][3];
    F8 sum[3];
    std::size_t count[3];
    for (int k = 0; k < 3; ++k) sum[k] = bins.at(last, k), count[k] = bins.count[last][k];
    for (int i = last;; --i) {
      for (int k = 0; k < 3; ++k) right_cost[i][k] = half_area(sum[k]) * blocks(count[k]);
      if (i == 1) break;
      for (int k = 0; k < 3; ++k) sum[k] = min(bins.at(i - 1, k), sum[k]), count[k] += bins.count[i - 1][k];
    }
    Split best[3];
    for (int k = 0; k < 3; ++k) sum[k] = bins.at(0, k), count[k] = bins.count[0][k];
    for (int i = 1; i <= last; ++i)
      for (int k = 0; k < 3; ++k) {
        // An empty side costs infinity times zero, which is not less than anything.
        const float cost = simd::opaque(half_area(sum[k]) * blocks(count[k])) + right_cost[i][k];
        if (cost < best[k].cost) best[k] = {cost, k, i};
        sum[k] = min(bins.at(i, k), sum[k]), count[k] += bins.count[i][k];
      }
    Split cheapest;
    for (int k = 0; k < 3; ++k)
      if (binning.usable[k] && best[k].cost < cheapest.cost) cheapest = best[k];
    return cheapest;
  }

  void partition(const Range& range, const Binning& binning, const Bins& bins, const Split& best,
                 Range (&parts)[2]) {
    const int axis = best.axis;
    Bounds bounds[2];
    for (int i = 0; i < binning.bins; ++i) {
      F8& box = bounds[i >= best.bin].box;
      box = min(bins.at(i, axis), box);
    }
    alignas(32) static constexpr float exclude[2][8] = {
        {},
        {wide::infinity, wide::infinity, wide::infinity, wide::infinity, wide::infinity, wide::infinity,
         wide::infinity, wide::infinity}};
    const float low = binning.low[axis], scale = binning.scale[axis];
    F8 left = nothing(), right = nothing();  // centres
    std::size_t middle = range.begin;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const Prim p = prims_[i];
      const bool is_right = static_cast<std::int32_t>((p.centre2(axis) - low) * scale) >= best.bin;
      const F8 centres = both_ways(p.centre2());
      left = min(centres + F8::load(exclude[is_right]), left);
      right = min(centres + F8::load(exclude[!is_right]), right);
      // Without a branch: what stands at the border is moved here, and p there; the border moves on or not.
      prims_[i] = prims_[middle];
      prims_[middle] = p;
      middle += !is_right;
    }
    bounds[0].centres = left, bounds[1].centres = right;
    for (int side = 0; side < 2; ++side) parts[side].bounds = bounds[side];
    divide(range, middle, parts);
  }

  void by_rank(const Range& range, Range (&parts)[2]) {
    const std::size_t middle = range.begin + range.size() / 2;
    float low[4], high[4];
    range.bounds.centres.low().store(low), range.bounds.centres.high().store(high);
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (-high[k] - low[k] > -high[axis] - low[axis]) axis = k;
    std::nth_element(prims_.data() + range.begin, prims_.data() + middle, prims_.data() + range.end,
                     [axis](const Prim& a, const Prim& b) {
                       const float ca = a.centre2(axis), cb = b.centre2(axis);
                       return ca < cb || (ca == cb && a.biased_index < b.biased_index);
                     });
    for (int side = 0; side < 2; ++side) parts[side].bounds = {};
    for (std::size_t i = range.begin; i < range.end; ++i) parts[i >= middle].bounds.grow(prims_[i]);
    divide(range, middle, parts);
  }

  static void divide(const Range& range, std::size_t middle, Range (&parts)[2]) {
    parts[0].begin = range.begin, parts[0].end = parts[1].begin = middle, parts[1].end = range.end;
  }

  BinaryBuildOptions options_;
  int shift_;
  wide::AlignedArray<Prim> prims_;
};

inline BinaryTree build_binned(std::span<const geometry::Triangle<float>> triangles,
                               const BinaryBuildOptions& options = {}) {
  return BinnedBuilder(triangles, options).build();
}

}  // namespace treeline::accel
