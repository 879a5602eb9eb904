// The triangles of a tree's leaves, so laid out that one instruction takes the same coordinate of eight.
//
// A leaf of n triangles is nine rows of n coordinates (corner a's x, y, z; corner b's; corner c's) one behind
// the other, and n ids. Nothing is padded: a kernel that loads eight lanes reads past the end of a row into
// the next, and masks what it read. A triangle in several leaves is kept in each. Bytes: 40 a reference for
// float.
#pragma once

#include <span>
#include <vector>

#include "accel/bvh/build_tasks.hpp"
#include "accel/triangle_set.hpp"

namespace treeline::accel {

template <class T>
class TriangleLeaves {
 public:
  TriangleLeaves() = default;
  explicit TriangleLeaves(std::size_t references)
      : coordinates_(9 * references + overrun), ids_(references) {}

  /// Those of a tree whose leaves name items: `references` from a node's link, as many as its count.
  template <class Nodes>
  TriangleLeaves(const std::vector<StoredTriangle<T>>& items, const Nodes& nodes,
                 std::span<const std::uint32_t> references, int threads)
      : TriangleLeaves(references.size()) {
    const BuildTasks tasks(threads);
    tasks.run([&] {
      tasks.pieces(nodes.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          if (nodes[i].leaf()) put(nodes[i].link, items, references.subspan(nodes[i].link, nodes[i].count));
      });
    });
  }

  /// Fills the leaf that begins at reference `first` with the items of the given numbers.
  template <class Numbers>
  void put(std::size_t first, const std::vector<StoredTriangle<T>>& items, const Numbers& numbers) {
    const std::size_t n = numbers.size();
    for (std::size_t i = 0; i < n; ++i) {
      const StoredTriangle<T>& item = items[numbers[i]];
      T* column = coordinates_.data() + 9 * first + i;
      for (const auto* corner : {&item.triangle.a, &item.triangle.b, &item.triangle.c})
        for (int k = 0; k < 3; ++k, column += n) *column = (*corner)[k];
      ids_[first + i] = item.id;
    }
  }

  std::size_t size() const { return ids_.size(); }
  std::size_t bytes() const { return coordinates_.capacity() * sizeof(T) + ids_.capacity() * sizeof(Id); }
  /// The rows of a leaf that begins at reference `first`.
  const T* rows(std::size_t first) const { return coordinates_.data() + 9 * first; }
  /// Triangle i of the leaf of n that begins at reference `first`.
  StoredTriangle<T> get(std::size_t first, std::size_t n, std::size_t i) const {
    const T* column = rows(first) + i;
    const auto corner = [&](std::size_t c) {
      return geometry::Vec<T, 3>{column[3 * c * n], column[(3 * c + 1) * n], column[(3 * c + 2) * n]};
    };
    return {{corner(0), corner(1), corner(2)}, ids_[first + i]};
  }

 private:
  static constexpr std::size_t overrun = 8;  // how far past the end of a row kernels may read

  std::vector<T> coordinates_;
  std::vector<Id> ids_;
};

}  // namespace treeline::accel
