#include "bench/knn/double_scan.hpp"

namespace treeline::bench::knn {

using accel::Id;

template <class T>
ScanOf<T>::ScanOf(std::span<const Point> points) {
  x_.reserve(points.size()), y_.reserve(points.size()), z_.reserve(points.size()),
      ids_.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!geometry::is_finite(points[i])) continue;
    x_.push_back(points[i][0]), y_.push_back(points[i][1]), z_.push_back(points[i][2]);
    ids_.push_back(static_cast<Id>(i));
  }
}

template <class T>
auto ScanOf<T>::box() const -> Box {
  Box b;
  for (std::size_t i = 0; i < size(); ++i) b.grow(point(i));
  return b;
}

// Distances of a stretch are computed without branches; only a stretch with a candidate is looked at again.
template <class T>
template <class Distance2>
std::vector<ScanFound> ScanOf<T>::select(std::size_t k, Distance2 distance2) const {
  std::vector<Found> heap;
  k = std::min(k, size());
  if (k == 0) return heap;
  heap.reserve(k);
  constexpr std::size_t stretch = 256;
  double d2[stretch];
  double bound = std::numeric_limits<double>::infinity();
  for (std::size_t begin = 0; begin < size(); begin += stretch) {
    const std::size_t count = std::min(stretch, size() - begin);
    long candidates = 0;
    for (std::size_t j = 0; j < count; ++j) {
      d2[j] = distance2(begin + j);
      candidates += d2[j] <= bound ? 1 : 0;
    }
    if (candidates == 0) continue;
    for (std::size_t j = 0; j < count; ++j) {
      const Found found{d2[j], ids_[begin + j]};
      if (heap.size() < k) {
        heap.push_back(found);
        std::push_heap(heap.begin(), heap.end());
      } else if (found < heap.front()) {
        std::pop_heap(heap.begin(), heap.end());
        heap.back() = found;
        std::push_heap(heap.begin(), heap.end());
      }
    }
    if (heap.size() == k) bound = heap.front().distance2;
  }
  std::sort_heap(heap.begin(), heap.end());
  return heap;
}

template <class T>
std::vector<ScanFound> ScanOf<T>::nearest(const Point& query, std::size_t k) const {
  const double qx = query[0], qy = query[1], qz = query[2];
  return select(k, [&](std::size_t i) {
    const double dx = x_[i] - qx, dy = y_[i] - qy, dz = z_[i] - qz;
    return dx * dx + dy * dy + dz * dz;
  });
}

template <class T>
std::vector<ScanFound> ScanOf<T>::nearest_by_cube(const Point& query, std::size_t k) const {
  const double qx = query[0], qy = query[1], qz = query[2];
  return select(k, [&](std::size_t i) {
    const double dx = std::abs(x_[i] - qx), dy = std::abs(y_[i] - qy), dz = std::abs(z_[i] - qz);
    const double d = std::max(dx, std::max(dy, dz));
    return d * d;
  });
}

template <class T>
RangeAnswer ScanOf<T>::within(const Point& query, double radius) const {
  RangeAnswer r;
  if (!(radius >= 0)) return r;
  const double qx = query[0], qy = query[1], qz = query[2];
  const double sure = radius * (1 - border), open = radius * (1 + border);
  for (std::size_t i = 0; i < size(); ++i) {
    const double dx = x_[i] - qx, dy = y_[i] - qy, dz = z_[i] - qz;
    const double d2 = dx * dx + dy * dy + dz * dz;
    if (d2 > open * open) continue;
    (d2 < sure * sure ? r.must : r.may).push_back(ids_[i]);
  }
  return r;
}

template <class T>
RangeAnswer ScanOf<T>::inside(const Box& box) const {
  RangeAnswer r;
  double low[3], high[3], slack[3];
  for (int a = 0; a < 3; ++a) {
    low[a] = box.low[a], high[a] = box.high[a];
    slack[a] = border * (high[a] - low[a]);
  }
  // Distance to the nearest face along each axis, positive inside.
  const auto depth = [&](double c, int a) { return std::min(c - low[a], high[a] - c); };
  for (std::size_t i = 0; i < size(); ++i) {
    const double dx = depth(x_[i], 0), dy = depth(y_[i], 1), dz = depth(z_[i], 2);
    if (dx < -slack[0] || dy < -slack[1] || dz < -slack[2]) continue;
    const bool sure = dx > slack[0] && dy > slack[1] && dz > slack[2];
    (sure ? r.must : r.may).push_back(ids_[i]);
  }
  return r;
}

template class ScanOf<float>;
template class ScanOf<double>;

}  // namespace treeline::bench::knn
