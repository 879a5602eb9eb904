// How a point ranks does not depend on how many are asked for, nor on what else the answer holds; and clouds
// from the least to the largest numbers that there are lose no digits.
#include "points_common.hpp"

namespace treeline::accel::test {
namespace {

template <class T>
class PointRanks : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(PointRanks, Scalars);

/// Ordinary points, dust whose squares vanish, outliers whose squares overflow, some of all equal.
template <class T>
Vecs<T, 3> dust_and_outliers(std::uint64_t seed) {
  constexpr int most = std::numeric_limits<T>::max_exponent;
  geometry::Pcg32 random(seed);
  Vecs<T, 3> points;
  for (int i = 0; i < 160; ++i) {
    auto p = uniform_point<T, 3>(random, T(-1), T(1));
    const std::uint32_t kind = random.below(8);
    if (kind < 3) p = p * std::ldexp(T(1), -most / 2 - 2 + static_cast<int>(random.below(8)));
    if (kind == 3) p = p * std::ldexp(T(1), most / 4 * 3);
    if (kind == 4) p[2] = 0;
    if (kind == 5) p[2] = std::ldexp(p[2], -most / 2);
    points.push_back(kind == 6 && !points.empty() ? points[random.below(std::uint32_t(points.size()))] : p);
  }
  return points;
}

TYPED_TEST(PointRanks, TheFirstOfManyAreTheFew) {
  using T = TypeParam;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const auto points = dust_and_outliers<T>(seed);
    const std::size_t n = points.size();
    std::vector<std::vector<Neighbor<T>>> of_brute;
    for_each_tree<T, 3>(points, [&](const std::string& name, const auto& tree) {
      for (std::size_t i = 0; i < 8; ++i) {
        auto q = points[i * 17];
        if (i % 2) q = q * T(1.25);
        if (i == 7) q = {};
        std::vector<Neighbor<T>> all(n), few(n);
        ASSERT_EQ(tree.nearest(q, n, all), n);
        if (of_brute.size() == i) of_brute.push_back(all);  // brute force comes first
        ASSERT_EQ(all, of_brute[i]) << name;
        for (std::size_t k = 1; k < n; k += 1 + k / 6) {
          ASSERT_EQ(tree.nearest(q, k, few), k);
          ASSERT_TRUE(std::equal(few.begin(), few.begin() + std::ptrdiff_t(k), all.begin())) << k;
          Work work;
          std::vector<Neighbor<T>> within;
          tree.within(q, std::numeric_limits<T>::infinity(), {.at_most = k}, within, work);
          ASSERT_TRUE(std::ranges::equal(within, std::span(few).first(k))) << k;
        }
        // And they are the nearest, as nearly as T tells.
        const auto truth = ranked(points, q);
        const Wide error = distance2_error<T, 3>;
        for (std::size_t j = 0; j < n; ++j) {
          ASSERT_LE(wide_distance2(points[all[j].id], q), truth[j].first * (1 + 2 * error + error * error))
              << j;
        }
      }
    });
  }
}

/// Coordinates of every size that there is, zeros among them; the largest would overflow but for a scale that
/// takes the smallest ones' digits.
template <class T>
Vecs<T, 3> every_number(std::uint64_t seed, std::size_t n) {
  using Limits = std::numeric_limits<T>;
  geometry::Pcg32 random(seed);
  const auto number = [&]() -> T {
    switch (random.below(4)) {
      case 0:
        return std::ldexp(random.uniform(T(-1), T(1)),
                          -Limits::max_exponent + 2 - static_cast<int>(random.below(30)));
      case 1:
        return Limits::max() * random.uniform(T(-1), T(1));
      case 2:
        return Limits::denorm_min() * static_cast<T>(random.below(5));
      default:
        return random.uniform(T(-1), T(1));
    }
  };
  Vecs<T, 3> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (int a = 0; a < 3; ++a) points[i][a] = number();
    if (i > 0 && i % 3 == 0) {  // beside another one, by a step on one axis
      points[i] = points[random.below(std::uint32_t(i))];
      T& x = points[i][static_cast<int>(random.below(3))];
      x = std::nextafter(x, T(0));
    }
  }
  return points;
}

TYPED_TEST(PointRanks, FromTheLeastToTheLargestNumbers) {
  using T = TypeParam;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    const auto points = every_number<T>(seed, 400);
    for_each_tree<T, 3>(points, [&](const std::string&, const auto& tree) {
      for (std::size_t i = 0; i < points.size(); i += 13) {
        const auto& q = points[i];
        std::set<Id> same, in;
        geometry::Box<T, 3> box, point{q, q};
        box.grow(q), box.grow(points[(i * 7 + 3) % points.size()]);
        for (Id id = 0; id < points.size(); ++id) {
          if (points[id] == q) same.insert(id);
          if (box.contains(points[id])) in.insert(id);
        }
        std::vector<Neighbor<T>> found;
        std::vector<Id> ids;
        tree.within(q, T(0), found);
        ASSERT_EQ(ids_of(found), same);
        tree.inside(point, ids);
        ASSERT_EQ(ids_of(ids), same);
        tree.inside(box, ids);
        ASSERT_EQ(ids_of(ids), in);
        // Strictly smaller boxes leave out what lies on the sides.
        for (int a = 0; a < 3; ++a)
          box.low[a] = std::nextafter(box.low[a], std::numeric_limits<T>::infinity());
        std::erase_if(in, [&](Id id) { return !box.contains(points[id]); });
        tree.inside(box, ids);
        ASSERT_EQ(ids_of(ids), in);
        // Itself and its copies first, whatever is beside them.
        found.assign(same.size() + 1, {});
        ASSERT_EQ(tree.nearest(q, found.size(), found), found.size());
        found.pop_back();
        ASSERT_EQ(ids_of(found), same);
      }
    });
  }
}

// Boxes whose bounds lose digits to a scale that takes none from the points.
TYPED_TEST(PointRanks, BoundsTinyBesideTheCloud) {
  using T = TypeParam;
  auto points = uniform_cloud<T, 3>(200);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = points[i] * std::ldexp(T(1), std::numeric_limits<T>::max_exponent - 4);
    if (i % 3 == 0) points[i][0] = 0;
  }
  const T least = std::numeric_limits<T>::denorm_min(), far = std::numeric_limits<T>::max();
  for_each_tree<T, 3>(points, [&](const std::string&, const auto& tree) {
    std::vector<Id> ids;
    for (const T low : {-least, T(0), least}) {
      tree.inside({{low, -far, -far}, {far, far, far}}, ids);
      EXPECT_EQ(ids.size(), low > 0 ? 133u : 200u);
      tree.inside({{-far, -far, -far}, {-low, far, far}}, ids);
      EXPECT_EQ(ids.size(), low > 0 ? 0u : 67u);
    }
  });
}

}  // namespace
}  // namespace treeline::accel::test
