// Which triangles may be nearest to a query: noted while leaves are measured in float, with bounds on what
// float may have done (wide_closest.hpp), to be measured in double at the end. As a rule one to six.
#pragma once

#include <algorithm>
#include <bit>

#include "accel/bvh/wide_closest_space.hpp"

namespace treeline::accel::wide {

/// Whether each lane of a leaf has a triangle that is not one point, as bits.
template <int N>
std::uint32_t extended(const RayLeaf<N>& leaf) {
  std::uint32_t bits = 0;
  for (int j = 0; j < N; ++j) {
    bool same = true;
    for (int k = 0; k < 3; ++k)
      same = same && leaf.corner[0][k][j] == leaf.corner[1][k][j] &&
             leaf.corner[0][k][j] == leaf.corner[2][k][j];
    bits |= (same ? 0u : 1u) << j;
  }
  return bits;
}

/// Asks for all lines of a node or leaf.
template <class Layout>
void prefetch_whole(const Line* lines, Ref ref) {
  const unsigned char* const p = at<Layout>(lines, ref & ~1u);
  for (std::size_t i = 0; i < sizeof(typename Layout::Leaf); i += line) __builtin_prefetch(p + i);
}

/// A bound on squared distances, as float, not below it.
inline float rounded_up(double square) {
  constexpr double largest = std::numeric_limits<float>::max();
  return static_cast<float>(std::min(square * (1 + 0x1p-22) + 0x1p-116, largest));
}
/// What boxes may be off, so that nothing within `upper` is in one that is farther.
inline float padded(float upper) {
  return std::min(upper * (1 + box_distance_slack), std::numeric_limits<float>::max());
}

template <class Layout>
class ClosestNotes {
 public:
  float upper = 0;  // squared distances beyond are of no interest

  /// Notes what may be nearest in a leaf. True if `upper` has come down.
  template <class MakeRoom>
  [[gnu::always_inline]] bool visit(const ClosestSpace& space, Ref ref, const ClosestPlace& place,
                                    MakeRoom&& make_room) {
    using F = simd::Floats<Layout::leaf_size>;
    const auto& leaf = Layout::triangles(leaf_at<Layout>(space.tree.lines.data(), ref));
    const auto bounds = place.to_triangles(leaf);
    std::uint32_t bits = bounds.within(upper);
    if (bits == 0) return false;
    if (space.has_vanished) [[unlikely]] {
      bits &= extended(leaf);
      if (bits == 0) return false;
    }
    bool nearer = false;
    if (!space.has_vanished) {
      nearer = bits_lt(bounds.high, F::broadcast(upper)) != 0;
      if (nearer) upper = smallest(bounds.high), bits = bounds.within(upper);
    } else {
      alignas(64) float high[Layout::leaf_size];
      bounds.high.store(high);
      for (std::uint32_t left = bits; left != 0; left &= left - 1)
        if (const float h = high[std::countr_zero(left)]; h < upper) upper = h, nearer = true;
      bits &= bounds.within(upper);
    }
    alignas(64) float low[Layout::leaf_size];
    bounds.low.store(low);
    for (; bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
      if (count_ == room) make_room();
      noted_[count_++] = {ref, lane, (bounds.slivers >> lane & 1) != 0 ? bounds.sliver_low(lane) : low[lane]};
    }
    return nearer;
  }
  /// Calls f(leaf, lane) for what may still be nearest, and forgets all of it.
  template <class F>
  void take(F&& f) {
    for (int i = 0; i < count_; ++i)
      if (const Noted& noted = noted_[i]; !(noted.low > upper)) f(noted.leaf, noted.lane);
    count_ = 0;
  }

 private:
  static constexpr int room = 64;

  struct Noted {
    Ref leaf;
    std::uint32_t lane;
    float low;
  };
  int count_ = 0;
  Noted noted_[room];
};

}  // namespace treeline::accel::wide
