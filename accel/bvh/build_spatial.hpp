// Builds a binary tree over triangles with spatial splits (Stich, Friedrich and Dietrich 2009): where the
// children of the best split of triangles overlap, planes are tried as well, and triangles across the chosen
// one are referred to from both sides, each by the box of its part there.
//
// That is what scenes of long thin triangles ask for: their boxes are mostly empty, and no way to share
// whole triangles out parts them. Both kinds of split are chosen among bins by the surface area heuristic. A
// triangle across the plane stays whole on one side where that is cheaper. References are capped: a node has
// room for so many more, and shares what is left among its children. Cost: O(n log n), about
// twice that of binning alone. Known weakness: references, and with them memory, grow.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <span>

#include "accel/bvh/binary_order.hpp"
#include "accel/bvh/build_tasks.hpp"
#include "accel/bvh/chop.hpp"

namespace treeline::accel {

struct SpatialBuildOptions : BinaryBuildOptions {
  double references = 1.5;  ///< per triangle at most
  double alpha =
      1e-5;  ///< planes are tried where children overlap by more than this share of the root's area
  double overlap = 0.3;  ///< … and than this share of the node's own
  int spatial_bins = 8;  ///< candidate planes per axis, and one
};

class SpatialBuilder {
 public:
  /// The triangles are finite.
  SpatialBuilder(std::span<const geometry::Triangle<float>> triangles, const SpatialBuildOptions& options)
      : triangles_(triangles), options_(options), tasks_(options.threads) {
    check(options, triangles.size());
    if (!(options.references >= 1 && options.references <= 8))
      throw InvalidInput("references is " + std::to_string(options.references) + "; it must be in [1, 8]");
    if (!(options.alpha >= 0)) throw InvalidInput("alpha is negative or not a number");
    if (options.spatial_bins < 2 || options.spatial_bins > most_bins)
      throw InvalidInput("spatial_bins is " + std::to_string(options.spatial_bins) + "; it must be in [2, " +
                         std::to_string(most_bins) + "]");
  }

  BinaryTree build() {
    const std::size_t n = triangles_.size();
    if (n == 0) return {};
    const auto room = std::min<std::size_t>(
        static_cast<std::size_t>(static_cast<double>(n) * options_.references), (std::size_t{1} << 30) - 1);
    for (auto& refs : refs_) refs = std::make_unique_for_overwrite<Ref[]>(room);
    ids_ = std::make_unique_for_overwrite<std::uint32_t[]>(room);
    nodes_ = std::make_unique_for_overwrite<LinkedNode[]>(2 * room);
    Part root{{0, n, 0, room}, PackedBox::empty(), PackedBox::empty()};
    for (std::size_t i = 0; i < n; ++i) {
      Ref& ref = refs_[0][i];
      ref = simd::packed(triangles_[i].box());
      ref.set_tag(0, static_cast<std::uint32_t>(i));
      root.add(PackedBox::load(ref));
    }
    root_scale_ = area_scale(root.box.lanes());
    least_overlap_ = static_cast<float>(options_.alpha) * root.box.half_area(root_scale_);
    tasks_.run([&] { split(root, 0, 0, false); });
    return ordered(nodes_.get(), 0, next_, references_, [&](std::size_t i) { return ids_[i]; });
  }

 private:
  using Ref = simd::BoxLanes;  // tag 0: its triangle
  using PackedBox = simd::PackedBox;
  static constexpr int most_bins = 32;
  // Room is shared by the area of boxes, of which large ones gain most by being cut, and a quarter by number,
  // so that large walls do not take it all. Building of 1e6 triangles, 1.5 references each: cost 121 by
  // number alone, 112 so.
  static constexpr double area_weight = 0.75;

  struct Range {
    std::size_t first, size, room_first, room_last;  // its references, and where they may spread
  };
  struct Part {
    Range range;
    PackedBox box, centres;

