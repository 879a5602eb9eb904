// What the tests of the point trees share: every tree under every option, clouds that are hard on them, and
// the truth, computed here in a wider type with nothing of the library but its vectors.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "accel/concepts.hpp"
#include "geometry/random.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::accel::test {

template <class T, int D>
using Vecs = std::vector<geometry::Vec<T, D>>;

/// Any tree behind one face, so that the kernels are compiled once (in points_trees.cpp) and not in every
/// test.
template <class T, int D>
struct AnyTree {
  using Point = geometry::Vec<T, D>;
  using Box = geometry::Box<T, D>;
  using Found = Neighbor<T>;

  std::string name;

  virtual ~AnyTree() = default;
  virtual std::size_t nearest(const Point&, std::size_t k, std::span<Found>) const = 0;
  virtual std::size_t nearest(const Point&, std::size_t k, std::span<Found>, Work&) const = 0;
  virtual std::size_t nearest(const Point&, std::size_t k, const NearestOptions<T>&, std::span<Found>,
                              Work&) const = 0;
  std::size_t nearest(const Point& q, std::size_t k, const NearestOptions<T>& options,
                      std::span<Found> out) const {
    Work work;
    return nearest(q, k, options, out, work);
  }
  virtual void within(const Point&, T radius, std::vector<Found>&) const = 0;
  virtual void within(const Point&, T radius, const WithinOptions&, std::vector<Found>&, Work&) const = 0;
  virtual void inside(const Box&, std::vector<Id>&) const = 0;
  virtual void nearest(std::span<const Point>, std::size_t k, std::span<Found>, int threads) const = 0;
  virtual void within(std::span<const Point>, T radius, Lists<Found>&, int threads) const = 0;
  virtual void inside(std::span<const Box>, Lists<Id>&, int threads) const = 0;
  virtual std::size_t size() const = 0;
  virtual std::size_t bytes() const = 0;
  virtual TreeStats stats() const = 0;
  virtual Box box() const = 0;
  virtual std::vector<SliceCell> slice(int axis, double offset) const = 0;
};

template <class T, int D>
using Trees = std::vector<std::unique_ptr<AnyTree<T, D>>>;

/// Brute force, then every exact tree with every split rule and bound. For float and double in two and three
/// dimensions.
template <class T, int D>
Trees<T, D> all_trees(const Vecs<T, D>& points, int leaf_size = 8, NonFinite non_finite = NonFinite::refuse);

template <class T, int D, class F>
void for_each_tree(const Vecs<T, D>& points, F&& f, int leaf_size = 8,
                   NonFinite non_finite = NonFinite::refuse) {
  for (const auto& tree : all_trees<T, D>(points, leaf_size, non_finite)) {
    SCOPED_TRACE(tree->name);
    f(tree->name, *tree);
  }
}

template <class T, int D>
geometry::Vec<T, D> uniform_point(geometry::Pcg32& random, T low = 0, T high = 1) {
  geometry::Vec<T, D> p;
  for (int a = 0; a < D; ++a) p[a] = random.uniform(low, high);
  return p;
}

template <class T, int D>
Vecs<T, D> uniform_cloud(std::size_t n, std::uint64_t seed = 1) {
  geometry::Pcg32 random(seed);
  Vecs<T, D> points(n);
  for (auto& p : points) p = uniform_point<T, D>(random);
  return points;
}

/// All points of {0 … side - 1}^D, in an order that is not theirs.
template <class T, int D>
Vecs<T, D> grid_cloud(int side) {
  std::size_t n = 1;
  for (int a = 0; a < D; ++a) n *= static_cast<std::size_t>(side);
  Vecs<T, D> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t rest = i;
    for (int a = 0; a < D; ++a, rest /= static_cast<std::size_t>(side))
      points[i][a] = static_cast<T>(rest % static_cast<std::size_t>(side));
  }
  geometry::Pcg32 random(7);
  for (std::size_t i = n; i-- > 1;)
    std::swap(points[i], points[random.below(static_cast<std::uint32_t>(i + 1))]);
  return points;
}

template <class T, int D>
struct NamedCloud {
  std::string name;
  Vecs<T, D> points;
};

