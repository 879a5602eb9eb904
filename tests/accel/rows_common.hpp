// What the tests of the indices over rows share: every index under every option, matrices that are hard on
// them, and the truth, computed here in a wider type.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "accel/rows/rows.hpp"
#include "geometry/random.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel::test {

template <class T>
struct Matrix {
  std::string name;
  std::size_t rows = 0, columns = 0;
  std::vector<T> scalars;

  Matrix(std::string title, std::size_t n, std::size_t d)
      : name(std::move(title)), rows(n), columns(d), scalars(n * d) {}
  RowsView<T> view() const { return {scalars.data(), rows, columns}; }
  T* row(std::size_t i) { return scalars.data() + i * columns; }
  std::span<const T> row(std::size_t i) const { return {scalars.data() + i * columns, columns}; }
};

/// Any index behind one face, so that the kernels are compiled once (in rows_indices.cpp).
template <class T>
struct AnyRows {
  using Found = Neighbor<T>;
  std::string name;

  virtual ~AnyRows() = default;
  virtual std::size_t nearest(std::span<const T>, std::size_t k, const RowSearch&, std::span<Found>,
                              Work&) const = 0;
  virtual void nearest(RowsView<T>, std::size_t k, const RowSearch&, std::span<Found>, int threads) const = 0;
  virtual TreeStats stats() const = 0;
  virtual std::size_t size() const = 0;
  virtual std::size_t columns() const = 0;
  virtual std::size_t bytes() const = 0;

  std::vector<Found> nearest(std::span<const T> q, std::size_t k, const RowSearch& search = {}) const {
    std::vector<Found> out(std::min(k, size()));
    Work work;
    EXPECT_EQ(nearest(q, k, search, out, work), out.size());
    return out;
  }
};

/// Brute force, then every tree under every rule.
template <class T>
std::vector<std::unique_ptr<AnyRows<T>>> all_indices(RowsView<T>, int leaf_size,
                                                     NonFinite non_finite = NonFinite::refuse);

template <class T, class F>
void for_each_index(RowsView<T> rows, F&& f, int leaf_size = 8, NonFinite non_finite = NonFinite::refuse) {
  for (const auto& index : all_indices<T>(rows, leaf_size, non_finite)) {
    SCOPED_TRACE(index->name);
    f(*index);
  }
}

template <class T>
Matrix<T> uniform_rows(std::size_t n, std::size_t d, std::uint64_t seed = 1) {
  Matrix<T> m("uniform", n, d);
  geometry::Pcg32 random(seed);
  for (T& x : m.scalars) x = random.uniform<T>(T(-1), T(1));
  return m;
}

/// Rows of `latent` dimensions, mapped linearly into d, with a little noise.
template <class T>
Matrix<T> latent_rows(std::size_t n, std::size_t d, std::size_t latent, std::uint64_t seed = 1) {
  Matrix<T> m("latent", n, d);
  geometry::Pcg32 map(77), random(seed, 3);
  std::vector<T> weights(d * latent), z(latent);
  for (T& w : weights) w = map.uniform<T>(T(-1), T(1));
  for (std::size_t i = 0; i < n; ++i) {
    for (T& x : z) x = random.uniform<T>();
    for (std::size_t a = 0; a < d; ++a) {
      T sum = T(0.01) * random.uniform<T>();
      for (std::size_t l = 0; l < latent; ++l) sum += weights[a * latent + l] * z[l];
      m.row(i)[a] = sum;
    }
  }
  return m;
}

template <class T>
std::vector<Matrix<T>> matrices(std::size_t d) {
  std::vector<Matrix<T>> all;
  for (const std::size_t n : {0, 1, 2, 3, 20}) {
    all.push_back(uniform_rows<T>(n, d));
    all.back().name = "first " + std::to_string(n);
  }
  const Matrix<T> uniform = uniform_rows<T>(400, d);
  all.push_back(uniform);
  all.push_back(latent_rows<T>(400, d, 2));
  const auto mapped = [&](const char* name, auto f) {
    Matrix<T> m(name, uniform.rows, d);
    for (std::size_t i = 0; i < m.rows; ++i)
      for (std::size_t a = 0; a < d; ++a) m.row(i)[a] = f(uniform.row(i)[a], i, a);
    all.push_back(m);
  };
  const bool single = sizeof(T) == 4;
  mapped("all equal", [&](T, std::size_t, std::size_t a) { return uniform.row(0)[a]; });
  mapped("few distinct", [&](T, std::size_t i, std::size_t a) { return uniform.row(i % 13)[a]; });
  mapped("mostly equal", [&](T x, std::size_t i, std::size_t a) { return i % 90 ? uniform.row(0)[a] : x; });
  mapped("integers", [](T x, std::size_t, std::size_t) { return std::round(2 * x); });
  mapped("one column", [](T x, std::size_t, std::size_t a) { return a == 0 ? x : T(0.5); });
  mapped("far from the origin",
         [&](T x, std::size_t, std::size_t) { return x + (single ? T(1e5) : T(1e12)); });
  mapped("halving", [](T x, std::size_t i, std::size_t) { return std::ldexp(x, -static_cast<int>(i % 25)); });
  mapped("tiny", [&](T x, std::size_t, std::size_t) { return x * (single ? T(1e-30) : T(1e-290)); });
  mapped("huge", [&](T x, std::size_t, std::size_t) { return x * (single ? T(3e38) : T(1e308)); });
  mapped("one far away", [&](T x, std::size_t i, std::size_t) { return i == 300 ? T(1e15) : x; });
  return all;
}

/// Rows themselves, positions among them and around them.
template <class T>
Matrix<T> queries_for(const Matrix<T>& m, std::size_t each = 5) {
  Matrix<T> q("queries", 3 * each, m.columns);
  geometry::Pcg32 random(5);
  for (std::size_t i = 0; i < q.rows; ++i) {
    const auto pick = [&]() -> std::span<const T> {
      if (m.rows == 0) return {q.row(0), q.columns};
      return m.row(random.below(static_cast<std::uint32_t>(m.rows)));
    };
    const std::span<const T> a = pick(), b = pick();
    for (std::size_t c = 0; c < m.columns; ++c)
      q.row(i)[c] = i < each ? a[c] : i < 2 * each ? a[c] / 2 + b[c] / 2 : a[c] / 2 - b[c] / 2;
  }
  return q;
}

using Wide = long double;

template <class T>
Wide wide_distance2(std::span<const T> p, std::span<const T> q) {
  Wide sum = 0;
  for (std::size_t a = 0; a < p.size(); ++a) {
    const Wide d = static_cast<Wide>(p[a]) - static_cast<Wide>(q[a]);
    sum += d * d;
  }
  return sum;
}
/// Relative error of a squared distance in T.
template <class T>
Wide row_distance2_error(std::size_t columns) {
  return geometry::tolerance::gamma<T>(static_cast<int>(columns) + 4);
}

template <class T>
std::vector<Wide> sorted_distances2(const Matrix<T>& m, std::span<const T> q) {
  std::vector<Wide> r(m.rows);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = wide_distance2<T>(m.row(i), q);
  std::sort(r.begin(), r.end());
  return r;
}

template <class T>
void expect_distinct(const std::vector<Neighbor<T>>& found, std::size_t n) {
  std::set<Id> ids;
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_LT(found[i].id, n);
    EXPECT_TRUE(ids.insert(found[i].id).second) << "id " << found[i].id << " twice";
    if (i > 0) {
      EXPECT_TRUE(found[i - 1] < found[i] || found[i - 1].distance2 == found[i].distance2);
    }
  }
}

}  // namespace treeline::accel::test
