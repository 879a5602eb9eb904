// What a search collects where squares in T say too little: points measured in a wider type.
//
// Every tree ranks them alike, so that answers do not depend on the tree: by rank_of (point_measure.hpp),
// ties by id. Boxes are ranked by bounds computed by the same operations, all monotone under rounding, so
// that they may prune by ranks, too.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "accel/k_best.hpp"
#include "accel/point_set.hpp"

namespace treeline::accel {

/// A query to be ranked against points of a set, and the same in scaled coordinates.
template <class T, int D>
struct WideQuery {
  using Wide = SquareOf<T>;
  using Point = geometry::Vec<T, D>;

  const PointSet<T, D>& set;
  Point scaled;
  geometry::Vec<Wide, D> wide;
  bool small;

  WideQuery(const PointSet<T, D>& points, const Point& q)
      : set(points), scaled(points.scaled(q)), wide(points.wide_scaled(q)), small(points.is_small(scaled)) {}

  Wide rank(T distance2, Wide wide_distance2) const { return rank_of<T>(distance2, wide_distance2, small); }
  T told_square(Wide rank) const { return set.told_square(rank, small); }
};

/// A visitor that takes all points within reach; their distances are ranks.
template <class T, int D>
class Candidates {
 public:
  using Wide = SquareOf<T>;
  std::vector<Neighbor<Wide>> list;

  Candidates(const WideQuery<T, D>& query, const Reach<T>& reach) : query_(query), reach_(reach) {}
  T limit() const { return reach_.square; }
  bool offer(const PointEntry<T, D>& e, T distance2) {
    const Wide wide = query_.set.wide_square(e, query_.wide);
    if (!reach_(distance2, wide)) return false;
    list.push_back({query_.rank(distance2, wide), e.id});
    return true;
  }

 private:
  const WideQuery<T, D>& query_;
  Reach<T> reach_;
};

/// A visitor that keeps the k best by rank among points within reach. Of equal points it sees no more than
/// one that it does not take.
template <class T, int D>
class BestCandidates {
 public:
  using Wide = SquareOf<T>;

  /// `best` must not be empty; places that nothing takes keep no_id.
  BestCandidates(const WideQuery<T, D>& query, const Reach<T>& reach, std::span<Neighbor<Wide>> best)
      : best_(best), query_(query), reach_(reach), limit_(reach.square) {}
  const WideQuery<T, D>& query() const { return query_; }
  /// No point that is farther, as T computes it, is wanted.
  T limit() const { return limit_; }
  /// Whether something of at least these distances, with no lower id, may be wanted.
  bool wants(T distance2, Wide wide, Id id) const {
    return reach_(distance2, wide) && Neighbor<Wide>{query_.rank(distance2, wide), id} < best_.worst();
  }
  bool offer(const PointEntry<T, D>& e, T distance2) {
    if (!(distance2 <= limit_)) return false;
    const Wide wide = query_.set.wide_square(e, query_.wide);
    if (!reach_(distance2, wide) || !best_.offer(query_.rank(distance2, wide), e.id)) return false;
    if (best_.full()) limit_ = std::min(reach_.square, limit_of(best_.worst().distance2));
    return true;
  }
  void finish() { best_.finish(); }

 private:
  T limit_of(Wide rank) const {
    if (rank > static_cast<Wide>(std::numeric_limits<T>::max())) return std::numeric_limits<T>::infinity();
    if (query_.small && rank < static_cast<Wide>(vague_square<T>())) return vague_square<T>();
    return static_cast<T>(rank);  // which it was
  }

  HeapBest<Wide> best_;
  const WideQuery<T, D>& query_;
  Reach<T> reach_;
  T limit_;
};

}  // namespace treeline::accel
