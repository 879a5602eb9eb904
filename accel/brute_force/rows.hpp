// Brute force over rows: every query looks at every row. The measure of right for the trees, and hard to beat
// where rows fill all of their dimensions.
//
// Cost: a copy to build, O(n d) per query: the memory's bandwidth for single ones, the kernel for a batch,
// which reads each row once for 16 queries (1e5 rows of 128 columns: 1.4 ms alone, 0.55 ms a query in a
// batch). Known weakness: O(n). Limits of a search are met by ignoring them.
#pragma once

#include "accel/rows/row_queries.hpp"

namespace treeline::accel {

template <class T>
class BruteForce<Rows<T>> : public RowQueries<BruteForce<Rows<T>>, T> {
  using Base = RowQueries<BruteForce, T>;

 public:
  using Options = BuildOptions;

  explicit BruteForce(RowsView<T> rows, const Options& options = {}) : Base(rows, options) {
    stats_.references = stats_.largest_leaf = this->size();
    stats_.leaves = this->size() > 0 ? 1 : 0;
    stats_.bytes = sizeof(*this) + set_.bytes();
  }

 private:
  friend Base;
  using Base::set_;
  using Base::stats_;

  static constexpr std::size_t group = 16, stretch = 64;  // 32 KiB of rows at 128 columns: they stay cached

  template <class Visitor, class W>
  void visit(const RowSearch&, RowScratch<T>& scratch, Visitor& visitor, W& work) const {
    work.node();
    work.primitive(set_.size());
    const T* const query = scratch.query.data();
    visit_group(std::span<const T* const>(&query, 1), std::span(&visitor, 1));
  }
  template <class Visitor>
  void visit_group(std::span<const T* const> queries, std::span<Visitor> visitors) const {
    T distances2[stretch];
    for (std::size_t first = 0; first < set_.size(); first += stretch) {
      const std::size_t count = std::min(stretch, set_.size() - first);
      for (std::size_t i = 0; i < queries.size(); ++i) {
        const T limit = visitors[i].limit();
        measure_rows<T>(set_.row(first), set_.stride, nullptr, count, queries[i], distances2);
        // Without branches: few stretches hold a candidate.
        int candidates = 0;
        for (std::size_t j = 0; j < count; ++j) candidates += distances2[j] <= limit ? 1 : 0;
        for (std::size_t j = 0; candidates > 0 && j < count; ++j)
          if (distances2[j] <= limit) visitors[i].offer(distances2[j], set_.ids[first + j]);
      }
    }
  }
};

static_assert(RowIndex<BruteForce<Rows<float>>> && RowIndex<BruteForce<Rows<double>>>);

}  // namespace treeline::accel
