// Sixteen boards, four by four; the squares of each are 1 to 64 pixels wide, and so placed that none is the
// texture's own multiple. Sharp, and of one frequency each: filters that alias show it here.
#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {

shading::Image checkers(const Job& job) {
  static constexpr int widths[16] = {1, 2, 3, 4, 5, 6, 8, 11, 13, 16, 19, 23, 32, 37, 48, 64};
  const int board = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(job.n)) / 4));
  Draws draws(job.seed, 0);
  const int dx = static_cast<int>(draws.below(64)), dy = static_cast<int>(draws.below(64));
  return job.image(1, [&](int x, int y, std::span<float> pixel) {
    const int width = widths[std::min(y / board, 3) * 4 + std::min(x / board, 3)];
    pixel[0] = ((x + dx) / width + (y + dy) / width) % 2 == 0 ? 0.0f : 1.0f;
  });
}

}  // namespace treeline::datasets
