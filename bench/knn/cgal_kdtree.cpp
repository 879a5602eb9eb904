// CGAL's Kd_tree with orthogonal distance search.
//
// Its documented settings: the splitter (sliding midpoint, its default; sliding fair and the median of the
// widest spread are the other two that its manual recommends), the bucket size (10 by default), extended
// nodes, and the cache of coordinates in leaf order, switched on here, which Euclidean_distance and
// Search_traits_3 make use of. Points are floats as for everyone else. Spheres and boxes are asked without
// fuzziness. It builds by threads, over TBB.
#include <CGAL/Fuzzy_iso_box.h>
#include <CGAL/Fuzzy_sphere.h>
#include <CGAL/Kd_tree.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>
#include <CGAL/version.h>
#include <oneapi/tbb/task_arena.h>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/knn/method.hpp"

namespace treeline::bench::knn {
namespace {

/// CGAL's types over floats or doubles.
template <class T>
struct Cgal {
  using Kernel = CGAL::Simple_cartesian<T>;
  using Point = typename Kernel::Point_3;
  using Item = std::pair<Point, Id>;
  using First = CGAL::First_of_pair_property_map<Item>;
  using Plain = CGAL::Search_traits_3<Kernel>;
  using Traits = CGAL::Search_traits_adapter<Item, First, Plain>;
  using Distance = CGAL::Distance_adapter<Item, First, CGAL::Euclidean_distance<Plain>>;
  using Sphere = CGAL::Fuzzy_sphere<Traits>;
  using IsoBox = CGAL::Fuzzy_iso_box<Traits>;

  static Point point(const geometry::Vec<T, 3>& p) { return {p[0], p[1], p[2]}; }
};

// Output iterator that keeps the id of an item.
struct IdSink {
  using iterator_category = std::output_iterator_tag;
  using value_type = void;
  using difference_type = std::ptrdiff_t;
  using pointer = void;
  using reference = void;
  std::vector<Id>* ids;
  IdSink& operator*() { return *this; }
  IdSink& operator++() { return *this; }
  IdSink operator++(int) { return *this; }
  template <class Item>
  IdSink& operator=(const Item& item) {
    ids->push_back(item.second);
    return *this;
  }
};

template <class T, template <class...> class SplitterOf>
class CgalKdtree final : public IndexOf<T> {
  using C = Cgal<T>;
  using Item = typename C::Item;
  using Splitter = SplitterOf<typename C::Traits>;
  using Tree = CGAL::Kd_tree<typename C::Traits, Splitter, CGAL::Tag_true, CGAL::Tag_true>;
  using Search = CGAL::Orthogonal_k_neighbor_search<typename C::Traits, typename C::Distance, Splitter, Tree>;
  using Point = geometry::Vec<T, 3>;
  using Box = geometry::Box<T, 3>;

 public:
  CgalKdtree(const InputOf<T>& input, const Knobs& knobs)
      : items_(items(input)),
        tree_(items_.begin(), items_.end(), Splitter(knobs.at("bucket_size").get<unsigned>())) {
    items_ = {};
    if (input.threads == 1)
      tree_.template build<CGAL::Sequential_tag>();
    else
      oneapi::tbb::task_arena(input.threads).execute([&] { tree_.template build<CGAL::Parallel_tag>(); });
  }

  void nearest(std::span<const Point> queries, std::size_t k, const Knobs&, int threads,
               std::span<Id> ids) const override {
    accel::parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Search search(tree_, C::point(queries[i]), static_cast<unsigned>(k));
        std::size_t j = i * k;
        for (const auto& [item, distance2] : search) ids[j++] = item.second;
      }
    });
  }

  void within(std::span<const Point> queries, T radius, const Knobs&, int threads,
              Lists<Id>& lists) const override {
    accel::parallel_lists(queries.size(), threads, lists, [&](std::size_t i, std::vector<Id>& ids) {
      tree_.search(IdSink{&ids}, typename C::Sphere(C::point(queries[i]), radius));
    });
  }

  void inside(std::span<const Box> boxes, const Knobs&, int threads, Lists<Id>& lists) const override {
    accel::parallel_lists(boxes.size(), threads, lists, [&](std::size_t i, std::vector<Id>& ids) {
      tree_.search(IdSink{&ids}, typename C::IsoBox(C::point(boxes[i].low), C::point(boxes[i].high)));
    });
  }

 private:
  static std::vector<Item> items(const InputOf<T>& input) {
    std::vector<Item> r;
    r.reserve(input.points.size());
    for (std::size_t i = 0; i < input.points.size(); ++i)
      r.emplace_back(C::point(input.points[i]), static_cast<Id>(i));
    return r;
  }

  std::vector<Item> items_;  // only until the tree has its copy
  Tree tree_;
};

// On scanner sweeps sliding fair takes a few points off at a time: at 1e5 its queries cost 300 times those of
// sliding midpoint, at 1e6 its recursion crashes.
constexpr std::size_t largest_fair = 20'000;

std::unique_ptr<Index> build(const Input& input, const Knobs& knobs) {
  const std::string splitter = knobs.at("splitter");
  if (splitter == "sliding_fair") {
    if (input.points.size() > largest_fair)
      throw Unsupported("sliding fair is not built above n = " + std::to_string(largest_fair) +
                        ": on uneven clouds it gets as deep as they have points and overflows the stack");
    return std::make_unique<CgalKdtree<float, CGAL::Sliding_fair>>(input, knobs);
  }
  if (splitter == "median_of_max_spread")
    return std::make_unique<CgalKdtree<float, CGAL::Median_of_max_spread>>(input, knobs);
  return std::make_unique<CgalKdtree<float, CGAL::Sliding_midpoint>>(input, knobs);
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "cgal_kdtree",
              .family = "kd",
              .source = Source::peer,
              .peer_version = CGAL_VERSION_STR,
              .build_knobs = {{{"bucket_size", 10}, {"splitter", "sliding_midpoint"}},
                              {{"bucket_size", 20}, {"splitter", "sliding_midpoint"}},
                              {{"bucket_size", 10}, {"splitter", "sliding_fair"}},
                              {{"bucket_size", 20}, {"splitter", "sliding_fair"}},
                              {{"bucket_size", 10}, {"splitter", "median_of_max_spread"}},
                              {{"bucket_size", 20}, {"splitter", "median_of_max_spread"}}},
              .ladder = 34,
              .quick_builds = 2},
     .build = build});
[[maybe_unused]] const bool registered_double = Registry<Method>::instance().add(
    {.info = {.name = "cgal_kdtree_double",
              .family = "kd",
              .source = Source::peer,
              .peer_version = CGAL_VERSION_STR,
              .build_knobs = {{{"bucket_size", 10}, {"splitter", "sliding_midpoint"}},
                              {{"bucket_size", 20}, {"splitter", "sliding_midpoint"}}},
              .ladder = 44,
              .scales = false},
     .build_double = [](const InputOf<double>& input,
                        const Knobs& knobs) -> std::unique_ptr<IndexOf<double>> {
       return std::make_unique<CgalKdtree<double, CGAL::Sliding_midpoint>>(input, knobs);
     }});

}  // namespace
}  // namespace treeline::bench::knn
