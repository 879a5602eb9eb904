#include "bench/knn/method.hpp"

namespace treeline::bench::knn {

void Index::nearest(std::span<const Vec3f>, std::size_t, const Knobs&, int, std::span<Id>) const {
  throw Unsupported("has no k-nearest query");
}
void Index::within(std::span<const Vec3f>, float, const Knobs&, int, Lists<Id>&) const {
  throw Unsupported("has no radius query");
}
void Index::inside(std::span<const Box3f>, const Knobs&, int, Lists<Id>&) const {
  throw Unsupported("has no box query");
}
std::optional<Visits> Index::nearest_visits(std::span<const Vec3f>, std::size_t, const Knobs&) const {
  return {};
}
std::optional<Visits> Index::within_visits(std::span<const Vec3f>, float) const { return {}; }
std::optional<Visits> Index::inside_visits(std::span<const Box3f>) const { return {}; }
std::vector<accel::SliceCell> Index::slice(int, double) const { return {}; }

}  // namespace treeline::bench::knn