    void add(PackedBox b) { box = merged(box, b), centres = merged(centres, b.centre()); }
  };
  struct Split {
    float cost = std::numeric_limits<float>::infinity();  // times half the area of the node, scaled
    int axis = -1, bin = 0;                               // the last one on the left
    std::size_t left = 0, right = 0;
    PackedBox left_box = PackedBox::empty(), right_box = PackedBox::empty();
  };
  struct Bins {
    simd::BoxLanes box[3][most_bins];
    std::uint32_t enter[3][most_bins], leave[3][most_bins];
    int count;

    explicit Bins(int n) : count(n) {
      for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < n; ++i)
          PackedBox::empty().store(box[axis][i]), enter[axis][i] = leave[axis][i] = 0;
    }
    void grow(int axis, int bin, PackedBox b) {
      simd::BoxLanes& to = box[axis][bin];
      merged(PackedBox::load(to), b).store(to);
    }
  };
  /// Which bin a coordinate falls into, by the same arithmetic wherever asked.
  struct Grid {
    float low[4], scale[4], step[3];
    int last;

    Grid(const simd::BoxLanes& range, int bins) : last(bins - 1) {
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = range.low(axis);
        step[axis] = (range.high(axis) - low[axis]) / static_cast<float>(bins);
        const float s = static_cast<float>(bins) / (range.high(axis) - range.low(axis));
        scale[axis] = s > 0 && s <= std::numeric_limits<float>::max() ? s : 0;
      }
      low[3] = scale[3] = 0;
    }
    float plane(int axis, int bin) const { return low[axis] + step[axis] * static_cast<float>(bin); }
    int bin(int axis, float x) const {
      const float cell = (x - low[axis]) * scale[axis];  // 0 if not a number, as the vector form has it
      return cell > 0 ? static_cast<int>(std::min(cell, static_cast<float>(last))) : 0;
    }
  };

  void split(const Part& part, std::size_t slot, std::size_t level, bool swapped) {
    const Range& r = part.range;
    const Ref* const from = refs_[swapped].get() + r.first;
    LinkedNode& node = nodes_[slot];
    part.box.store(node);
    const std::size_t tests = leaf_tests(r.size, options_);
    const bool may_close = r.size <= static_cast<std::size_t>(options_.largest_leaf);
    if (may_close && (static_cast<double>(tests) <= options_.node_cost || must_halve(level, r.size)))
      return close(part, from, slot);
    Part parts[2];
    bool done = false;
    if (!must_halve(level, r.size)) {
      const float scale = area_scale(node);
      const Grid grid(part.centres.lanes(), object_bins(r.size));
      const Split by_object = best_object_split(from, r.size, grid, scale);
      Split by_space;
      Grid space(node, options_.spatial_bins);
      if (r.size > 1 && r.room_last - r.room_first > r.size &&
          overlaps(by_object, scale, part.box.half_area(scale)))
        by_space = best_plane(from, part, space, scale);
      const double best = std::min(by_object.cost, by_space.cost), area = part.box.half_area(scale);
      if (may_close && !(best + options_.node_cost * area < static_cast<double>(tests) * area))
        return close(part, from, slot);
      if (by_space.cost < by_object.cost) done = cut(part, swapped, space, by_space, scale, parts);
      if (!done && by_object.axis >= 0) done = deal(part, swapped, grid, by_object, parts);
    }
    if (!done && may_close) return close(part, from, slot);  // the plane cut less than bins promised
    if (!done) halve(part, swapped, parts);
    const auto pair = static_cast<std::uint32_t>(next_.fetch_add(2, std::memory_order_relaxed));
    make_inner(node, pair, pair + 1);
    tasks_.both(
        r.size, [&] { split(parts[0], pair, level + 1, !swapped); },
        [&] { split(parts[1], pair + 1, level + 1, !swapped); });
  }

  void close(const Part& part, const Ref* from, std::size_t slot) {
    const Range& r = part.range;
    for (std::size_t i = 0; i < r.size; ++i) ids_[r.first + i] = from[i].tag(0);
    make_leaf(nodes_[slot], r.first, r.size);
    references_.fetch_add(r.size, std::memory_order_relaxed);
  }

  // ---- splits of triangles ----------------------------------------------------------------------------

  static int object_bins(std::size_t n) {
    return static_cast<int>(std::min<std::size_t>(most_bins, 8 + n / 16));
  }

  Split best_object_split(const Ref* from, std::size_t n, const Grid& grid, float scale) const {
    Bins bins(grid.last + 1);
    for (std::size_t i = 0; i < n; ++i) {
      const PackedBox box = PackedBox::load(from[i]);
      std::int32_t bin[4];
      box.bins_of_sum(grid.low, grid.scale, grid.last, bin);
      for (int axis = 0; axis < 3; ++axis) bins.grow(axis, bin[axis], box), ++bins.enter[axis][bin[axis]];
    }
    return cheapest(bins, bins.enter, grid, scale);
  }

  /// Of the cuts between bins; left and right count what enters before and what leaves behind.
  Split cheapest(const Bins& bins, const std::uint32_t (&leave)[3][most_bins], const Grid& grid,
                 float scale) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (grid.scale[axis] == 0) continue;
      float right_cost[most_bins];
      PackedBox sum = PackedBox::empty();
      std::size_t count = 0;
      for (int i = grid.last; i > 0; --i) {
        count += leave[axis][i];
        sum = merged(sum, PackedBox::load(bins.box[axis][i]));
        right_cost[i] = count == 0 ? -1 : sum.half_area(scale) * tests(count);
      }
      sum = PackedBox::empty(), count = 0;
      for (int i = 0; i < grid.last; ++i) {
        count += bins.enter[axis][i];
        sum = merged(sum, PackedBox::load(bins.box[axis][i]));
        if (count == 0) continue;
        if (right_cost[i + 1] < 0) break;
        const float cost = sum.half_area(scale) * tests(count) + right_cost[i + 1];
        if (cost < best.cost) best.cost = cost, best.axis = axis, best.bin = i;
      }
    }
    if (best.axis < 0) return best;
    for (int i = 0; i <= grid.last; ++i) {
      const bool left = i <= best.bin;
      (left ? best.left : best.right) += (left ? bins.enter : leave)[best.axis][i];
      PackedBox& box = left ? best.left_box : best.right_box;
      box = merged(box, PackedBox::load(bins.box[best.axis][i]));
    }
    return best;
  }
  float tests(std::size_t count) const {
    return static_cast<float>((count + static_cast<std::size_t>(options_.block) - 1) /
                              static_cast<std::size_t>(options_.block));
  }

  bool overlaps(const Split& split, float scale, float area) const {
    if (split.axis < 0) return true;
    const simd::BoxLanes both = intersection(split.left_box, split.right_box).lanes();
    for (int axis = 0; axis < 3; ++axis)
      if (!(both.low(axis) <= both.high(axis))) return false;
    const PackedBox overlap = PackedBox::load(both);
    return overlap.half_area(root_scale_) > least_overlap_ &&
           overlap.half_area(scale) > static_cast<float>(options_.overlap) * area;
  }

  bool deal(const Part& part, bool swapped, const Grid& grid, const Split& split, Part (&parts)[2]) {
    Dealer to(refs_[!swapped].get(), part.range, root_scale_);
    const Ref* const from = refs_[swapped].get() + part.range.first;
    for (std::size_t i = 0; i < part.range.size; ++i)
      to.add(grid.bin(split.axis, from[i].sum(split.axis)) > split.bin, from[i]);
    return to.finish(parts);
  }

  // ---- splits by planes -------------------------------------------------------------------------------

  Split best_plane(const Ref* from, const Part& part, const Grid& grid, float scale) const {
    Bins bins(grid.last + 1);
    for (std::size_t i = 0; i < part.range.size; ++i) {
      const PackedBox box = PackedBox::load(from[i]);
      std::int32_t first[4], last[4];
      box.bins(grid.low, grid.scale, grid.last, first, last);
      std::uint32_t across = 0;
      for (int axis = 0; axis < 3; ++axis) {
        if (first[axis] != last[axis]) {
          across |= 1u << axis;
          continue;
        }
        bins.grow(axis, first[axis], box);
        ++bins.enter[axis][first[axis]], ++bins.leave[axis][first[axis]];
      }
      if (across == 0) continue;
      Chopper chopper(triangles_[from[i].tag(0)]);
      for (; across != 0; across &= across - 1) {
        const int axis = std::countr_zero(across);
        chopper.along(axis);
        chop(bins, axis, first[axis], last[axis], box, chopper, grid);
      }
    }
    Split best = cheapest(bins, bins.leave, grid, scale);
    const Range& r = part.range;
    if (best.left + best.right > r.room_last - r.room_first) best.cost = Split{}.cost;
    return best;
  }

  static void chop(Bins& bins, int axis, int first, int last, PackedBox whole, const Chopper& chopper,
                   const Grid& grid) {
    ++bins.enter[axis][first], ++bins.leave[axis][last];
    PackedBox pieces[most_bins];
    pieces[first] = PackedBox::empty();
    for (int bin = first; bin < last; ++bin) {
      const PackedBox cut = chopper.crossing(grid.plane(axis, bin + 1));
      pieces[bin] = merged(pieces[bin], cut), pieces[bin + 1] = cut;
    }
    for (int i = 0; i < 3; ++i) {
      PackedBox& piece = pieces[std::clamp(grid.bin(axis, chopper.at(i)), first, last)];
      piece = merged(piece, chopper.corner(i));
    }
    for (int bin = first; bin <= last; ++bin) bins.grow(axis, bin, intersection(pieces[bin], whole));
  }

  bool cut(const Part& part, bool swapped, const Grid& grid, Split split, float scale, Part (&parts)[2]) {
    const float plane = grid.plane(split.axis, split.bin + 1);
    Dealer to(refs_[!swapped].get(), part.range, root_scale_);
    const Ref* const from = refs_[swapped].get() + part.range.first;
    std::size_t spare = part.range.room_last - part.range.room_first - part.range.size;
    for (std::size_t i = 0; i < part.range.size; ++i) {
      const Ref& ref = from[i];
      const bool right = ref.low(split.axis) >= plane;
      if (right || ref.high(split.axis) <= plane) {
        to.add(right, ref);
        continue;
      }
      const Side side = side_of(ref, split, scale, spare > 0);
      if (side != Side::both) {
        to.add(side == Side::right, ref);
        continue;
      }
      Ref pieces[2];
      const bool any[] = {piece_of(ref, split.axis, plane, false, pieces[0]),
                          piece_of(ref, split.axis, plane, true, pieces[1])};
      if (any[0] == any[1]) --spare;
      if (any[0] || !any[1]) to.add(false, pieces[0]);
      if (any[1] || !any[0]) to.add(true, pieces[1]);
    }
    return to.finish(parts);
  }

  enum class Side { left, right, both };

  /// Whether a reference across the plane is cheaper left whole. Keeps the split's boxes and numbers.
  static Side side_of(const Ref& ref, Split& s, float scale, bool may_split) {
    const PackedBox box = PackedBox::load(ref), left = merged(s.left_box, box),
                    right = merged(s.right_box, box);
    const auto count = [](std::size_t n) { return static_cast<float>(n); };
    const float left_area = s.left_box.half_area(scale), right_area = s.right_box.half_area(scale);
    const float split = left_area * count(s.left) + right_area * count(s.right);
    const float all_left = left.half_area(scale) * count(s.left) + right_area * count(s.right - 1);
    const float all_right = left_area * count(s.left - 1) + right.half_area(scale) * count(s.right);
    if (may_split && split <= all_left && split <= all_right) return Side::both;
    if (all_left <= all_right) {
      s.left_box = left, s.right -= s.right > 0;
      return Side::left;
    }
    s.right_box = right, s.left -= s.left > 0;
    return Side::right;
  }

  /// Returns false if nothing of it lies on that side; the piece is then the whole.
  bool piece_of(const Ref& ref, int axis, float plane, bool right, Ref& piece) const {
    Chopper chopper(triangles_[ref.tag(0)]);
    chopper.along(axis);
    PackedBox box = chopper.crossing(plane);
    for (int i = 0; i < 3; ++i)
      if (right ? chopper.at(i) >= plane : chopper.at(i) <= plane) box = merged(box, chopper.corner(i));
    piece = intersection(box, PackedBox::load(ref)).lanes();
    piece.set_tag(0, ref.tag(0));
    if (right)
      piece.v[axis] = -plane;
    else
      piece.v[4 + axis] = plane;
    for (int a = 0; a < 3; ++a)
      if (!(piece.low(a) <= piece.high(a))) {
        piece = ref;
        return false;
      }
    return true;
  }

  void halve(const Part& part, bool swapped, Part (&parts)[2]) {
    const Range& r = part.range;
    const int axis = part.centres.lanes().box().widest_axis();
    Ref* const from = refs_[swapped].get() + r.first;
    const std::size_t left = rank_half(r.size, options_);
    std::nth_element(from, from + left, from + r.size, [axis](const Ref& a, const Ref& b) {
      const float x = a.sum(axis), y = b.sum(axis);
      return x < y || (x == y && a.tag(0) < b.tag(0));
    });
    Dealer to(refs_[!swapped].get(), r, root_scale_);
    for (std::size_t i = 0; i < r.size; ++i) to.add(i >= left, from[i]);
    to.finish(parts);
  }

  /// Writes references to the two ends of a range's room in the other buffer.
  class Dealer {
   public:
    Dealer(Ref* refs, const Range& range, float scale)
        : scale_(scale),
          refs_(refs),
          range_(range),
          left_(refs + range.room_first),
          right_(refs + range.room_last) {
      for (auto& b : box_) PackedBox::empty().store(b);
      for (auto& c : centres_) PackedBox::empty().store(c);
    }
    void add(bool right, const Ref& ref) {
      // Written to both ends; the one where it belongs moves on.
      const PackedBox box = PackedBox::load(ref);
      *left_ = ref, right_[-1] = ref;
      left_ += !right, right_ -= right;
      area_[right] += box.half_area(scale_);
      merged(PackedBox::load(box_[right]), box).store(box_[right]);
      merged(PackedBox::load(centres_[right]), box.centre()).store(centres_[right]);
    }
    /// Shares the room that is left; false if a side is empty.
    bool finish(Part (&parts)[2]) const {
      const auto at = [&](const Ref* p) { return static_cast<std::size_t>(p - refs_); };
      const std::size_t left = at(left_) - range_.room_first, right = range_.room_last - at(right_);
      if (left == 0 || right == 0) return false;
      double share = static_cast<double>(left) / static_cast<double>(left + right);
      if (const double area = area_[0] + area_[1]; area > 0 && area <= std::numeric_limits<double>::max())
        share += (area_[0] / area - share) * area_weight;
      const std::size_t room = at(right_) - at(left_),
                        border = at(left_) +
                                 std::min(room, static_cast<std::size_t>(static_cast<double>(room) * share));
      parts[0] = {{range_.room_first, left, range_.room_first, border},
                  PackedBox::load(box_[0]),
                  PackedBox::load(centres_[0])};
      parts[1] = {{at(right_), right, border, range_.room_last},
                  PackedBox::load(box_[1]),
                  PackedBox::load(centres_[1])};
      return true;
    }

   private:
    float scale_;
    Ref* refs_;
    Range range_;
    Ref *left_, *right_;
    simd::BoxLanes box_[2], centres_[2];
    double area_[2] = {0, 0};
  };

  std::span<const geometry::Triangle<float>> triangles_;
  SpatialBuildOptions options_;
  BuildTasks tasks_;
  std::array<std::unique_ptr<Ref[]>, 2> refs_;  // by turns
  std::unique_ptr<std::uint32_t[]> ids_;
  std::unique_ptr<LinkedNode[]> nodes_;
  std::atomic<std::size_t> next_ = 1, references_ = 0;
  float root_scale_ = 1, least_overlap_ = 0;
};

inline BinaryTree build_spatial(std::span<const geometry::Triangle<float>> triangles,
                                const SpatialBuildOptions& options = {}) {
  return SpatialBuilder(triangles, options).build();
}

}  // namespace treeline::accel
