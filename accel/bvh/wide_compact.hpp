// The wide tree over triangles in half the memory: planes of few bits, corners that a leaf's triangles share.
//
// Node: eight children. Their planes are whole steps, counted in 8 or 16 bits, from the lowest corner of them
// all; a step is a power of two, of its own along each axis (Mahovsky and Wyvill 2006; Ylitie, Karras and
// Laine 2017). Children lie side by side, and a byte says how far each is from the first: 80 or 128 bytes
// against 256. Leaf: each corner that its triangles have is kept once, as it is, and a triangle names three
// of them; with eight neighbours of a mesh, ten corners instead of 24: 192 bytes against 320. No corner is
// rounded, so the answers are those of the other layouts. Boxes only ever grow:
//   plane(q) = fl(origin + q step). q step is exact, as q has at most 16 bits and step is a power of two of
//   at least 2^-126; the sum rounds once, and is the same with a fused operation. Rounding is monotone, so
//   plane(q) grows with q. plane(0) is the origin, which is not above any low side; the step is chosen so
//   that plane(largest q) is not below any high side. So there are a largest q whose plane is not above a
//   given low side and a smallest one whose plane is not below a given high side; those are taken, found by
//   the very same arithmetic.
// Cost: some ten instructions more a node and 30 a leaf. Known weakness: with 8 bits boxes grow by up to
// 1/128 of their node's size on each side, and rays that start just off a surface are met by flat boxes that
// no longer are (walls of a building: 2 to 3 times the time, against 1.3 with 16 bits, for 1 byte a triangle
// less); and no refit, as corners that were one may part.
#pragma once

#include <cmath>
#include <cstring>

#include "accel/bvh/wide_closest.hpp"
#include "accel/bvh/wide_ray.hpp"

namespace treeline::accel::wide {

template <class Count>
struct alignas(16) CompactNode {
  float origin[3];
  std::uint8_t exponent[3];  // of the steps, biased as in a float
  std::uint8_t present;      // bits of children: the first ones
  Count plane[3][2][8];      // steps: axis by axis, low and high
  Ref first;                 // where the first child is, in steps of the tree
  std::uint8_t offset[8];    // of each child from there
  std::uint8_t leaves;       // bits of those that are leaves
  std::uint8_t spare[3];

  float step(int axis) const { return std::bit_cast<float>(std::uint32_t{exponent[axis]} << 23); }
};
static_assert(sizeof(CompactNode<std::uint8_t>) == 80 && sizeof(CompactNode<std::uint16_t>) == 128);

/// Behind it x, y and z of all corners, then the ids.
struct alignas(16) CompactLeaf {
  std::uint8_t corner[3][8];  // of each triangle; the last one again where there are no more
  std::uint8_t corners, triangles;
  std::uint8_t spare[6];

  const float* coordinates() const { return reinterpret_cast<const float*>(this + 1); }
};
static_assert(sizeof(CompactLeaf) == 32);

/// Planes in whole steps that enclose [low, high], and what they are relative to.
template <class Count>
class StepPlanes {
 public:
  /// Of all boxes along an axis.
  StepPlanes(float lowest, float highest) : origin_(lowest) {
    const double extent = double(highest) - double(lowest);
    int e = extent > 0 ? std::max(std::ilogb(extent) - std::numeric_limits<Count>::digits, least) : least;
    while (step_ = std::ldexp(1.0f, e), plane(last) < highest && e < most) ++e;
    exponent_ = static_cast<std::uint8_t>(e + 127);
  }
  std::uint8_t exponent() const { return exponent_; }
  float plane(int q) const { return origin_ + static_cast<float>(q) * step_; }
  Count low(float x) const {
    int q = start(x);
    while (q < last && plane(q + 1) <= x) ++q;
    while (q > 0 && plane(q) > x) --q;
    return static_cast<Count>(q);
  }
  Count high(float x) const {
    int q = start(x);
    while (q > 0 && plane(q - 1) >= x) --q;
    while (q < last && plane(q) < x) ++q;
    return static_cast<Count>(q);
  }

 private:
  static constexpr int least = -126, most = 127, last = std::numeric_limits<Count>::max();
  int start(float x) const {
    return static_cast<int>(std::clamp((double(x) - double(origin_)) / double(step_), 0.0, double(last)));
  }
  float origin_, step_ = 0;
  std::uint8_t exponent_;
};

template <class Count>
struct CompactLayout {
  static constexpr int width = 8, leaf_size = 8;
  static constexpr std::size_t step = 16;
  static constexpr std::uint32_t plane_bytes = 8 * sizeof(Count);
  static constexpr std::size_t asked_lines = 3;
  static constexpr bool families = true;
  static constexpr std::size_t overrun = 128;  // 32 coordinates are read where there may be one
  static constexpr std::size_t node_steps = sizeof(CompactNode<Count>) / step;
  using Node = CompactNode<Count>;
  using Leaf = CompactLeaf;
  using Full = RayLeaf<leaf_size>;
  using Box = geometry::Box<float, 3>;

