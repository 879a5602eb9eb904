// What every tree over triangles is built from: the finite triangles of the input with their ids, where
// triangle_place.hpp puts them, and the point from which tolerances are measured.
//
// Triangles of exactly no area are set apart: no ray hits them, and many of them, long and thin, spoil every
// split. Closest points may lie on them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "accel/concepts.hpp"
#include "accel/triangle_place.hpp"
#include "geometry/mesh.hpp"
#include "geometry/predicates.hpp"

namespace treeline::accel {

/// A triangle as trees keep it: by value, beside its id in the input.
template <class T>
struct StoredTriangle {
  geometry::Triangle<T> triangle;
  Id id;
};

template <class T>
struct TriangleSet {
  std::vector<StoredTriangle<T>> items;
  std::vector<StoredTriangle<T>> flat;  // those of no area
  geometry::Box<T, 3> bounds;           // of items, as the centre where the tree keeps them
  geometry::Vec<T, 3> centre{};         // of most of them, wherever a few others may lie
  TrianglePlace<T> place;
  std::size_t dropped = 0;  // not finite

  TriangleSet(std::span<const geometry::Triangle<T>> triangles, const BuildOptions& options) {
    fill(triangles.size(), options, [&](std::size_t i) { return triangles[i]; });
  }
  TriangleSet(const geometry::Mesh<T>& mesh, const BuildOptions& options) {
    fill(mesh.size(), options, [&](std::size_t i) {
      for (const std::uint32_t corner : mesh.faces[i])
        if (corner >= mesh.vertices.size())
          throw InvalidInput("face " + std::to_string(i) + " names vertex " + std::to_string(corner) +
                             " of " + std::to_string(mesh.vertices.size()));
      return mesh.triangle(i);
    });
  }

  /// Those of no area alone, in the same place, measured from the same centre.
  TriangleSet flat_only() && {
    TriangleSet r;
    r.items = std::move(flat), r.centre = centre, r.place = place;
    for (const auto& item : r.items) r.bounds.grow(item.triangle.box());
    return r;
  }

 private:
  TriangleSet() = default;
  template <class Get>
  void fill(std::size_t n, const BuildOptions& options, Get&& get) {
    if (options.leaf_size < 1)
      throw InvalidInput("leaf_size is " + std::to_string(options.leaf_size) + "; it must be at least 1");
    if (n >= no_id) throw InvalidInput(std::to_string(n) + " triangles; ids have 32 bits");
    items.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const geometry::Triangle<T> triangle = get(i);
      if (is_finite(triangle)) {
        (is_degenerate(triangle) ? flat : items).push_back({triangle, static_cast<Id>(i)});
      } else if (options.non_finite == NonFinite::refuse) {
        throw InvalidInput("triangle " + std::to_string(i) + " has a coordinate that is not finite");
      } else {
        ++dropped;
      }
    }
    choose_place();
    if (place.changes()) each([&](geometry::Triangle<T>& t) { t = place.kept(t); });
    for (const auto& item : items) bounds.grow(item.triangle.box());
    choose_centre();
  }

  template <class F>
  void each(F&& f) {
    for (auto* kept : {&items, &flat})
      for (auto& item : *kept) f(item.triangle);
  }
  static T middle_of(std::vector<T>& sample) {
    const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
    std::nth_element(sample.begin(), middle, sample.end());
    return *middle;
  }

  /// The median over a sample, along each axis.
  void choose_centre() {
    const auto& most = items.empty() ? flat : items;
    const std::size_t step = most.size() / 1024 + 1;
    for (int k = 0; k < 3 && !most.empty(); ++k) {
      std::vector<T> sample;
      for (std::size_t i = 0; i < most.size(); i += step) sample.push_back(most[i].triangle.a[k]);
      centre[k] = middle_of(sample);
    }
  }

  /// The scale by the median over a sample, so that no outlier decides; corners at the centre do not count.
  void choose_place() {
    geometry::Box<T, 3> all;
    each([&](const geometry::Triangle<T>& t) { all.grow(t.box()); });
    const geometry::Vec<T, 3> origin = exact_centre(all);
    std::vector<T> sample;
    const std::size_t step = (items.size() + flat.size()) / 1024 + 1;
    std::size_t i = 0;
    T largest = 0;
    each([&](const geometry::Triangle<T>& t) {
      T magnitude = 0;
      for (const auto& corner : {t.a, t.b, t.c})
        for (int k = 0; k < 3; ++k) magnitude = std::max(magnitude, std::abs(corner[k] - origin[k]));
      largest = std::max(largest, magnitude);
      if (i++ % step == 0 && magnitude > T(0)) sample.push_back(magnitude);
    });
    if (sample.empty()) sample.push_back(largest);
    place = TrianglePlace<T>(origin, TriangleScale<T>(middle_of(sample), largest));
  }
};

}  // namespace treeline::accel
