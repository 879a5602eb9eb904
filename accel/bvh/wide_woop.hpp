// The watertight leaf test of the wide tree: Woop, Benthin and Wald 2013, all triangles of a leaf at once.
//
// The shear of a corner depends on that corner alone, each product of an edge function is rounded by itself,
// and zero counts as inside: no ray passes between two triangles that share an edge or a vertex. t is a mean
// of the corners' heights with weights that are not negative, so it does not leave the triangle. Nothing
// fuses, so all instruction sets answer the same. Known weakness: for a triangle seen edge-on the weights,
// and t within its range, are inaccurate.
#pragma once

#include "accel/bvh/wide_triangle_layout.hpp"
#include "accel/ray_query.hpp"
#include "accel/triangle_scale.hpp"
#include "geometry/predicates.hpp"
#include "geometry/ray.hpp"

namespace treeline::accel::wide {

/// How far the mean of a triangle's corners may be beside the ray before its weights count as cancelled,
/// relative to the reach: an eighth of what the corners' own roundings may leave between a hit and its ray
/// (hit_slack).
inline constexpr float mean_slack = geometry::tolerance::hit_slack<float> / 8;

/// The triangle test, prepared for a ray; N triangles a leaf.
template <int N>
class WoopTest {
 public:
  using Leaf = RayLeaf<N>;

  WoopTest(const geometry::Ray<float>& ray, const geometry::Vec<float, 3>& centre,
           const geometry::Box<float, 3>& /*bounds*/, float reach)
      : slack_(mean_slack * reach + std::numeric_limits<float>::min()) {
    // largest_axis() without its branches, which nobody can foresee.
    const float size[3] = {std::abs(ray.direction[0]), std::abs(ray.direction[1]),
                           std::abs(ray.direction[2])};
    const int z = size[2] > std::max(size[0], size[1]) ? 2 : size[1] > size[0] ? 1 : 0;
    constexpr int next[4] = {1, 2, 0, 1};
    const int axes[3] = {next[z], next[z + 1], z};
    for (int k = 0; k < 3; ++k) {
      axis_[k] = static_cast<std::uint32_t>(axes[k]) * row;
      origin_[k] = ray.origin[axes[k]] - centre[axes[k]];
    }
    speed_ = ray.direction[z];
    for (int k = 0; k < 2; ++k) direction_[k] = ray.direction[axes[k]], shear_[k] = direction_[k] / speed_;
    t_min_ = begin_of(ray);
  }

  /// One bit for each triangle that is hit at a t of at most `limit`, and that t.
  [[gnu::always_inline]] std::uint32_t hits(const Leaf& leaf, float limit, float (&t)[N]) const {
    const Sheared a = sheared(leaf, 0), b = sheared(leaf, 1), c = sheared(leaf, 2);
    const F u = edge(c, b), v = edge(a, c), w = edge(b, a);
    const F zero = F::broadcast(0);
    // All three of one sign, zero being of either: what is not a number is looked at below.
    const std::uint32_t inside =
        ~(bits_lt(min(min(u, v), w), zero) & bits_lt(zero, max(max(u, v), w))) & every;
    if (inside == 0) return 0;
    const F sum = u + v + w;
    const F time = (u * a.z + v * b.z + w * c.z) / (sum * F::broadcast(speed_));
    time.store(t);
    const auto in_reach = [&](F x) {
      return bits_le(F::broadcast(t_min_), x) & bits_le(x, F::broadcast(limit));
    };
    std::uint32_t bits = inside & in_reach(time);
    // In doubt: a sum whose quotient could be inaccurate; an edge of zero; weights that cancelled, which show
    // in that the mean of the corners is not where the ray is.
    const F size = absolute(sum), least = min(min(absolute(u), absolute(v)), absolute(w));
    const auto beside = [&](F x, F y, F z) { return absolute(u * x + v * y + w * z); };
    const F gap = max(beside(a.x, b.x, c.x), beside(a.y, b.y, c.y));
    const std::uint32_t sure = bits_lt(F::broadcast(smallest_sum), size) &
                               bits_lt(size, F::broadcast(largest_sum)) & bits_lt(zero, least) &
                               bits_le(gap, size * F::broadcast(slack_));
    for (std::uint32_t doubtful = inside & ~sure; doubtful != 0; doubtful &= doubtful - 1) {
      const int lane = std::countr_zero(doubtful);
      const bool hit = exactly(leaf, lane, t[lane]) && t_min_ <= t[lane] && t[lane] <= limit;
      bits = (bits & ~(1u << lane)) | (hit ? 1u << lane : 0u);
    }
    return bits;
  }