  // ---- reading ------------------------------------------------------------------------------------

  struct Children {
    alignas(32) Ref ref[8];
    operator const Ref*() const { return ref; }
  };
  static int count(const Node& node) { return std::popcount(node.present); }
  static Ref child(const Node& node, std::uint32_t lane) {
    return (node.first + node.offset[lane]) * 2 + (node.leaves >> lane & 1u);
  }
  static Children children(const Node& node) {
    Children c;
#if TREELINE_SIMD >= 256
    const __m256i offset =
        _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(node.offset)));
    const __m256i place = _mm256_add_epi32(offset, _mm256_set1_epi32(static_cast<int>(node.first)));
    const __m256i leaf = _mm256_and_si256(
        _mm256_srlv_epi32(_mm256_set1_epi32(node.leaves), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)),
        _mm256_set1_epi32(1));
    _mm256_store_si256(reinterpret_cast<__m256i*>(c.ref), _mm256_or_si256(_mm256_slli_epi32(place, 1), leaf));
#else
    for (std::uint32_t lane = 0; lane < 8; ++lane) c.ref[lane] = child(node, lane);
#endif
    return c;
  }
  static Box box(const Node& node, int i) {
    Box b;
    for (int k = 0; k < 3; ++k) {
      const auto plane = [&](int side) {
        return node.origin[k] + static_cast<float>(node.plane[k][side][i]) * node.step(k);
      };
      b.low[k] = plane(0), b.high[k] = plane(1);
    }
    return b;
  }
  static Full triangles(const Leaf& leaf) {
    Full full;
    const float* const coordinates = leaf.coordinates();
    const std::size_t n = leaf.corners;
    const std::uint32_t last = leaf.triangles - 1u;
#if TREELINE_SIMD == 512
    const __m512i ab = _mm512_maskz_cvtepu8_epi32(
        simd::all16, _mm_loadu_si128(reinterpret_cast<const __m128i*>(leaf.corner)));
    const __m512i c = _mm512_maskz_cvtepu8_epi32(
        simd::all16, _mm_loadu_si128(reinterpret_cast<const __m128i*>(leaf.corner[2])));
    for (std::size_t k = 0; k < 3; ++k) {
      const float* const from = coordinates + k * n;
      const __m512 some = _mm512_loadu_ps(from), others = _mm512_loadu_ps(from + 16);
      const __m512 both = _mm512_permutex2var_ps(some, ab, others);
      const auto half = [](__m512 x, auto which) {
        return _mm512_maskz_extractf32x8_ps(simd::all8, x, which());
      };
      using Low = std::integral_constant<int, 0>;
      using High = std::integral_constant<int, 1>;
      _mm256_store_ps(full.corner[0][k], half(both, Low{}));
      _mm256_store_ps(full.corner[1][k], half(both, High{}));
      _mm256_store_ps(full.corner[2][k], half(_mm512_permutex2var_ps(some, c, others), Low{}));
    }
#else
    for (int i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        for (int j = 0; j < 8; ++j) full.corner[i][k][j] = coordinates[k * n + leaf.corner[i][j]];
#endif
    const float* const ids = coordinates + 3 * n;
#if TREELINE_SIMD >= 256
    const __m256i wanted = _mm256_min_epu32(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7),
                                            _mm256_set1_epi32(static_cast<int>(last)));
    const __m256i stored = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(ids));
    _mm256_store_si256(reinterpret_cast<__m256i*>(full.id), _mm256_permutevar8x32_epi32(stored, wanted));
#else
    for (std::uint32_t j = 0; j < 8; ++j) std::memcpy(&full.id[j], ids + std::min(j, last), sizeof(Id));
