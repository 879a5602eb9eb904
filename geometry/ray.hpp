// Rays: the points origin + t·direction for t in the closed interval [t_min, t_max].
#pragma once

#include "geometry/vec.hpp"

namespace treeline::geometry {

template <class T>
struct Ray {
  Vec<T, 3> origin;
  Vec<T, 3> direction;  // any length but zero; t is measured in its length
  T t_min = T(0);
  T t_max = std::numeric_limits<T>::infinity();

  Vec<T, 3> at(T t) const { return origin + direction * t; }
};

using Rayf = Ray<float>;
using Rayd = Ray<double>;

}  // namespace treeline::geometry
