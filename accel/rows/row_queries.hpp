// Everything a RowIndex says, over the one search that each index must have:
//   visit(limits, scratch, visitor, work): offers rows to the visitor; scratch.query is the query, loaded;
// and, if it answers several queries of a batch better together:
//   visit_group(queries, visitors), for at most Index::group of them.
// Checks of the input, the choice of a collector, batches and scaling are here, once for all.
#pragma once

#include <span>
#include <string>

#include "accel/batch.hpp"
#include "accel/k_best.hpp"
#include "accel/rows/search.hpp"

namespace treeline::accel {

template <class Index, class T>
class RowQueries {
 public:
  using Scalar = T;

  // ---- one query: see RowIndex ------------------------------------------------------------------------

  std::size_t nearest(std::span<const T> q, std::size_t k, std::span<Neighbor<T>> out) const {
    return nearest(q, k, RowSearch{}, out);
  }
  template <WorkCounter W>
  std::size_t nearest(std::span<const T> q, std::size_t k, std::span<Neighbor<T>> out, W& work) const {
    return nearest(q, k, RowSearch{}, out, work);
  }
  std::size_t nearest(std::span<const T> q, std::size_t k, const RowSearch& search,
                      std::span<Neighbor<T>> out) const {
    NoWork work;
    return nearest(q, k, search, out, work);
  }
  template <WorkCounter W>
  std::size_t nearest(std::span<const T> q, std::size_t k, const RowSearch& search,
                      std::span<Neighbor<T>> out, W& work) const {
    check(k, search);
    check_length(q.size());
    if (!RowSet<T>::finite(q)) throw InvalidInput("query has a coordinate that is not finite");
    const std::size_t m = std::min(k, size());
    check_room(out.size(), m);
    find_nearest(q, out.first(m), search, work);
    return m;
  }

  /// A batch: the answers of query i are out[i·k] … out[i·k + k - 1].
  void nearest(RowsView<T> queries, std::size_t k, std::span<Neighbor<T>> out, int threads = 1) const {
    nearest(queries, k, RowSearch{}, out, threads);
  }
  void nearest(RowsView<T> queries, std::size_t k, const RowSearch& search, std::span<Neighbor<T>> out,
               int threads = 1) const {
    check(k, search);
    if (queries.rows > 0) check_length(queries.columns);
    if (queries.rows > 1 && queries.stride < queries.columns)
      throw InvalidInput("stride of the queries is " + std::to_string(queries.stride) + "; they have " +
                         std::to_string(queries.columns) + " columns");
    for (std::size_t i = 0; i < queries.rows; ++i)
      if (!RowSet<T>::finite(queries[i]))
        throw InvalidInput("query " + std::to_string(i) + " has a coordinate that is not finite");
    if (out.size() / k < queries.rows)  // the product may wrap around
      throw InvalidInput("out holds " + std::to_string(out.size()) + " answers; it must hold " +
                         std::to_string(k) + " for each of " + std::to_string(queries.rows) + " queries");
    const std::size_t m = std::min(k, size());
    parallel_ranges(queries.rows, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        std::ranges::fill(out.subspan(i * k + m, k - m), Neighbor<T>{});
      if constexpr (requires { Index::group; }) {
        for (std::size_t i = begin; i < end; i += Index::group)
          find_group(queries, i, std::min(end, i + Index::group), k, m, out);
      } else {
        NoWork work;
        for (std::size_t i = begin; i < end; ++i)
          find_nearest(queries[i], out.subspan(i * k, m), search, work);
      }
    });
  }

  // ---- what the index tells of itself -----------------------------------------------------------------

  std::size_t size() const { return set_.size(); }
  std::size_t columns() const { return set_.columns; }
  std::size_t bytes() const { return stats_.bytes; }
  TreeStats stats() const { return stats_; }

 protected:
  RowQueries(RowsView<T> rows, const BuildOptions& options) : set_(rows, options) {
    stats_.primitives = set_.size();
    stats_.dropped = set_.dropped;
  }

  RowSet<T> set_;
  TreeStats stats_;

 private:
  template <class W>
  void find_nearest(std::span<const T> q, std::span<Neighbor<T>> out, const RowSearch& search,
                    W& work) const {
    if (out.empty()) return;
    RowScratch<T>& scratch = RowScratch<T>::of_thread();
    scratch.query.assign(set_.stride, T(0));
    set_.load(q, scratch.query.data());
    if (!set_.in_range(scratch.query.data())) [[unlikely]] {
      work.primitive(size());
      return set_.rank_widely(q, out);
    }
    const auto collect = [&](auto best) {
      static_cast<const Index&>(*this).visit(search, scratch, best, work);
      best.finish();
    };
    if (out.size() <= SortedBest<T>::largest_k)
      collect(SortedBest<T>(out));
    else
      collect(HeapBest<T>(out));
    unscale(out);
  }
  /// Queries begin … end - 1, the answers of query i at out[i·k].
  void find_group(const RowsView<T>& queries, std::size_t begin, std::size_t end, std::size_t k,
                  std::size_t m, std::span<Neighbor<T>> out) const {
    if (m == 0) return;
    AlignedScalars<T>& loaded = RowScratch<T>::of_thread().group;
    loaded.assign((end - begin) * set_.stride, T(0));
    const auto collect = [&]<class Best>(std::type_identity<Best>) {
      std::vector<const T*> near;
      std::vector<Best> bests;
      for (std::size_t i = begin; i < end; ++i) {
        T* const query = loaded.data() + (i - begin) * set_.stride;
        set_.load(queries[i], query);
        if (!set_.in_range(query)) {
          set_.rank_widely(queries[i], out.subspan(i * k, m));
          continue;
        }
        near.push_back(query), bests.emplace_back(out.subspan(i * k, m));
      }
      static_cast<const Index&>(*this).visit_group(std::span<const T* const>(near), std::span(bests));
      for (auto& best : bests) best.finish();
      for (std::size_t i = begin; i < end; ++i)
        if (set_.in_range(loaded.data() + (i - begin) * set_.stride)) unscale(out.subspan(i * k, m));
    };
    if (m <= SortedBest<T>::largest_k)
      collect(std::type_identity<SortedBest<T>>{});
    else
      collect(std::type_identity<HeapBest<T>>{});
  }
  void unscale(std::span<Neighbor<T>> out) const {
    if (set_.scale != T(1))
      for (auto& n : out) n.distance2 = set_.unscaled_square(n.distance2);
  }

  // ---- refusals ---------------------------------------------------------------------------------------

  static void check(std::size_t k, const RowSearch& search) {
    if (k == 0) throw InvalidInput("k is 0; it must be at least 1");
    if (!(search.epsilon >= 0) || !std::isfinite(search.epsilon))
      throw InvalidInput("epsilon is " + std::to_string(search.epsilon) +
                         "; it must be at least 0 and finite");
    if (search.max_leaves == 0) throw InvalidInput("max_leaves is 0; it must be at least 1");
    if (search.max_rows == 0) throw InvalidInput("max_rows is 0; it must be at least 1");
  }
  void check_length(std::size_t length) const {
    if (length != columns())
      throw InvalidInput("query has " + std::to_string(length) + " coordinates; rows have " +
                         std::to_string(columns()));
  }
  static void check_room(std::size_t have, std::size_t need) {
    if (have < need)
      throw InvalidInput("out holds " + std::to_string(have) + " answers; it must hold " +
                         std::to_string(need));
  }
};

}  // namespace treeline::accel
