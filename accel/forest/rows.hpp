// A forest of randomised trees over rows, searched together, best bin first: KD trees that cut along any of
// the few columns of largest variance (Silpa-Anan and Hartley 2008; Muja and Lowe 2009), or trees that cut
// across random directions (Dasgupta and Freund 2008).
//
// Approximate by limits on what is visited; without limits the first tree answers alone, exactly. Trees share
// one copy of the rows, in the order of the first one's leaves. Cost: that of its trees to build, 4 + 20/leaf
// bytes a row and tree. Known weakness: rows of all trees but the first are scattered, and each is marked
// when met. At equal time one tree across principal axes (bsp_tree/rows.hpp) looks at several times the rows
// and finds more: recall 0.99 takes it 13 µs, four trees 41 µs (1e5 clustered rows of 32 columns, k = 10).
#pragma once

#include "accel/rows/tree_index.hpp"

namespace treeline::accel {

struct ForestRowOptions : BuildOptions {
  enum class Split { random_axis, random_projection } split = Split::random_axis;
  int trees = 4;
  int choices = 5;      ///< random_axis: columns of largest variance to draw from
  int projections = 2;  ///< random_projection: directions tried per node
  std::uint64_t seed = 1;

  ForestRowOptions() { leaf_size = 8; }  // small leaves miss less: rows are scattered anyway
};

template <class T>
class Forest<Rows<T>> : public RowQueries<Forest<Rows<T>>, T> {
  using Base = RowQueries<Forest, T>;

 public:
  using Options = ForestRowOptions;

  explicit Forest(RowsView<T> rows, const Options& options = {})
      : Base(rows, options),
        along_columns_(options.split == Options::Split::random_axis),
        box_(set_),
        centre_(set_) {
    check_positive("trees", options.trees);
    check_positive("choices", options.choices);
    check_positive("projections", options.projections);
    for (int i = 0; i < options.trees; ++i) {
      const std::uint64_t seed = geometry::hash_u64(options.seed, static_cast<std::uint64_t>(i));
      trees_.push_back(
          along_columns_
              ? grow(AxisSplit<T>(set_, options.choices, seed), options.leaf_size)
              : grow(DirectionSplit<T>(set_, centre_.at, {options.projections, 0, seed}), options.leaf_size));
    }
    // The first tree's leaves stay listed, as the others' are: a search marks rows by their places.
    const std::vector<std::uint32_t> first = trees_[0].places;
    own_leaves(set_, std::span(trees_));
    if (trees_.size() > 1 && trees_[0].places.empty()) {
      trees_[0].places.resize(first.size());
      std::iota(trees_[0].places.begin(), trees_[0].places.end(), 0u);
    }
    stats_.bytes = sizeof(*this) + set_.bytes() + (2 * set_.columns + set_.stride) * sizeof(T);
    for (const RowTree<T>& tree : trees_) stats_.bytes += tree.bytes();
  }

 private:
  friend Base;
  using Base::set_;
  using Base::stats_;

  static void check_positive(const char* name, int value) {
    if (value < 1)
      throw InvalidInput(std::string(name) + " is " + std::to_string(value) + "; it must be at least 1");
  }
  template <class Rule>
  RowTree<T> grow(Rule rule, int leaf_size) {
    return RowTreeBuilder<T, Rule>(set_, std::move(rule), leaf_size, stats_).build();
  }

  template <class Visitor, class W>
  void visit(const RowSearch& limits, RowScratch<T>& scratch, Visitor& visitor, W& work) const {
    const std::span<const RowTree<T>> trees(trees_);
    if (along_columns_)
      search_along_columns(set_, trees, box_, limits, scratch, visitor, work);
    else
      search_across_directions(set_, trees, centre_, false, limits, scratch, visitor, work);
  }

  bool along_columns_;
  RowBox<T> box_;
  RowCentre<T> centre_;
  std::vector<RowTree<T>> trees_;
};

static_assert(RowIndex<Forest<Rows<float>>> && RowIndex<Forest<Rows<double>>>);

}  // namespace treeline::accel
