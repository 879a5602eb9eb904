// The triangles that a wide tree is built over: those of the input that a ray can hit, moved to where float
// is finest.
//
// Triangles that are not finite are refused or dropped, those of exactly no area are dropped, both counted;
// the latter are set aside, as a point may be nearest to them.
// Along each axis on which all coordinates have one sign and lie within a factor of two of each other, the
// origin moves to the middle: there the subtraction is exact (Sterbenz 1974), so a mesh far from the origin
// is as it was, and queries do not lose the digits that its place takes; along the others nothing is to be
// won. What is very large or small is scaled by a power of two (triangle_scale.hpp). Cost: one pass, some 10
// ns a triangle.
#pragma once

#include <array>
#include <atomic>
#include <string>
#include <vector>

#include "accel/batch.hpp"
#include "accel/bvh/wide_layout.hpp"
#include "accel/triangle_scale.hpp"
#include "geometry/mesh.hpp"
#include "geometry/predicates.hpp"

namespace treeline::accel {

class TriangleInput {
 public:
  using Triangle = geometry::Triangle<float>;
  using Point = geometry::Vec<float, 3>;
  using Box = geometry::Box<float, 3>;
  using Ray = geometry::Ray<float>;

  TriangleInput(std::span<const Triangle> triangles, NonFinite non_finite, int threads) {
    fill(triangles.size(), non_finite, threads, [&](std::size_t i) { return triangles[i]; });
  }
  TriangleInput(const geometry::Mesh<float>& mesh, NonFinite non_finite, int threads) {
    fill(mesh.size(), non_finite, threads, [&](std::size_t i) {
      for (const std::uint32_t corner : mesh.faces[i])
        if (corner >= mesh.vertices.size())
          throw InvalidInput("face " + std::to_string(i) + " names vertex " + std::to_string(corner) +
                             " of " + std::to_string(mesh.vertices.size()));
      return mesh.triangle(i);
    });
  }

  std::span<const Triangle> triangles() const { return {triangles_.data(), size_}; }
  /// Of the input, in order of triangles(); empty where they are the same.
  std::span<const Id> ids() const { return ids_; }
  std::size_t dropped() const { return dropped_; }
  /// An input of its own: the finite triangles of no area, all kept.
  TriangleInput without_area(int threads) const { return TriangleInput(aside_, aside_ids_, threads); }

  /// How the user's space became the tree's: scaled, then moved.
  struct Place {
    alignas(16) Point centre{};  // in the user's space
    float unused = 0;
    alignas(16) Point scaled_centre{};
    float unused_too = 0;
    TriangleScale<float> scale;
    Box bounds;       // in the tree's space
    float reach = 0;  // the largest of its coordinates

    Point to_user(const Point& p) const { return scale.unscaled(p) + centre; }
  };
  const Place& place() const { return place_; }

 private:
  static constexpr std::size_t chunk = 1 << 14;

  TriangleInput(const std::vector<Triangle>& triangles, const std::vector<Id>& ids, int threads)
      : triangles_(triangles.size()), size_(triangles.size()), ids_(ids) {
    Box box;
    for (std::size_t i = 0; i < size_; ++i) triangles_[i] = triangles[i], box.grow(triangles[i].box());
    settle(box, threads);
  }
  enum class Fate : std::uint8_t { kept, not_finite, no_area };

  template <class Get>
  void fill(std::size_t n, NonFinite non_finite, int threads, Get&& get) {
    if (n >= no_id) throw InvalidInput(std::to_string(n) + " triangles; ids have 32 bits");
    check_threads(threads);
    triangles_ = wide::AlignedArray<Triangle>(n);
    size_ = n;
    const std::size_t chunks = (n + chunk - 1) / chunk;
    std::vector<Box> boxes(chunks);
    std::vector<std::uint8_t> has_bad(chunks);
    by_chunk(chunks, threads, [&](std::size_t c) {
      Box box;
      bool bad = false;
      for (std::size_t i = c * chunk; i < std::min(n, (c + 1) * chunk); ++i) {
        const Triangle t = triangles_[i] = get(i);
        bad |= fate_of(t) != Fate::kept;
        box.grow(t.a), box.grow(t.b), box.grow(t.c);
      }
      boxes[c] = box, has_bad[c] = bad;
    });
    bool any_bad = false;
    Box box;
    for (std::size_t c = 0; c < chunks; ++c) any_bad = any_bad || has_bad[c], box.grow(boxes[c]);
    if (any_bad) box = drop_bad(non_finite);
    settle(box, threads);
  }

