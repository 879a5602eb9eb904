// Brute force over rows: every query looks at every row. The measure of right for the trees, and hard to beat
// where rows fill all of their dimensions.
//
// Cost: a copy to build, O(n d) per query, the memory's bandwidth above some thousand rows. Known weakness:
// O(n). Limits of a search are met by ignoring them.
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

  template <class Visitor, class W>
  void visit(const RowSearch&, RowScratch<T>& scratch, Visitor& visitor, W& work) const {
    constexpr std::size_t stretch = 64;
    T distances2[stretch];
    work.node();
    work.primitive(set_.size());
    for (std::size_t first = 0; first < set_.size(); first += stretch) {
      const std::size_t count = std::min(stretch, set_.size() - first);
      const T limit = visitor.limit();
      measure_rows<T>(set_.row(first), set_.stride, nullptr, count, scratch.query.data(), distances2);
      for (std::size_t i = 0; i < count; ++i)
        if (distances2[i] <= limit) visitor.offer(distances2[i], set_.ids[first + i]);
    }
  }
};

static_assert(RowIndex<BruteForce<Rows<float>>> && RowIndex<BruteForce<Rows<double>>>);

}  // namespace treeline::accel