  /// Bits of triangles that the ray may hit when corners are off by up to `off` along an axis of the sheared
  /// space.
  [[gnu::always_inline]] std::uint32_t maybe(const Leaf& leaf, float off) const {
    const Sheared a = sheared(leaf, 0), b = sheared(leaf, 1), c = sheared(leaf, 2);
    const F u = edge(c, b), v = edge(a, c), w = edge(b, a);
    const auto size = [](const Sheared& p) { return max(absolute(p.x), absolute(p.y)); };
    const F offs = F::broadcast(off);
    const F error = F::broadcast(6 * off) * (max(max(size(a), size(b)), size(c)) + offs);
    const F least = min(min(u, v), w), most = max(max(u, v), w);
    return ~(bits_lt(least + error, F::broadcast(0)) & bits_lt(error, most)) & every;
  }

  /// Weights of the second and third corner.
  void weights(const Leaf& leaf, std::uint32_t lane, float& u, float& v) const {
    const auto [e, sum] = exact_edges(leaf, static_cast<int>(lane));
    u = static_cast<float>(e[1] / sum), v = static_cast<float>(e[2] / sum);
  }

 private:
  using F = simd::Floats<N>;
  static constexpr std::uint32_t every = (1u << N) - 1, row = N * sizeof(float);
  static constexpr float smallest_sum = 1e-25f, largest_sum = 1e25f;
  struct Sheared {
    F x, y, z;
  };
  struct Edges {
    std::array<double, 3> value;
    double sum;
  };

  [[gnu::always_inline]] Sheared sheared(const Leaf& leaf, int corner) const {
    const auto* p = reinterpret_cast<const unsigned char*>(leaf.corner[corner]);
    const auto along = [&](int k) {
      return F::load(reinterpret_cast<const float*>(p + axis_[k])) - F::broadcast(origin_[k]);
    };
    const F z = along(2);
    return {along(0) - F::broadcast(shear_[0]) * z, along(1) - F::broadcast(shear_[1]) * z, z};
  }
  [[gnu::always_inline]] static F edge(const Sheared& p, const Sheared& q) { return p.x * q.y - p.y * q.x; }

  /// The same for one triangle with exact products: those of floats are exact in double.
  Edges exact_edges(const Leaf& leaf, int lane) const {
    double x[3], y[3];
    for (int i = 0; i < 3; ++i) shear_one(leaf, lane, i, x[i], y[i]);
    const auto edge = [&](int p, int q) { return x[p] * y[q] - y[p] * x[q]; };
    Edges e{{edge(2, 1), edge(0, 2), edge(1, 0)}, 0};
    e.sum = e.value[0] + e.value[1] + e.value[2];
    return e;
  }
  /// Where the ray passes nearest to a triangle, from its corners as they are.
  geometry::TriangleHit<float> nearest(const Leaf& leaf, int lane) const {
    geometry::Ray<float> ray;
    geometry::Triangle<float> triangle;
    geometry::Vec<float, 3>* const corner[3] = {&triangle.a, &triangle.b, &triangle.c};
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(axis_[k] / row);
      ray.origin[axis] = origin_[k], ray.direction[axis] = k < 2 ? direction_[k] : speed_;
      for (int i = 0; i < 3; ++i) (*corner[i])[axis] = leaf.corner[i][axis][lane];
    }
    return detail::nearest_approach<double>(ray, triangle);
  }
  float height(const Leaf& leaf, int lane, int corner) const {
    return leaf.corner[corner][axis_[2] / row][lane] - origin_[2];
  }
  void shear_one(const Leaf& leaf, int lane, int corner, double& x, double& y) const {
    const float z = height(leaf, lane, corner);
    const auto along = [&](int k) {
      return leaf.corner[corner][axis_[k] / row][lane] - origin_[k] - geometry::rounded(shear_[k] * z);
    };
    x = double(along(0)), y = double(along(1));
  }
  [[gnu::noinline, gnu::cold]] bool exactly(const Leaf& leaf, int lane, float& t) const {
    const auto [e, sum] = exact_edges(leaf, lane);
    if ((e[0] < 0 || e[1] < 0 || e[2] < 0) && (e[0] > 0 || e[1] > 0 || e[2] > 0)) return false;
    if (sum == 0) return false;  // the ray lies in the plane
    t = nearest(leaf, lane).t;
    return true;
  }

  float origin_[3], shear_[2], speed_, t_min_, slack_, direction_[2];
  std::uint32_t
      axis_[3];  // bytes from a corner's first coordinates to those along x, y, z of the sheared space
};

}  // namespace treeline::accel::wide