  template <class F>
  static void by_chunk(std::size_t chunks, int threads, F&& f) {
#ifndef __SANITIZE_THREAD__
    if (threads > 1 && chunks > 1) {
      tbb::task_arena arena(allowed_threads(threads));
      return arena.execute([&] { tbb::parallel_for(std::size_t{0}, chunks, f); });
    }
#endif
    for (std::size_t c = 0; c < chunks; ++c) f(c);
  }

  static Fate fate_of(const Triangle& t) {
    return !is_finite(t) ? Fate::not_finite : is_degenerate(t) ? Fate::no_area : Fate::kept;
  }

  Box drop_bad(NonFinite non_finite) {
    Box box;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const Triangle t = triangles_[i];
      const Fate fate = fate_of(t);
      if (fate == Fate::not_finite && non_finite == NonFinite::refuse)
        throw InvalidInput("triangle " + std::to_string(i) + " has a coordinate that is not finite");
      if (fate == Fate::no_area) aside_.push_back(t), aside_ids_.push_back(static_cast<Id>(i));
      if (fate != Fate::kept) continue;
      box.grow(t.box());
      triangles_[kept++] = t;
      ids_.push_back(static_cast<Id>(i));
    }
    dropped_ = size_ - kept, size_ = kept;
    return box;
  }

  /// Chooses the place, by the median over a sample for scale, so that no outlier decides, and moves there.
  void settle(const Box& box, int threads) {
    place_.bounds = box;
    if (size_ == 0) return;
    for (int k = 0; k < 3; ++k) {
      const float near = std::min(std::abs(box.low[k]), std::abs(box.high[k])),
                  far = std::max(std::abs(box.low[k]), std::abs(box.high[k]));
      const bool one_sign = (box.low[k] > 0) == (box.high[k] > 0);
      if (one_sign && near > 0 && far / 2 <= near) place_.centre[k] = box.low[k] * 0.5f + box.high[k] * 0.5f;
    }
    const Point& centre = place_.centre;
    std::vector<float> sample;
    const std::size_t step = size_ / 1024 + 1;
    for (std::size_t i = 0; i < size_; i += step)
      for (const Point& p : {triangles_[i].a, triangles_[i].b, triangles_[i].c})
        if (const float m = largest(p - centre); m > 0) sample.push_back(m);
    const float most = std::max(largest(box.low - centre), largest(box.high - centre));
    place_.reach = most;
    if (sample.empty()) sample.push_back(most);
    const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
    std::nth_element(sample.begin(), middle, sample.end());
    place_.scale = TriangleScale<float>(*middle, most);
    place_.scaled_centre = place_.scale.scaled(centre);
    if (centre == Point{} && !place_.scale.scales()) return;
    const auto moved = [&](const Point& p) { return place_.scale.scaled(p - centre); };
    by_chunk((size_ + chunk - 1) / chunk, threads, [&](std::size_t c) {
      for (std::size_t i = c * chunk; i < std::min(size_, (c + 1) * chunk); ++i) {
        Triangle& t = triangles_[i];
        t = {moved(t.a), moved(t.b), moved(t.c)};
      }
    });
    place_.bounds = {moved(box.low), moved(box.high)};
    place_.reach = std::max(largest(place_.bounds.low), largest(place_.bounds.high));
  }
  static float largest(const Point& p) { return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}); }

  wide::AlignedArray<Triangle> triangles_;
  std::size_t size_ = 0, dropped_ = 0;
  std::vector<Id> ids_;
  std::vector<Triangle> aside_;
  std::vector<Id> aside_ids_;
  Place place_;
};

}  // namespace treeline::accel