template <class T, int D>
std::vector<NamedCloud<T, D>> clouds() {
  std::vector<NamedCloud<T, D>> all;
  const auto uniform = uniform_cloud<T, D>(1500);
  for (std::size_t n : {0, 1, 2, 3, 9})
    all.push_back(
        {"first " + std::to_string(n), {uniform.begin(), uniform.begin() + static_cast<std::ptrdiff_t>(n)}});
  all.push_back({"uniform", uniform});
  const auto mapped = [&](const std::string& name, auto f) {
    Vecs<T, D> points = uniform;
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = f(points[i], i);
    all.push_back({name, points});
  };
  using Point = geometry::Vec<T, D>;
  mapped("few distinct", [&](Point, std::size_t i) { return uniform[i % 37]; });
  mapped("all equal", [&](Point, std::size_t) { return uniform[0]; });
  mapped("half equal", [&](Point p, std::size_t i) { return i % 2 ? uniform[0] : p; });
  mapped("axis line", [](Point p, std::size_t) {
    for (int a = 1; a < D; ++a) p[a] = T(0.25);
    return p;
  });
  mapped("diagonal line", [](Point p, std::size_t) { return Point::filled(p[0]); });
  mapped("flat", [](Point p, std::size_t) { return p[D - 1] = T(3), p; });
  mapped("far from the origin",
         [](Point p, std::size_t) { return p + Point::filled(sizeof(T) == 4 ? T(1e5) : T(1e12)); });
  mapped("long box", [](Point p, std::size_t) { return p[0] *= T(1e6), p; });
  mapped("halving gaps",
         [](Point p, std::size_t i) { return p * std::ldexp(T(1), -static_cast<int>(i % 50)); });
  mapped("tiny", [](Point p, std::size_t) { return p * (sizeof(T) == 4 ? T(1e-22) : T(1e-160)); });
  mapped("huge", [](Point p, std::size_t) { return p * (sizeof(T) == 4 ? T(3e38) : T(1e308)); });
  mapped("below squares", [](Point p, std::size_t) { return p * (sizeof(T) == 4 ? T(1e-32) : T(1e-290)); });
  mapped("barely normal", [](Point p, std::size_t) { return p * (sizeof(T) == 4 ? T(1e-35) : T(1e-303)); });
  mapped("small among huge",
         [](Point p, std::size_t i) { return i % 5 == 0 ? p : p * (sizeof(T) == 4 ? T(1e30) : T(1e240)); });
  mapped("a tiny cluster",
         [](Point p, std::size_t i) { return i % 5 == 0 ? p * (sizeof(T) == 4 ? T(1e-25) : T(1e-200)) : p; });
  // As cosines of right angles leave it: coordinates whose squares vanish beside those of others.
  mapped("dust", [](Point p, std::size_t i) {
    if (i % 3 == 0) p[static_cast<int>(i / 3) % D] = sizeof(T) == 4 ? T(6e-17) : T(6e-150);
    return p;
  });
  mapped("one far away", [](Point p, std::size_t i) { return i == 700 ? Point::filled(T(1e6)) : p; });
  all.push_back({"grid", grid_cloud<T, D>(D == 2 ? 35 : 11)});
  return all;
}

/// Positions in, at and around a cloud.
template <class T, int D>
Vecs<T, D> queries_for(const Vecs<T, D>& points, int each = 8) {
  geometry::Pcg32 random(11);
  Vecs<T, D> queries{geometry::Vec<T, D>{}};
  if (points.empty()) return queries;
  geometry::Box<T, D> box;
  for (const auto& p : points) box.grow(p);
  for (int i = 0; i < each; ++i) {
    queries.push_back(points[random.below(static_cast<std::uint32_t>(points.size()))]);
    for (T margin : {T(0), T(0.5)}) {
      auto q = uniform_point<T, D>(random, -margin, T(1) + margin);
      for (int a = 0; a < D; ++a)
        q[a] = std::clamp(box.low[a] + q[a] * box.extent()[a], std::numeric_limits<T>::lowest(),
                          std::numeric_limits<T>::max());
      queries.push_back(q);
    }
  }
  return queries;
}

// ---- truth ---------------------------------------------------------------------------------------------

/// Wide enough that its own rounding and range do not matter: 64 bits of digits and 15 of exponent.
using Wide = long double;

template <class T, int D>
Wide wide_distance2(const geometry::Vec<T, D>& p, const geometry::Vec<T, D>& q) {
  Wide sum = 0;
  for (int a = 0; a < D; ++a) {
    const Wide d = static_cast<Wide>(p[a]) - static_cast<Wide>(q[a]);
    sum += d * d;
  }
  return sum;
}

/// Relative error of a squared distance in T: D + 2 roundings (subtraction counts twice, being squared).
template <class T, int D>
inline constexpr Wide distance2_error = geometry::tolerance::gamma<T>(D + 2);

/// All points by distance in Wide, ties by id.
template <class T, int D>
std::vector<std::pair<Wide, Id>> ranked(const Vecs<T, D>& points, const geometry::Vec<T, D>& q) {
  std::vector<std::pair<Wide, Id>> r(points.size());
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = {wide_distance2(points[i], q), static_cast<Id>(i)};
  std::sort(r.begin(), r.end());
  return r;
}

template <class T>
std::set<Id> ids_of(const std::vector<Neighbor<T>>& list) {
  std::set<Id> ids;
  for (const auto& n : list) EXPECT_TRUE(ids.insert(n.id).second) << "id " << n.id << " twice";
  return ids;
}
inline std::set<Id> ids_of(const std::vector<Id>& list) {
  std::set<Id> ids;
  for (const Id id : list) EXPECT_TRUE(ids.insert(id).second) << "id " << id << " twice";
  return ids;
}

}  // namespace treeline::accel::test
