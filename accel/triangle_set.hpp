// What every tree over triangles is built from: the finite triangles of the input with their ids, scaled (see
// triangle_scale.hpp) where their size asks for it, and the point from which tolerances are measured.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "accel/concepts.hpp"
#include "accel/triangle_scale.hpp"
#include "geometry/mesh.hpp"

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
  geometry::Box<T, 3> bounds;    // of the scaled triangles
  geometry::Vec<T, 3> centre{};  // of most of the scaled triangles, wherever a few others may lie
  TriangleScale<T> scale;
  std::size_t dropped = 0;

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

 private:
  template <class Get>
  void fill(std::size_t n, const BuildOptions& options, Get&& get) {
    if (options.leaf_size < 1)
      throw InvalidInput("leaf_size is " + std::to_string(options.leaf_size) + "; it must be at least 1");
    if (n >= no_id) throw InvalidInput(std::to_string(n) + " triangles; ids have 32 bits");
    items.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const geometry::Triangle<T> triangle = get(i);
      if (is_finite(triangle)) {
        items.push_back({triangle, static_cast<Id>(i)});
      } else if (options.non_finite == NonFinite::refuse) {
        throw InvalidInput("triangle " + std::to_string(i) + " has a coordinate that is not finite");
      } else {
        ++dropped;
      }
    }
    choose_scale();
    for (auto& item : items) {
      geometry::Triangle<T>& t = item.triangle;
      if (scale.scales()) t = {scale.scaled(t.a), scale.scaled(t.b), scale.scaled(t.c)};
      bounds.grow(t.box());
    }
    choose_centre();
  }

  /// The median over a sample, along each axis.
  void choose_centre() {
    const std::size_t step = items.size() / 1024 + 1;
    for (int k = 0; k < 3 && !items.empty(); ++k) {
      std::vector<T> sample;
      for (std::size_t i = 0; i < items.size(); i += step) sample.push_back(items[i].triangle.a[k]);
      const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
      std::nth_element(sample.begin(), middle, sample.end());
      centre[k] = *middle;
    }
  }

  /// By the median over a sample, so that no outlier decides; corners at the origin do not count.
  void choose_scale() {
    std::vector<T> sample;
    const std::size_t step = items.size() / 1024 + 1;
    T largest = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
      T magnitude = 0;
      for (const auto& corner : {items[i].triangle.a, items[i].triangle.b, items[i].triangle.c})
        for (int k = 0; k < 3; ++k) magnitude = std::max(magnitude, std::abs(corner[k]));
      largest = std::max(largest, magnitude);
      if (magnitude > T(0) && i % step == 0) sample.push_back(magnitude);
    }
    if (sample.empty()) sample.push_back(largest);
    const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
    std::nth_element(sample.begin(), middle, sample.end());
    scale = TriangleScale<T>(*middle, largest);
  }
};

}  // namespace treeline::accel
