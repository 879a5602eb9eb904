#include "bench/knn/method.hpp"

namespace treeline::bench::knn {

template <class T>
void IndexOf<T>::nearest(std::span<const Point>, std::size_t, const Knobs&, int, std::span<Id>) const {
  throw Unsupported("has no k-nearest query");
}
template <class T>
void IndexOf<T>::within(std::span<const Point>, T, const Knobs&, int, Lists<Id>&) const {
  throw Unsupported("has no radius query");
}
template <class T>
void IndexOf<T>::inside(std::span<const Box>, const Knobs&, int, Lists<Id>&) const {
  throw Unsupported("has no box query");
}
template <class T>
std::optional<Visits> IndexOf<T>::nearest_visits(std::span<const Point>, std::size_t, const Knobs&) const {
  return {};
}
template <class T>
std::optional<Visits> IndexOf<T>::within_visits(std::span<const Point>, T) const {
  return {};
}
template <class T>
std::optional<Visits> IndexOf<T>::inside_visits(std::span<const Box>) const {
  return {};
}
template <class T>
std::vector<accel::SliceCell> IndexOf<T>::slice(int, double) const {
  return {};
}

template class IndexOf<float>;
template class IndexOf<double>;

}  // namespace treeline::bench::knn
