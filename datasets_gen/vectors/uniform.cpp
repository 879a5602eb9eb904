// Rows uniform in the unit cube of d dimensions: the honest hopeless case. From some twenty dimensions on all
// rows are about as far from a query, and no index can pass over most of them.
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

Vectors uniform_vectors(const Job& job, std::size_t columns) {
  return job.vectors(columns, [&](std::size_t i, std::span<float> row) {
    Draws draws(job.seed, i);
    for (float& x : row) x = static_cast<float>(draws.uniform());
  });
}

}  // namespace treeline::datasets
