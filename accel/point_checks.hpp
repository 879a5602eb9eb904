// What indices over points refuse, and what they say then.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "accel/concepts.hpp"

namespace treeline::accel {

template <class T, int D>
struct PointChecks {
  using Point = geometry::Vec<T, D>;
  using Box = geometry::Box<T, D>;
  static constexpr std::size_t no_index = static_cast<std::size_t>(-1);

  static void check_k(std::size_t k) {
    if (k == 0) throw InvalidInput("k is 0; it must be at least 1");
  }
  static void check_options(const NearestOptions<T>& options) {
    if (!(options.max_distance >= 0))
      throw InvalidInput("max_distance is " + std::to_string(options.max_distance) +
                         "; it must be at least 0");
    if (!(options.epsilon >= 0) || std::isinf(options.epsilon))
      throw InvalidInput("epsilon is " + std::to_string(options.epsilon) +
                         "; it must be finite and at least 0");
    if (options.max_leaves == 0) throw InvalidInput("max_leaves is 0; it must be at least 1");
  }
  static void check_radius(T radius) {
    if (!(radius >= 0)) throw InvalidInput("radius is " + std::to_string(radius) + "; it must be at least 0");
  }
  static void check_radius2(T radius2) {
    if (!(radius2 >= 0))
      throw InvalidInput("radius2 is " + std::to_string(radius2) + "; it must be at least 0");
  }
  static void check_room(std::size_t have, std::size_t need) {
    if (have < need)
      throw InvalidInput("out holds " + std::to_string(have) + " answers; it must hold " +
                         std::to_string(need));
  }
  /// Of a batch.
  static void check_rows(std::size_t have, std::size_t queries, std::size_t k) {
    if (have / k >= queries) return;  // the product below may wrap around
    if (queries <= static_cast<std::size_t>(-1) / k) check_room(have, queries * k);
    throw InvalidInput("out holds " + std::to_string(have) + " answers; it must hold " + std::to_string(k) +
                       " for each query");
  }
  static void check_query(const Point& q, const char* what, std::size_t i = no_index) {
    if (!geometry::is_finite(q))
      throw InvalidInput(numbered(what, i) + " has a coordinate that is not finite");
  }
  static void check_queries(std::span<const Point> queries) {
    for (std::size_t i = 0; i < queries.size(); ++i) check_query(queries[i], "query", i);
  }
  static void check_box(const Box& box, const char* what, std::size_t i = no_index) {
    for (int a = 0; a < D; ++a)
      if (std::isnan(box.low[a]) || std::isnan(box.high[a]))
        throw InvalidInput(numbered(what, i) + " has a bound that is not a number");
  }
  static void check_boxes(std::span<const Box> boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i) check_box(boxes[i], "box", i);
  }

 private:
  static std::string numbered(const char* what, std::size_t i) {
    std::string name(what);
    if (i != no_index) name.append(1, ' ').append(std::to_string(i));
    return name;
  }
};

}  // namespace treeline::accel
