// Directions of a batch: each component in an array of its own, as vector registers read them.
#pragma once

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

#include "geometry/vec.hpp"
#include "shading/brdf/batch_registers.hpp"

namespace treeline::shading::brdf {

/// Three components, one array each: unit vectors in the surface's frame (z along the normal), or red, green
/// and blue. All three are of the same size.
template <class T>
struct Components {
  std::span<T> x, y, z;

  Components() = default;
  Components(std::span<T> first, std::span<T> second, std::span<T> third) : x(first), y(second), z(third) {}
  Components(const Components<std::remove_const_t<T>>& a) requires std::is_const_v<T>
      : x(a.x), y(a.y), z(a.z) {}
};
using Directions = Components<const float>;
using DirectionsOut = Components<float>;
using ColoursOut = Components<float>;

namespace batch {

struct Floats3 {
  Floats x, y, z;

  friend Floats3 operator+(const Floats3& a, const Floats3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
};
inline Floats dot(const Floats3& a, const Floats3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Directions of which each entry of a batch has its own.
struct Each {
  const float *x, *y, *z;

  explicit Each(const Directions& d) : x(d.x.data()), y(d.y.data()), z(d.z.data()) {}
  template <class At>
  Floats3 load(const At& at) const {
    return {at.load(x), at.load(y), at.load(z)};
  }
};

/// One direction for all entries of a batch.
struct Same {
  float x, y, z;

  explicit Same(const geometry::Vec3f& d) : x(d[0]), y(d[1]), z(d[2]) {}
  template <class At>
  Floats3 load(const At&) const {
    return {floats(x), floats(y), floats(z)};
  }
};

struct Out3 {
  float *x, *y, *z;

  explicit Out3(const Components<float>& d) : x(d.x.data()), y(d.y.data()), z(d.z.data()) {}
  template <class At>
  void store(const At& at, const Floats3& a) const {
    at.store(x, a.x), at.store(y, a.y), at.store(z, a.z);
  }
};

/// Throws std::invalid_argument unless all of a batch's arrays have n entries.
inline void check_size(std::size_t n, std::size_t size, const char* name) {
  if (size != n)
    throw std::invalid_argument(std::string("batch of ") + std::to_string(n) + " entries: " + name + " has " +
                                std::to_string(size));
}
template <class T>
void check_size(std::size_t n, const Components<T>& c, const char* name) {
  check_size(n, c.x.size(), name), check_size(n, c.y.size(), name), check_size(n, c.z.size(), name);
}
inline void check_size(std::size_t, const geometry::Vec3f&, const char*) {}

inline Each source(const Directions& d) { return Each(d); }
inline Same source(const geometry::Vec3f& d) { return Same(d); }

}  // namespace batch
}  // namespace treeline::shading::brdf
