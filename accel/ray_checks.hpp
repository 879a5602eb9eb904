// What every tree asks of the rays that it is given. Checks name what is wrong and, in batches, the index of
// the first offender, before anything is answered.
#pragma once

#include <cmath>
#include <span>
#include <string>

#include "accel/concepts.hpp"

namespace treeline::accel {

/// What is wrong with a ray; null if nothing is.
template <class T>
const char* fault_of(const geometry::Ray<T>& ray) {
  if (std::isnan(ray.t_min) || std::isnan(ray.t_max)) return "has a NaN in [t_min, t_max]";
  if (!is_finite(ray.origin)) return "has an origin that is not finite";
  if (!is_finite(ray.direction)) return "has a direction that is not finite";
  if (ray.direction == geometry::Vec<T, 3>{}) return "has a zero direction";
  return nullptr;
}

template <class T>
void check_ray(const geometry::Ray<T>& ray) {
  if (const char* what = fault_of(ray)) throw InvalidInput(std::string("ray ") + what);
}

inline void check_room(std::size_t queries, std::size_t answers) {
  if (queries != answers)
    throw InvalidInput(std::to_string(queries) + " queries, but room for " + std::to_string(answers) +
                       " answers");
}

template <class T>
void check_rays(std::span<const geometry::Ray<T>> rays, std::size_t answers) {
  check_room(rays.size(), answers);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (const char* what = fault_of(rays[i])) throw InvalidInput("ray " + std::to_string(i) + " " + what);
}

}  // namespace treeline::accel
