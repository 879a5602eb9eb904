// Triangles put into the order in which a tree's leaves first reference them, so that a leaf's triangles lie
// side by side.
#pragma once

#include <vector>

#include "accel/triangle_set.hpp"

namespace treeline::accel {

/// Reorders `triangles` and renumbers `references` alike. Triangles that no leaf references come last.
template <class T>
void put_in_leaf_order(std::vector<StoredTriangle<T>>& triangles, std::vector<std::uint32_t>& references) {
  std::vector<std::uint32_t> place(triangles.size(), no_id);
  std::vector<StoredTriangle<T>> ordered;
  ordered.reserve(triangles.size());
  const auto put = [&](std::size_t i) {
    if (place[i] != no_id) return;
    place[i] = static_cast<std::uint32_t>(ordered.size());
    ordered.push_back(triangles[i]);
  };
  for (std::uint32_t& reference : references) {
    put(reference);
    reference = place[reference];
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) put(i);
  triangles = std::move(ordered);
}

}  // namespace treeline::accel