#endif
    return full;
  }

  // ---- writing ------------------------------------------------------------------------------------

  static void write(Node& node, const NodeParts& parts) {
    std::memset(static_cast<void*>(&node), 0, sizeof node);
    const std::size_t count = parts.boxes.size();
    Ref first = no_ref;
    for (const Ref ref : parts.children) first = std::min(first, ref / 2);
    node.first = first;
    for (std::size_t i = 0; i < count; ++i) {
      const auto bit = static_cast<std::uint8_t>(1u << i);
      node.present |= bit;
      if (is_leaf(parts.children[i])) node.leaves |= bit;
      node.offset[i] = static_cast<std::uint8_t>(parts.children[i] / 2 - first);
    }
    Box all;
    for (const Box& box : parts.boxes) all.grow(box);
    for (int k = 0; k < 3; ++k) {
      const StepPlanes<Count> planes(all.low[k], all.high[k]);
      node.origin[k] = all.low[k], node.exponent[k] = planes.exponent();
      for (std::size_t i = 0; i < count; ++i) {
        node.plane[k][0][i] = planes.low(parts.boxes[i].low[k]);
        node.plane[k][1][i] = planes.high(parts.boxes[i].high[k]);
      }
    }
  }
  static std::size_t leaf_steps(const Full& triangles, std::uint32_t count) {
    return steps_of(Corners(triangles, count).count, count);
  }
  static void write(Leaf& leaf, const Full& triangles, std::uint32_t count) {
    const Corners corners(triangles, count);
    std::memset(static_cast<void*>(&leaf), 0, steps_of(corners.count, count) * step);
    leaf.corners = static_cast<std::uint8_t>(corners.count),
    leaf.triangles = static_cast<std::uint8_t>(count);
    std::memcpy(leaf.corner, corners.of, sizeof leaf.corner);
    auto* out = reinterpret_cast<unsigned char*>(&leaf + 1);
    for (int k = 0; k < 3; ++k, out += corners.count * sizeof(float))
      std::memcpy(out, corners.at[k], corners.count * sizeof(float));
    std::memcpy(out, triangles.id, count * sizeof(Id));
  }

 private:
  static constexpr std::size_t most_corners = 3 * leaf_size;
  static constexpr std::size_t steps_of(std::size_t corners, std::size_t triangles) {
    return (sizeof(Leaf) + corners * 3 * sizeof(float) + triangles * sizeof(Id) + step - 1) / step;
  }
  static_assert((width - 1) * ((sizeof(Leaf) + most_corners * 12 + leaf_size * 4 + step - 1) / step) < 256,
                "a byte tells how far a child is from the first");

  /// The different corners of a leaf's triangles, told apart by their bits.
  struct Corners {
    float at[3][most_corners];
    std::uint8_t of[3][8];
    std::size_t count = 0;

    Corners(const Full& triangles, std::uint32_t n) {
      for (std::uint32_t j = 0; j < 8; ++j)
        for (int i = 0; i < 3; ++i) of[i][j] = j < n ? number_of(triangles, i, j) : of[i][n - 1];
    }

   private:
    std::uint8_t number_of(const Full& triangles, int i, std::uint32_t j) {
      std::uint32_t bits[3];
      for (int k = 0; k < 3; ++k) bits[k] = std::bit_cast<std::uint32_t>(triangles.corner[i][k][j]);
      for (std::size_t c = 0; c < count; ++c)
        if (std::bit_cast<std::uint32_t>(at[0][c]) == bits[0] &&
            std::bit_cast<std::uint32_t>(at[1][c]) == bits[1] &&
            std::bit_cast<std::uint32_t>(at[2][c]) == bits[2])
          return static_cast<std::uint8_t>(c);
      for (int k = 0; k < 3; ++k) at[k][count] = triangles.corner[i][k][j];
      return static_cast<std::uint8_t>(count++);
    }
  };
};

template <class Count>
[[gnu::always_inline]] inline BoxHits<8> meet(const CompactNode<Count>& node,
                                              const BoxRay<CompactLayout<Count>>& ray, float limit) {
  using F = simd::Floats<8>;
  const auto* planes = reinterpret_cast<const unsigned char*>(node.plane);
  BoxHits<8> hits = meet_planes(
      [&](int k, std::uint32_t offset) {
        const F steps = F::of(reinterpret_cast<const Count*>(planes + offset));
        return steps * F::broadcast(node.step(k)) + F::broadcast(node.origin[k]);
      },
      ray, limit);
  hits.bits &= node.present;
  return hits;
}
template <class Count, class Place>
[[gnu::always_inline]] inline BoxHits<8> near(const CompactNode<Count>& node, const Place& place,
                                              float limit) {
  using F = simd::Floats<8>;
  const F d2 = place.template to_boxes<8>([&](int k, int high) {
    return F::of(node.plane[k][high]) * F::broadcast(node.step(k)) + F::broadcast(node.origin[k]);
  });
  return {d2, bits_le(d2, F::broadcast(limit)) & node.present};
}

template <>
struct LayoutOf<WideCompact<8>> {
  using Type = CompactLayout<std::uint8_t>;
};
template <>
struct LayoutOf<WideCompact<16>> {
  using Type = CompactLayout<std::uint16_t>;
};

}  // namespace treeline::accel::wide
