// Every index over rows under every option, behind the face that the tests use.
#include "accel/brute_force/rows.hpp"
#include "accel/bsp_tree/rows.hpp"
#include "accel/forest/rows.hpp"
#include "accel/kd_tree/rows.hpp"
#include "rows_common.hpp"

namespace treeline::accel::test {
namespace {

template <class Index, class T>
struct Wrapped final : AnyRows<T> {
  using typename AnyRows<T>::Found;
  Index index;

  Wrapped(const char* title, RowsView<T> rows, const typename Index::Options& options)
      : index(rows, options) {
    this->name = title;
  }
  std::size_t nearest(std::span<const T> q, std::size_t k, const RowSearch& search, std::span<Found> out,
                      Work& work) const override {
    return index.nearest(q, k, search, out, work);
  }
  void nearest(RowsView<T> q, std::size_t k, const RowSearch& search, std::span<Found> out,
               int threads) const override {
    index.nearest(q, k, search, out, threads);
  }
  TreeStats stats() const override { return index.stats(); }
  std::size_t size() const override { return index.size(); }
  std::size_t columns() const override { return index.columns(); }
  std::size_t bytes() const override { return index.bytes(); }
};

}  // namespace

template <class T>
std::vector<std::unique_ptr<AnyRows<T>>> all_indices(RowsView<T> rows, int leaf_size, NonFinite non_finite) {
  std::vector<std::unique_ptr<AnyRows<T>>> all;
  const auto add = [&]<class Index>(std::type_identity<Index>, const char* name, auto options) {
    options.leaf_size = leaf_size, options.non_finite = non_finite;
    all.push_back(std::make_unique<Wrapped<Index, T>>(name, rows, options));
  };
  add(std::type_identity<BruteForce<Rows<T>>>{}, "brute force", BuildOptions{});
  add(std::type_identity<KdTree<Rows<T>>>{}, "kd", KdRowOptions{});
  BspRowOptions bsp;
  add(std::type_identity<BspTree<Rows<T>>>{}, "bsp principal axis", bsp);
  bsp.overlap = 0.2;
  add(std::type_identity<BspTree<Rows<T>>>{}, "bsp spill", bsp);
  bsp.overlap = 0.9, bsp.split = BspRowOptions::Split::random_projection;
  add(std::type_identity<BspTree<Rows<T>>>{}, "bsp wide spill", bsp);
  bsp.overlap = 0;
  add(std::type_identity<BspTree<Rows<T>>>{}, "bsp random projection", bsp);
  ForestRowOptions forest;
  add(std::type_identity<Forest<Rows<T>>>{}, "forest random axis", forest);
  forest.split = ForestRowOptions::Split::random_projection, forest.trees = 3;
  add(std::type_identity<Forest<Rows<T>>>{}, "forest random projection", forest);
  forest.trees = 1;
  add(std::type_identity<Forest<Rows<T>>>{}, "forest of one", forest);
  return all;
}

template std::vector<std::unique_ptr<AnyRows<float>>> all_indices<float>(RowsView<float>, int, NonFinite);
template std::vector<std::unique_ptr<AnyRows<double>>> all_indices<double>(RowsView<double>, int, NonFinite);

}  // namespace treeline::accel::test
