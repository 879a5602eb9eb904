// Random triangles and rays for laws, most of them degenerate in one way or another.
#pragma once

#include <rapidcheck.h>

#include <vector>

#include "geometry/ray.hpp"
#include "tests/geometry/meshes.hpp"

namespace treeline::test {

template <class T>
struct SoupMaker {
  enum Kind { even, grid, needles, no_area, copies, far_away, layers, kinds };

  Pcg32 random;
  Kind kind;

  Vec<T, 3> on_grid() {
    Vec<T, 3> p;
    for (int i = 0; i < 3; ++i) p[i] = static_cast<T>(random.below(4));
    return p;
  }
  Triangle<T> triangle() {
    const Vec<T, 3> a = random_vec<T>(random), d = random_vec<T>(random);
    Triangle<T> t{a, a + random_vec<T>(random), a + random_vec<T>(random)};
    switch (kind) {
      case grid:
        t = {on_grid(), on_grid(), on_grid()};
        break;
      case needles:
        t = {a, a + d * T(3) + random_vec<T>(random) * T(1e-5), a + d * T(2)};
        break;
      case no_area:
        t = random.below(2) ? Triangle<T>{a, a, a + d} : Triangle<T>{a, a + d, a + d * T(2)};
        break;
      case copies:
        t = {{0, 0, 1}, {2, 0, 1}, {0, 2, static_cast<T>(random.below(2))}};
        break;
      case far_away: {
        const Vec<T, 3> by{T(1e4), T(-2e4), T(5e3)};
        t = {t.a + by, t.b + by, t.c + by};
        break;
      }
      case layers: {
        const T z = static_cast<T>(random.below(5));
        t.a[2] = t.b[2] = t.c[2] = z;
        break;
      }
      default:
        break;
    }
    return t;
  }
  std::vector<Triangle<T>> triangles(std::size_t n) {
    std::vector<Triangle<T>> r(n);
    for (auto& t : r) t = triangle();
    return r;
  }

  /// In the middle of things, on a corner, on an edge, on a face, or around.
  Vec<T, 3> place(const std::vector<Triangle<T>>& soup) {
    if (soup.empty() || random.below(6) == 0) return random_vec<T>(random, -4, 4);
    const Triangle<T>& t = soup[random.below(static_cast<std::uint32_t>(soup.size()))];
    const T s = random.uniform<T>();
    switch (random.below(4)) {
      case 0:
        return t.b;
      case 1:
        return t.a + (t.c - t.a) * s;
      case 2:
        return t.a * T(0.25) + t.b * T(0.5) + t.c * T(0.25);
      default:
        return t.a + random_vec<T>(random, -2, 2);
    }
  }
  /// From place to place, or along an axis, some of them with bounds.
  Ray<T> ray(const std::vector<Triangle<T>>& soup) {
    Ray<T> r{place(soup), {}};
    r.direction = place(soup) - r.origin;
    if (random.below(4) == 0 || r.direction == Vec<T, 3>{}) {
      r.direction = Vec<T, 3>::filled(random.below(2) ? T(0) : -T(0));
      r.direction[static_cast<int>(random.below(3))] = random.below(2) ? T(1) : T(-2);
    }
    if (random.below(3) == 0) r.t_min = random.uniform<T>(-1, 1), r.t_max = r.t_min + random.uniform<T>(0, 2);
    return r;
  }
};

template <class T>
SoupMaker<T> any_soup() {
  using Maker = SoupMaker<T>;
  const auto kind = static_cast<typename Maker::Kind>(*rc::gen::inRange(0, int(Maker::kinds)));
  return {Pcg32(*rc::gen::arbitrary<std::uint64_t>()), kind};
}

}  // namespace treeline::test
