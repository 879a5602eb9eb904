// KD tree over rows: an inner node cuts along the column of largest variance, at the median (Friedman,
// Bentley and Finkel 1977; Silpa-Anan and Hartley 2008 for the variance).
//
// Exact, within (1 + epsilon), or approximate by limits on what is visited; see search.hpp. Cost: O(n d + n
// log n) to build, 20/leaf bytes a row beside the rows. A query for 10 of 1e5 clustered rows of 32 columns
// looks at 5 to 8 % of them. Known weakness: a dozen cuts say nothing of the columns that they do not cut.
// Where rows are correlated, cuts across directions do better (bsp_tree/rows.hpp); where they are not,
// nothing beats brute force beyond some 20 columns.
#pragma once

#include "accel/rows/tree_index.hpp"

namespace treeline::accel {

/// Leaves of 16 to 64 do alike at 8 to 128 clustered columns (within a quarter at equal recall).
struct KdRowOptions : BuildOptions {
  KdRowOptions() { leaf_size = 32; }
};

template <class T>
class KdTree<Rows<T>> : public RowQueries<KdTree<Rows<T>>, T> {
  using Base = RowQueries<KdTree, T>;

 public:
  using Options = KdRowOptions;

  explicit KdTree(RowsView<T> rows, const Options& options = {}) : Base(rows, options), box_(set_) {
    const AxisSplit<T> rule(set_, 1, 0);
    tree_ = RowTreeBuilder<T, AxisSplit<T>>(set_, rule, options.leaf_size, stats_).build();
    own_leaves(set_, std::span(&tree_, 1));
    stats_.bytes = sizeof(*this) + set_.bytes() + tree_.bytes() + 2 * set_.columns * sizeof(T);
  }

 private:
  friend Base;
  using Base::set_;
  using Base::stats_;

  template <class Visitor, class W>
  void visit(const RowSearch& limits, RowScratch<T>& scratch, Visitor& visitor, W& work) const {
    search_along_columns(set_, std::span(&tree_, 1), box_, limits, scratch, visitor, work);
  }

  RowBox<T> box_;
  RowTree<T> tree_;
};

static_assert(RowIndex<KdTree<Rows<float>>> && RowIndex<KdTree<Rows<double>>>);

}  // namespace treeline::accel
