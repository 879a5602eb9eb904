// The query sets of a block: what is asked of a cloud.
//
// knn1_self, knn8_self, knn32_self, knn100_self: points of the cloud itself, in random order. knn8_sorted:
// the same along a Morton curve, so that the next query finds the last one's cells in the cache. knn1_off,
// knn8_off, knn32_off: uniform in the cloud's box, enlarged by a tenth: positions off its surface, where
// published benchmarks seldom look. knn8_far: few, from all around at two to four diagonals of the box, where
// whole faces of the cloud are about as near. radius_self: a radius that holds 30 neighbours on average.
// box_self: cubes around points, 30 points on average.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "bench/knn/double_scan.hpp"
#include "datasets_gen/hard/hard_case.hpp"

namespace treeline::bench::knn {

/// What does not depend on the points' scalar.
struct QuestionKinds {
  enum class Kind { nearest, within, inside };
  enum Place { self, sorted, off, far };
  static constexpr int places = 4;
  struct Set {
    std::string name;
    Kind kind = Kind::nearest;
    std::size_t k = 0;
    Place place = self;
  };
};

template <class T>
struct QuestionsOf : QuestionKinds {
  using Point = geometry::Vec<T, 3>;

  std::vector<Set> sets;
  std::array<std::vector<Point>, places> points;  // by place
  std::vector<std::uint32_t> order;               // sorted[i] is self[order[i]]
  std::vector<geometry::Box<T, 3>> boxes;
  T radius = 0;
  double spacing = 0;  // median distance from a point to its nearest other one

  const std::vector<Point>& points_of(const Set& set) const { return points[set.place]; }
  std::size_t size_of(const Set& set) const {
    return set.kind == Kind::inside ? boxes.size() : points_of(set).size();
  }
};

using Questions = QuestionsOf<float>;

/// All sets, at most `count` queries each. Equal clouds and seeds give equal questions, with any number of
/// threads. Throws std::invalid_argument if no point of the cloud is finite.
template <class T>
QuestionsOf<T> questions_about(const ScanOf<T>& cloud, std::size_t count, std::uint64_t seed, int threads);

/// The queries of a hard case at its k, and, where it has a radius, radius and box queries (the cube of
/// that half width) too. Boxes are left out if a query is not finite or the radius negative.
Questions questions_of(const datasets::HardCase& hard_case, const DoubleScan& cloud);

}  // namespace treeline::bench::knn
