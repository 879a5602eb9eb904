// Builds a binary tree over triangles from the leaves up, fast: parallel locally-ordered clustering (Meister
// and Bittner 2018).
//
// Triangles are sorted along a Morton curve (21 bits an axis). Then, round by round, each cluster finds among
// its neighbours in that order the one with which it has the smallest box, and those that find each other
// become one; about 0.7 of the clusters are left after a round. At last, subtrees that are cheaper as a leaf
// become one. Sixteen neighbours are compared at once, and all that a comparison leaves is one integer: the
// box's area, and in its last five bits a number that no two pairs of one cluster share and that both see
// alike, so that ties cannot keep clusters apart. Cost: O(n) to sort and some 2.5 n comparisons of sixteen;
// a round that merges too few is followed by one that merges neighbours as they come, so that no order of
// sizes makes it quadratic. Known weakness: trees cost some 15 % more than those of a full sweep, more
// where large triangles lie among small ones, and leaves are less full.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "accel/bvh/binary_order.hpp"
#include "accel/bvh/radix_sort.hpp"
#include "accel/simd/lanes16.hpp"

namespace treeline::accel {

struct PlocBuildOptions : BinaryBuildOptions {
  int radius = 16;  ///< neighbours to either side among which a cluster looks; 16 at most
};

class PlocBuilder {
 public:
  /// The triangles are finite.
  PlocBuilder(std::span<const geometry::Triangle<float>> triangles, const PlocBuildOptions& options)
      : triangles_(triangles), options_(options), tasks_(options.threads) {
    check(options, triangles.size());
    if (options.radius < 1 || options.radius > simd::lanes)
      throw InvalidInput("radius is " + std::to_string(options.radius) + "; it must be in [1, " +
                         std::to_string(simd::lanes) + "]");
    fill_codes();
  }

  BinaryTree build() {
    const std::size_t n = triangles_.size();
    if (n == 0) return {};
    nodes_ = std::make_unique_for_overwrite<LinkedNode[]>(2 * n);
    below_ = std::make_unique_for_overwrite<Below[]>(2 * n);
    best_ = std::make_unique_for_overwrite<std::int32_t[]>(n + 2 * simd::lanes);
    tasks_.run([&] {
      sort();
      bool stalled = false;
      while (now_.size > 1) {
        find_partners(stalled);
        const std::size_t before = now_.size;
        merge_pairs();
        stalled = before > least_stalled && before - now_.size < before / 16;
      }
    });
    const auto root = static_cast<std::uint32_t>(made_ - 1);
    return ordered(
        nodes_.get(), root, 2 * n, n, [&](std::uint32_t i) { return below_[i].closed; },
        [&](std::size_t i) { return order_[i].value; });
  }

 private:
  using Key = SortItem<std::uint64_t>;
  static constexpr std::size_t least_stalled = 64;  // clusters; fewer may merge one by one
  static constexpr std::int32_t code_mask = 31, none = 0x7fffffff;

  /// What lies below a node.
  struct Below {
    float cost;  // times half the area, scaled
    std::uint32_t count;
    bool closed;
  };
  /// Side by side: corners of boxes, the low ones negated, and the nodes.
  struct Clusters {
    std::array<std::unique_ptr<float[]>, 6> side;
    std::unique_ptr<std::uint32_t[]> node;
    std::size_t size = 0;

    void allocate(std::size_t n) {
      for (auto& s : side) s = std::make_unique<float[]>(n + simd::lanes);
      node = std::make_unique_for_overwrite<std::uint32_t[]>(n);
    }
    void set(std::size_t i, const LinkedNode& box, std::uint32_t number) {
      for (int k = 0; k < 3; ++k) side[k][i] = box.v[k], side[3 + k][i] = box.v[4 + k];
      node[i] = number;
    }
  };

  // ---- the order --------------------------------------------------------------------------------------

  static std::uint64_t spread(std::uint64_t x) {  // two zeros after each of 21 bits
    x = (x | x << 32) & 0x001f00000000ffff;
    x = (x | x << 16) & 0x001f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
  }

