#include "bench/knn_nd/truth.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace treeline::bench::knn_nd {

double distance2(std::span<const float> p, std::span<const float> q) {
  constexpr std::size_t lanes = 8;  // of which compilers make vectors
  double sums[lanes] = {};
  std::size_t a = 0;
  for (; a + lanes <= p.size(); a += lanes)
    for (std::size_t l = 0; l < lanes; ++l) {
      const double d = static_cast<double>(p[a + l]) - static_cast<double>(q[a + l]);
      sums[l] += d * d;
    }
  for (; a < p.size(); ++a) {
    const double d = static_cast<double>(p[a]) - static_cast<double>(q[a]);
    sums[0] += d * d;
  }
  return ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

bool is_finite(std::span<const float> row) {
  return std::all_of(row.begin(), row.end(), [](float x) { return std::isfinite(x); });
}
bool has_nan(std::span<const float> row) {
  return std::any_of(row.begin(), row.end(), [](float x) { return std::isnan(x); });
}

Truth truth_of(RowsView rows, RowsView queries, std::size_t k, int threads) {
  std::vector<std::uint32_t> finite;
  for (std::size_t i = 0; i < rows.rows; ++i)
    if (is_finite(rows[i])) finite.push_back(static_cast<std::uint32_t>(i));
  Truth t;
  t.k = std::min(k, finite.size());
  t.answerable.assign(queries.rows, 0);
  t.distances.assign(queries.rows * t.k, 0);
  const auto answer = [&](std::size_t i) {
    if (has_nan(queries[i])) return;
    t.answerable[i] = 1;
    std::vector<double> all(finite.size());
    for (std::size_t j = 0; j < all.size(); ++j) all[j] = distance2(rows[finite[j]], queries[i]);
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(t.k);
    std::nth_element(all.begin(), t.k < all.size() ? end : all.end(), all.end());
    std::sort(all.begin(), end);
    for (std::size_t j = 0; j < t.k; ++j) t.distances[i * t.k + j] = std::sqrt(all[j]);
  };
  // On one thread TBB stays out of it, so that a process may fork afterwards.
  if (threads <= 1) {
    for (std::size_t i = 0; i < queries.rows; ++i) answer(i);
  } else {
    tbb::task_arena arena(threads);
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, queries.rows, answer); });
  }
  return t;
}

std::string to_bytes(const Truth& t) {
  std::string bytes(sizeof(std::uint64_t), '\0');
  const std::uint64_t k = t.k;
  std::memcpy(bytes.data(), &k, sizeof k);
  bytes.append(reinterpret_cast<const char*>(t.answerable.data()), t.answerable.size());
  bytes.append(reinterpret_cast<const char*>(t.distances.data()), t.distances.size() * sizeof(double));
  return bytes;
}

Truth truth_from_bytes(std::string_view bytes, std::size_t queries) {
  Truth t;
  std::uint64_t k = 0;
  if (bytes.size() < sizeof k) throw std::invalid_argument("cached truth is cut short");
  std::memcpy(&k, bytes.data(), sizeof k);
  bytes.remove_prefix(sizeof k);
  if (k > bytes.size() || bytes.size() != queries + queries * k * sizeof(double))
    throw std::invalid_argument("cached truth is of another size");
  t.k = k;
  t.answerable.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(queries));
  t.distances.resize(queries * t.k);
  if (!t.distances.empty())
    std::memcpy(t.distances.data(), bytes.data() + queries, t.distances.size() * sizeof(double));
  return t;
}

}  // namespace treeline::bench::knn_nd
