// Sorts numbers by unsigned keys, equal ones in the order in which they came.
//
// A pass for each eight bits from the lowest; those in which all keys agree are left out. In pieces on
// several threads: each counts its keys, and knows from the counts of all where its own go. Cost: O(n) per
// pass, and as much memory again.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <vector>

#include "accel/bvh/build_tasks.hpp"

namespace treeline::accel {

template <std::unsigned_integral Key>
struct SortItem {
  Key key;
  std::uint32_t value;
};

/// Of the same order as the float, which is not NaN.
inline std::uint32_t sortable(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

template <class Key>
void radix_sort(std::vector<SortItem<Key>>& items, const BuildTasks& tasks) {
  constexpr std::size_t digits = 256;
  using Counts = std::array<std::uint32_t, digits>;
  const std::size_t n = items.size();
  if (n < 2) return;
  std::vector<SortItem<Key>> other(n);
  std::vector<Counts> counts((n + BuildTasks::piece - 1) / BuildTasks::piece);
  for (int shift = 0; shift < static_cast<int>(8 * sizeof(Key)); shift += 8) {
    const auto digit = [shift](const SortItem<Key>& item) {
      return static_cast<std::size_t>(item.key >> shift) & (digits - 1);
    };
    tasks.pieces(n, [&](std::size_t begin, std::size_t end) {
      Counts& mine = counts[begin / BuildTasks::piece];
      mine = {};
      for (std::size_t i = begin; i < end; ++i) ++mine[digit(items[i])];
    });
    std::uint32_t before = 0, most = 0;
    for (std::size_t d = 0; d < digits; ++d) {
      const std::uint32_t first = before;
      for (Counts& c : counts) before += std::exchange(c[d], before);
      most = std::max(most, before - first);
    }
    if (most == n) continue;
    tasks.pieces(n, [&](std::size_t begin, std::size_t end) {
      Counts& to = counts[begin / BuildTasks::piece];
      for (std::size_t i = begin; i < end; ++i) other[to[digit(items[i])]++] = items[i];
    });
    items.swap(other);
  }
}

}  // namespace treeline::accel
