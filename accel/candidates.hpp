// What a search collects where squares in T say too little: points measured in a wider type.
//
// Every tree ranks them alike, so that answers do not depend on the tree: by the wider squared distance,
// rounded to T where T tells distances apart (equal ones are ties then, as in any other answer), ties by id.
// Bounds of boxes are computed by the same operations, all monotone under rounding (see point_set.hpp), so
// that they, too, may prune in the wider type.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "accel/k_best.hpp"
#include "accel/point_set.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel {

template <class T, class S, int D>
S wide_distance2(const geometry::Vec<T, D>& p, const geometry::Vec<S, D>& q) {
  S offsets[D];
  for (int a = 0; a < D; ++a) offsets[a] = static_cast<S>(p[a]) - q[a];
  return squared_length<S, D>(offsets);
}
template <class T, class S, int D>
S wide_distance2(const geometry::Box<T, D>& box, const geometry::Vec<S, D>& q) {
  S offsets[D];
  for (int a = 0; a < D; ++a)
    offsets[a] = interval_offset(static_cast<S>(box.low[a]), static_cast<S>(box.high[a]), q[a]);
  return squared_length<S, D>(offsets);
}

/// As ranks compare it. Monotone: the least square that is rounded is a power of two.
template <class T>
typename SquareType<T>::Type rank_of(typename SquareType<T>::Type distance2) {
  const bool told =
      distance2 >= std::ldexp(T(1), vague_exponent<T>) && distance2 <= std::numeric_limits<T>::max();
  return told ? static_cast<T>(distance2) : distance2;
}

/// A visitor that takes all points within a squared distance as T sees it; their distances are not rounded.
template <class T, int D>
class Candidates {
 public:
  using Wide = typename SquareType<T>::Type;
  std::vector<Neighbor<Wide>> list;

  /// The query in scaled coordinates, neither rounded nor held.
  Candidates(const geometry::Vec<Wide, D>& query, T limit) : query_(query), limit_(limit) {}
  T limit() const { return limit_; }
  bool offer(const PointEntry<T, D>& e, T distance2) {
    if (!(distance2 <= limit_)) return false;
    list.push_back({wide_distance2(e.point, query_), e.id});
    return true;
  }

 private:
  geometry::Vec<Wide, D> query_;
  T limit_;
};

/// A visitor that keeps the k best by rank, among points within a squared distance as T sees it and within
/// one in the wider type. Of equal points it sees no more than one that it does not take.
template <class T, int D>
class BestCandidates {
 public:
  using Wide = typename SquareType<T>::Type;
  using Query = geometry::Vec<Wide, D>;

  /// `best` must not be empty; places that nothing takes keep no_id.
  BestCandidates(const Query& query, T reach, Wide within, std::span<Neighbor<Wide>> best)
      : best_(best), query_(query), reach_(reach), limit_(reach), within_(within) {}
  const Query& query() const { return query_; }
  T limit() const { return limit_; }
  /// Whether something at least so far away, with no lower id, may be wanted.
  bool wants(Wide distance2, Id id) const {
    return distance2 <= within_ && Neighbor<Wide>{rank_of<T>(distance2), id} < best_.worst();
  }
  bool offer(const PointEntry<T, D>& e, T distance2) {
    if (!(distance2 <= reach_)) return false;
    const Wide wide = wide_distance2(e.point, query_);
    if (!(wide <= within_) || !best_.offer(rank_of<T>(wide), e.id)) return false;
    if (best_.full()) limit_ = std::min(reach_, reach_of(best_.worst().distance2));
    return true;
  }
  void finish() { best_.finish(); }

 private:
  /// No point as near as this is farther away in T: T's distance is off by gamma(D + 2), unless it vanishes.
  static T reach_of(Wide distance2) {
    if (distance2 > std::numeric_limits<T>::max()) return std::numeric_limits<T>::infinity();
    const T stretched = static_cast<T>(distance2) * (1 + 2 * geometry::tolerance::gamma<T>(D + 2));
    return std::max(stretched, PointSet<T, D>::vague_square());
  }

  HeapBest<Wide> best_;
  Query query_;
  T reach_, limit_;
  Wide within_;
};

}  // namespace treeline::accel
