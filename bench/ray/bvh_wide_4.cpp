#include "bench/ray/wide_index.hpp"

namespace treeline::bench::ray {

std::unique_ptr<Index> build_wide_4_4(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  return build_wide<geometry::Watertight, accel::WideOf<4, 4>>(mesh, knobs, threads);
}
std::unique_ptr<Index> build_wide_4_8(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  return build_wide<geometry::Watertight, accel::WideOf<4, 8>>(mesh, knobs, threads);
}
std::unique_ptr<Index> build_wide_8_4(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
  return build_wide<geometry::Watertight, accel::WideOf<8, 4>>(mesh, knobs, threads);
}

}  // namespace treeline::bench::ray
