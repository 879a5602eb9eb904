#include "accel/brute_force/points.hpp"
#include "bench/knn/tree_index.hpp"

namespace treeline::bench::knn {
namespace {

template <class T>
using Tree = accel::BruteForce<accel::Points<T, 3>>;

// Above this size a query costs as much as thousands of a tree's: nothing new would be learnt.
constexpr std::size_t largest_worth_it = 100'000;

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info =
         {.name = "brute", .family = "brute", .ladder = 0, .largest_n = largest_worth_it, .scales = false},
     .build = [](const Input& input, const Knobs& knobs) {
       return build_tree<Tree<float>>(input, {}, knobs);
     }});
[[maybe_unused]] const bool registered_double =
    Registry<Method>::instance().add({.info = {.name = "brute_double",
                                               .family = "brute",
                                               .ladder = 1,
                                               .largest_n = largest_worth_it,
                                               .scales = false},
                                      .build_double = [](const InputOf<double>& input, const Knobs& knobs) {
                                        return build_tree<Tree<double>>(input, {}, knobs);
                                      }});

}  // namespace
}  // namespace treeline::bench::knn