  void sort() {
    const std::size_t n = triangles_.size();
    std::vector<simd::BoxLanes> ranges((n + BuildTasks::piece - 1) / BuildTasks::piece);
    const auto refs = std::make_unique_for_overwrite<simd::BoxLanes[]>(n);
    auto box = simd::PackedBox::empty();
    tasks_.pieces(n, [&](std::size_t begin, std::size_t end) {
      auto mine = simd::PackedBox::empty();
      for (std::size_t i = begin; i < end; ++i) {
        refs[i] = simd::packed(triangles_[i].box());
        mine = merged(mine, simd::PackedBox::load(refs[i]));
      }
      mine.store(ranges[begin / BuildTasks::piece]);
    });
    for (const auto& range : ranges) box = merged(box, simd::PackedBox::load(range));
    const simd::BoxLanes whole = box.lanes();
    scale_ = area_scale(whole);
    double widest = 0;  // of the doubled centres, as they are used here
    for (int a = 0; a < 3; ++a) widest = std::max(widest, 2 * (double(whole.high(a)) - double(whole.low(a))));
    const double cells = widest > 0 ? 2097151 / widest : 0;
    order_.resize(n);
    tasks_.pieces(n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        std::uint64_t code = 0;
        for (int a = 0; a < 3; ++a) {
          const double sum = double(refs[i].low(a)) + double(refs[i].high(a)) - 2 * double(whole.low(a));
          code |= spread(static_cast<std::uint64_t>(sum * cells)) << a;
        }
        order_[i] = {code, static_cast<std::uint32_t>(i)};
      }
    });
    radix_sort(order_, tasks_);
    now_.allocate(n), next_.allocate(n);
    now_.size = made_ = n;
    tasks_.pieces(n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        nodes_[i] = refs[order_[i].value];
        now_.set(i, nodes_[i], static_cast<std::uint32_t>(i));
        make_leaf(nodes_[i], i, 1);
        below_[i] = {simd::PackedBox::load(nodes_[i]).half_area(scale_), 1, 0};
      }
    });
  }

  // ---- a round ----------------------------------------------------------------------------------------

  /// The number of the pair (i, i + d): 2 (d - 1), and one bit of i that i + d has not: the lowest that is
  /// set in d.
  static std::int32_t code(std::size_t i, int d) {
    return 2 * (d - 1) + static_cast<std::int32_t>(i >> std::countr_zero(static_cast<unsigned>(d)) & 1);
  }
  void fill_codes() {
    for (std::size_t i = 0; i < 32; ++i)
      for (int d = 1; d <= simd::lanes; ++d) codes_[i][d - 1] = code(i, d);
    for (int i = 0; i < simd::lanes; ++i) absent_[i] = 0, absent_[simd::lanes + i] = none;
  }
  /// Of cluster i, from what it found.
  static std::size_t partner(std::size_t i, std::int32_t found) {
    const int d = (found & code_mask) / 2 + 1;
    return code(i, d) == (found & code_mask) ? i + static_cast<std::size_t>(d)
                                             : i - static_cast<std::size_t>(d);
  }

  void find_partners(bool as_they_come) {
    const std::size_t n = now_.size;
    if (as_they_come) {
      std::fill_n(best_.get(), n, 0);
      if (n % 2 == 1) best_[n - 1] = none;
      return;
    }
    tasks_.pieces(n, [&](std::size_t begin, std::size_t end) {
      // A stretch at a time, and with it the neighbours before it whose pairs reach into it.
      constexpr std::size_t stretch = 512, lanes = simd::lanes;
      alignas(64) std::int32_t best[stretch + 2 * lanes];
      const auto reach = static_cast<std::size_t>(options_.radius);
      for (std::size_t first = begin; first < end; first += stretch) {
        const std::size_t last = std::min(end, first + stretch), from = first - std::min(first, reach);
        std::fill_n(best, last - from + lanes, none);
        for (std::size_t i = from; i < last; ++i) compare(i, std::min(reach, n - 1 - i), best + (i - from));
        std::copy(best + (first - from), best + (last - from), best_.get() + first);
      }
    });
  }

  /// Cluster i with the `count` that follow it.
  void compare(std::size_t i, std::size_t count, std::int32_t* best) const {
    using simd::Floats16, simd::Ints16;
    const auto extent = [&](int axis) {
      const auto side = [&](int k) {
        const float* s = now_.side[k].get() + i;
        return max(Floats16::broadcast(*s), Floats16::load(s + 1));
      };
      return (side(axis) + side(3 + axis)) * Floats16::broadcast(scale_);
    };
    const Floats16 x = extent(0), y = extent(1), z = extent(2),
                   // Where sides overflow, the sum may be no number; zero then, and the codes decide.
        area = max(x * y + y * z + z * x, Floats16::broadcast(0));
    const Ints16 codes = Ints16::load(codes_[i % 32]), absent = Ints16::load(absent_ + simd::lanes - count),
                 found = Ints16::load(best + 1);
    const simd::IntReg keep = simd::broadcast(~code_mask);
    const Ints16 keys = Ints16::each([&](int k) {
      return simd::bit_or(simd::bit_or(simd::bit_and(simd::as_ints(area.r[k]), keep), codes.r[k]),
                          absent.r[k]);
    });
    Ints16::each([&](int k) { return simd::min(found.r[k], keys.r[k]); }).store(best + 1);
    *best = std::min(*best, simd::smallest(keys));
  }

  void merge_pairs() {
    const std::size_t n = now_.size;
    const auto merges = [&](std::size_t i) {  // its partner; none if that has found another
      if (best_[i] == none) return no_partner;
      const std::size_t j = partner(i, best_[i]);
      return best_[j] == best_[i] ? j : no_partner;
    };
    struct Counts {
      std::size_t merged = 0, kept = 0;
    };
    std::vector<Counts> counts((n + BuildTasks::piece - 1) / BuildTasks::piece);
    tasks_.pieces(n, [&](std::size_t begin, std::size_t end) {
      Counts c;
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t j = merges(i);
        c.merged += j != no_partner && j > i, c.kept += j == no_partner || j > i;
      }
      counts[begin / BuildTasks::piece] = c;
    });
    Counts before{made_, 0};
    for (Counts& c : counts) {
      before.merged += std::exchange(c.merged, before.merged);
      before.kept += std::exchange(c.kept, before.kept);
    }
    tasks_.pieces(n, [&](std::size_t begin, std::size_t end) {
      Counts to = counts[begin / BuildTasks::piece];
      // Sorted into those that stay and those that merge first, as which it is no machine can foresee.
      constexpr std::size_t stretch = 512;
      struct One {
        std::uint32_t at, to, with;
      } stay[stretch + 1], pair[stretch + 1];
      for (; begin < end; begin += stretch) {
        std::size_t stays = 0, pairs = 0;
        for (std::size_t i = begin; i < std::min(end, begin + stretch); ++i) {
          const std::size_t j = merges(i);
          const One one{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(to.kept),
                        static_cast<std::uint32_t>(j)};
          stay[stays] = pair[pairs] = one;
          stays += j == no_partner, pairs += j != no_partner && j > i;
          to.kept += j == no_partner || j > i;
        }
        for (std::size_t k = 0; k < stays; ++k) {
          const auto [at, place, with] = stay[k];
          for (int side = 0; side < 6; ++side) next_.side[side][place] = now_.side[side][at];
          next_.node[place] = now_.node[at];
        }
        for (std::size_t k = 0; k < pairs; ++k, ++to.merged) {
          const auto [at, place, with] = pair[k];
          merge(now_.node[at], now_.node[with], to.merged);
          next_.set(place, nodes_[to.merged], static_cast<std::uint32_t>(to.merged));
        }
      }
    });
    std::swap(now_, next_);
    now_.size = before.kept, made_ = before.merged;
  }

  void merge(std::uint32_t left, std::uint32_t right, std::size_t number) {
    using simd::PackedBox;
    LinkedNode& node = nodes_[number];
    const PackedBox box = merged(PackedBox::load(nodes_[left]), PackedBox::load(nodes_[right]));
    box.store(node);
    make_inner(node, left, right);
    const float area = box.half_area(scale_);
    const std::uint32_t count = below_[left].count + below_[right].count;
    const float open = static_cast<float>(options_.node_cost) * area + below_[left].cost + below_[right].cost;
    const float closed = static_cast<float>(leaf_tests(count, options_)) * area;
    const bool closes = count <= static_cast<std::uint32_t>(options_.largest_leaf) && closed <= open;
    below_[number] = {closes ? closed : open, count, closes};
  }

  static constexpr std::size_t no_partner = ~std::size_t{0};

  std::span<const geometry::Triangle<float>> triangles_;
  PlocBuildOptions options_;
  BuildTasks tasks_;
  std::vector<Key> order_;
  std::unique_ptr<LinkedNode[]> nodes_;
  std::unique_ptr<Below[]> below_;
  std::unique_ptr<std::int32_t[]> best_;  // of each cluster: an area and the number of a pair
  Clusters now_, next_;
  std::size_t made_ = 0;  // nodes
  float scale_ = 1;
  alignas(64) std::int32_t codes_[32][simd::lanes];
  alignas(64) std::int32_t absent_[2 * simd::lanes];
};

inline BinaryTree build_ploc(std::span<const geometry::Triangle<float>> triangles,
                             const PlocBuildOptions& options = {}) {
  return PlocBuilder(triangles, options).build();
}

}  // namespace treeline::accel
