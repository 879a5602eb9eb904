// Memory of the wide tree over points: leaves of 16 points and inner nodes of 16 child boxes, coordinate by
// coordinate, so that one pass measures them all.
//
// The tree is implicit: leaf i lies below node i / 16 of the level above, and so on; nothing points anywhere.
// Every node is full but the last of its level. Absent points have infinite coordinates and no_id, absent
// boxes bounds that are NaN, which no comparison finds near.
#pragma once

#include <array>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>

#include "accel/concepts.hpp"
#include "accel/simd/lanes16.hpp"
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace treeline::accel::wide {

inline constexpr int lanes = simd::lanes;
inline constexpr float infinity = std::numeric_limits<float>::infinity();
inline constexpr int max_levels = 8;  // 16^8 leaves are more than ids can number

template <int D, class T = float>
struct alignas(64) Leaf {
  T x[D][lanes];
  Id id[lanes];
};

template <int D>
struct alignas(64) Node {
  float low[D][lanes], high[D][lanes];
  Id first_id[lanes];  // the lowest id below each child, which settles ties without a visit
};

/// Memory, not initialised, aligned to cache lines; large blocks ask for huge pages (5 to 15 % on queries
/// that miss the caches of a million points).
template <class T>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t size) : size_(size) {
    if (size == 0) return;
    constexpr std::size_t huge_page = std::size_t{1} << 21;
    bytes_ = size * sizeof(T);
    const std::size_t alignment = bytes_ >= huge_page ? huge_page : std::size_t{64};
    bytes_ = (bytes_ + alignment - 1) / alignment * alignment;
    data_.reset(static_cast<T*>(std::aligned_alloc(alignment, bytes_)));
    if (!data_) throw std::bad_alloc();
#ifdef __linux__
    if (alignment == huge_page) madvise(data_.get(), bytes_, MADV_HUGEPAGE);  // a hint: may fail
#endif
  }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return bytes_; }
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  std::unique_ptr<T[], Free> data_;
  std::size_t size_ = 0, bytes_ = 0;
};

/// T is that of the leaves; boxes are of floats always (wide_double.hpp says why doubles need no more).
/// Level 0 is the leaves; the nodes of levels 1 … top lie one level after the other, the root last.
template <int D, class T = float>
struct Tree {
  using Box = geometry::Box<T, D>;
  AlignedArray<Leaf<D, T>> leaves;
  AlignedArray<Node<D>> nodes;
  std::array<std::size_t, max_levels + 1> first_node{};  // of each level
  int top = 0;                                           // level of the root; 0: it is the only leaf

  Tree() = default;
  explicit Tree(std::size_t points) : leaves((points + lanes - 1) / lanes) {
    std::size_t below = leaves.size(), count = 0;
    while (below > 1) {
      below = (below + lanes - 1) / lanes;
      first_node[static_cast<std::size_t>(++top)] = count;
      count += below;
    }
    nodes = AlignedArray<Node<D>>(count);
  }
  const Node<D>* level(int l) const { return nodes.data() + first_node[static_cast<std::size_t>(l)]; }
  Node<D>* level(int l) { return nodes.data() + first_node[static_cast<std::size_t>(l)]; }
  /// Nodes (level 0: leaves) of a level.
  std::size_t size(int l) const {
    std::size_t count = leaves.size();
    for (; l > 0; --l) count = (count + lanes - 1) / lanes;
    return count;
  }
  std::size_t bytes() const { return leaves.bytes() + nodes.bytes(); }
};

/// Sets the box of a node's child: of the level's children, all counted, that of the given number. NaN bounds
/// for one that is absent.
template <int D, class T>
void set_child(Tree<D, T>& tree, int level, std::size_t number, const geometry::Box<float, D>& box,
               Id first_id) {
  Node<D>& parent = tree.level(level)[number / lanes];
  const std::size_t lane = number % lanes;
  for (int a = 0; a < D; ++a) parent.low[a][lane] = box.low[a], parent.high[a][lane] = box.high[a];
  parent.first_id[lane] = first_id;
}
template <int D>
geometry::Box<float, D> child_box(const Tree<D>& tree, int level, std::size_t number) {
  const Node<D>& parent = tree.level(level)[number / lanes];
  const std::size_t lane = number % lanes;
  geometry::Box<float, D> box;
  for (int a = 0; a < D; ++a) box.low[a] = parent.low[a][lane], box.high[a] = parent.high[a][lane];
  return box;
}

}  // namespace treeline::accel::wide
