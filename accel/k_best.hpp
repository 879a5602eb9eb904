// What a search for neighbours collects: the k best so far (a sorted list for small k, a binary heap above),
// or all within a radius. `limit` is the squared distance above which nothing more is wanted.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "accel/concepts.hpp"
#include "accel/point_measure.hpp"

namespace treeline::accel {

/// Insertion into a sorted list: k / 2 moves of 8 or 16 bytes, with no branch to mispredict but the last.
template <class T>
class SortedBest {
 public:
  /// `best` must not be empty; it holds the answer afterwards, nearest first.
  /// Places that nothing within `within` takes keep no_id.
  explicit SortedBest(std::span<Neighbor<T>> best, T within = std::numeric_limits<T>::infinity())
      : best_(best) {
    std::ranges::fill(best_, Neighbor<T>{within, no_id});
  }
  T limit() const { return best_.back().distance2; }
  bool full() const { return best_.back().id != no_id; }
  const Neighbor<T>& worst() const { return best_.back(); }
  bool offer(T distance2, Id id) {
    const Neighbor<T> candidate{distance2, id};
    if (!(candidate < best_.back())) return false;
    std::size_t i = best_.size() - 1;
    for (; i > 0 && candidate < best_[i - 1]; --i) best_[i] = best_[i - 1];
    best_[i] = candidate;
    return true;
  }
  void finish() {}

  static constexpr std::size_t largest_k = 96;  // measured on 3e5 float points: as fast as the heap at 128

 private:
  std::span<Neighbor<T>> best_;
};

/// A binary heap with the worst on top: log2 k moves.
template <class T>
class HeapBest {
 public:
  explicit HeapBest(std::span<Neighbor<T>> best, T within = std::numeric_limits<T>::infinity())
      : best_(best) {
    std::ranges::fill(best_, Neighbor<T>{within, no_id});
  }
  T limit() const { return best_.front().distance2; }
  bool full() const { return best_.front().id != no_id; }
  const Neighbor<T>& worst() const { return best_.front(); }
  bool offer(T distance2, Id id) {
    const Neighbor<T> candidate{distance2, id};
    if (!(candidate < best_.front())) return false;
    std::size_t hole = 0;
    for (std::size_t child; (child = 2 * hole + 1) < best_.size(); hole = child) {
      if (child + 1 < best_.size() && best_[child] < best_[child + 1]) ++child;
      if (!(candidate < best_[child])) break;
      best_[hole] = best_[child];
    }
    best_[hole] = candidate;
    return true;
  }
  void finish() { std::sort(best_.begin(), best_.end()); }

 private:
  std::span<Neighbor<T>> best_;
};

/// Cuts a search short: once there are k, cells that promise less than the factor's gain (but none so near
/// that squares have lost digits); and all once the leaves are used up, though not before there are k if it
/// `fills`.
template <class T, class Best>
class Hasty {
 public:
  Hasty(Best& best, T shrink, std::size_t leaves, bool fills)
      : best_(best), shrink_(shrink), leaves_(leaves), fills_(fills) {}
  T limit() const {
    const bool full = best_.full();
    if (leaves_ == 0 && (!fills_ || full)) return T(-1);
    const T limit = best_.limit();
    return full ? std::max(limit * shrink_, std::min(limit, vague_square<T>())) : limit;
  }
  bool offer(T distance2, Id id) { return best_.offer(distance2, id); }
  void enter_leaf() { leaves_ -= leaves_ > 0; }
  std::size_t leaves_left() const { return leaves_; }

 private:
  Best& best_;
  T shrink_;  // of the squared distance
  std::size_t leaves_;
  bool fills_;
};

template <class T>
class CountWithin {
 public:
  explicit CountWithin(T limit) : limit_(limit) {}
  T limit() const { return limit_; }
  bool offer(T distance2, Id) { return distance2 <= limit_ && ++count; }
  std::size_t count = 0;

 private:
  T limit_;
};

template <class T>
class WithinRadius {
 public:
  WithinRadius(T limit, std::vector<Neighbor<T>>& list) : limit_(limit), list_(&list) {}
  T limit() const { return limit_; }
  bool offer(T distance2, Id id) {
    if (!(distance2 <= limit_)) return false;
    list_->push_back({distance2, id});
    return true;
  }

 private:
  T limit_;
  std::vector<Neighbor<T>>* list_;
};

}  // namespace treeline::accel
