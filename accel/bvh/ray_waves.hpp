// Batches of incoherent rays among few triangles: a ray a lane, all of them down the tree together.
//
// Problem: in a tree that fits the first caches, a ray alone spends its time on being made ready, on branches
// that nobody can foresee, and on leaves of which it needs one triangle. Method: thousands of rays go down a
// binary tree at once (Barringer and Akenine-Möller 2014, dynamic ray stream traversal): each node takes the
// list of those rays that met it, sixteen at a time, tests both children's boxes and passes on two shorter
// lists; each leaf tests one triangle against sixteen rays. Rays are sorted by their largest axis only, so
// that one shear of Woop's test fits a list. Boxes, shears, edges and t are computed as wide_ray.hpp and
// wide_woop.hpp do, rounding for rounding; a ray for which these would ask for exact products, or whose
// direction has a component of (almost) nothing, is cast by itself into the wide tree, which this holds as
// well and which answers all else: single rays, other instruction sets than AVX-512, small batches, and
// scenes of more than `most_triangles`; in rooms, its batches go down one of leaves half as large. All
// answers are those of the wide tree. Cost: two or three trees in memory. Known weakness: rays of a list are
// not sorted front to back, and lists get shorter the deeper the tree is: with leaves of a few rays each,
// which more triangles bring about, lanes stay empty.
#pragma once

#include <optional>

#include "accel/bvh/build_binned.hpp"
#include "accel/bvh/triangle_input.hpp"
#include "accel/bvh/wide_triangles.hpp"

namespace treeline::accel {

class RayWaves {
 public:
  using Tree = Bvh<Triangles<float, geometry::Watertight>, Wide>;
  using Scalar = float;
  using Point = Tree::Point;
  using Box = Tree::Box;
  using Ray = Tree::Ray;
  using Options = WideTriangleOptions;

  /// Above it, batches go to the wide tree. Measured in rooms, on what paths do after their first hit: with
  /// 34 triangles a ray takes half the wide tree's time, with 300 about as much, with 2400 a quarter more, on
  /// a Xeon; on a Zen 4, whose vectors of sixteen take two steps, paths gain a quarter with 28 triangles over
  /// Embree's single rays, lose 3 % with 108 and a fifth with 194.
  static constexpr std::size_t most_triangles = 100;
  /// Up to here leaves of four triangles serve batches better than those of eight: with AVX2, rays take 2, 10
  /// and 5 % less and shadow rays 7, 15 and 10 % less with 58, 378 and 818 triangles, 5 and 10 % more with
  /// 4900.
  static constexpr std::size_t most_in_small_leaves = 1500;
  /// A batch of fewer rays goes to the wide tree, too.
  static constexpr std::size_t least_rays = 64;

  /// Throws as the wide tree does.
  explicit RayWaves(const geometry::Mesh<float>& mesh, const Options& options = {});

  Hit<float> closest_hit(const Ray& ray) const { return tree_.closest_hit(ray); }
  template <WorkCounter W>
  Hit<float> closest_hit(const Ray& ray, W& work) const {
    return tree_.closest_hit(ray, work);
  }
  bool any_hit(const Ray& ray) const { return tree_.any_hit(ray); }
  template <WorkCounter W>
  bool any_hit(const Ray& ray, W& work) const {
    return tree_.any_hit(ray, work);
  }
  void closest_hit(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads) const;
  /// As the wide tree's: u and v are 0.
  void closest_face(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads) const;
  void any_hit(std::span<const Ray> rays, std::span<std::uint8_t> answers, int threads) const;

  const Tree& tree() const { return tree_; }
  std::size_t size() const { return tree_.size(); }
  std::size_t bytes() const {
    return tree_.bytes() + (small_ ? small_->bytes() : 0) + nodes_.capacity() * sizeof(BinaryNode) +
           corners_.capacity() * sizeof(Corners);
  }
  TreeStats stats() const { return tree_.stats(); }

 private:
  struct Corners {
    float corner[3][3];  // a, b, c by axis
    Id id;
  };
  class Wave;

  template <class F>
  void in_tree(F&& f) const {
    if (small_)
      f(*small_);
    else
      f(tree_);
  }

  template <bool weights>
  void closest_hits(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads) const;
  /// What is asked of a hit.
  enum class Ask { weights, face, any };
  template <Ask ask, class Finish, class Alone>
  void cast(std::span<const Ray> rays, std::size_t begin, std::size_t end, Finish&& finish,
            Alone&& alone) const;

  Tree tree_;
  std::optional<Bvh<Triangles<float, geometry::Watertight>, WideOf<8, 4>>> small_;
  Point centre_{};
  Box bounds_{};
  std::vector<BinaryNode> nodes_;  // none: all goes to the wide tree
  std::vector<Corners> corners_;   // leaf by leaf
};

inline RayWaves::RayWaves(const geometry::Mesh<float>& mesh, const Options& options) : tree_(mesh, options) {
  if (mesh.size() <= most_in_small_leaves) small_.emplace(mesh, options);
  if (TREELINE_SIMD != 512 || mesh.size() > most_triangles) return;
  const TriangleInput input(mesh, options.non_finite, options.threads);
  if (input.place().scale.scales()) return;
  centre_ = input.place().centre, bounds_ = input.place().bounds;
  BinaryBuildOptions how;
  how.block = how.largest_leaf = 2, how.node_cost = options.node_cost, how.threads = options.threads;
  BinaryTree binary = build_binned(input.triangles(), how);
  nodes_ = std::move(binary.nodes);
  for (const std::uint32_t i : binary.references) {
    const geometry::Triangle<float>& t = input.triangles()[i];
    const Point* const corner[3] = {&t.a, &t.b, &t.c};
    Corners& c = corners_.emplace_back();
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) c.corner[k][axis] = (*corner[k])[axis];
    c.id = input.ids().empty() ? i : input.ids()[i];
  }
}

#if TREELINE_SIMD == 512

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // GCC's header leaves registers undefined on purpose

/// Some rays on their way, all of one largest axis.
class RayWaves::Wave {
 public:
  Wave(const RayWaves& waves, std::size_t n) : waves_(waves), room_(n + lanes) {
    for (std::vector<float>& v : values_) v.resize(room_);
    best_.resize(room_), given_.resize(room_), doubtful_.resize(room_);
  }

  /// Casts those of the rays whose numbers are listed; at most as many as there is room for. finish(number,
  /// hit), or doubt(number) for one that has to be cast by itself.
  template <Ask ask, class Finish, class Doubt>
  void cast(std::span<const Ray> rays, std::span<const std::uint32_t> numbers, int axis, Finish&& finish,
            Doubt&& doubt) {
    axes_[0] = (axis + 1) % 3, axes_[1] = (axis + 2) % 3, axes_[2] = axis;
    size_ = numbers.size();
    prepare(rays, numbers);
    lists_.resize(std::max(lists_.size(), 4 * room_));
    for (std::size_t i = 0; i < size_; ++i) lists_[i] = static_cast<std::uint32_t>(i);
    if (size_ > 0) visit<ask == Ask::any>(0, 0, size_, size_);
    if (ask == Ask::weights) weigh();
    for (std::size_t i = 0; i < size_; ++i) {
      if (doubtful_[i] != 0) {
        doubt(numbers[i]);
        continue;
      }
      Hit<float> hit;
      if (best_[i] != none) hit.t = values_[limit][i], hit.primitive = waves_.corners_[best_[i]].id;
      if (best_[i] != none && ask == Ask::weights) hit.u = values_[weight_b][i], hit.v = values_[weight_c][i];
      finish(numbers[i], hit);
    }
  }

 private:
  using V = __m512;
  using I = __m512i;
  static constexpr std::size_t lanes = 16;
  static constexpr std::uint32_t none = 0xffffffffu;
  // By axis as sheared; then what Woop's test needs, and what the nearest hit so far leaves.
  enum Value {
    origin = 0,
    inverse = 3,
    enter_from = 6,
    exit_from = 9,
    shear = 12,
    speed = 14,
    slack,
    limit,
    count,
    weight_b = enter_from,
    weight_c = exit_from
  };  // when boxes are done with

  static V all(float x) { return _mm512_set1_ps(x); }
  static V times(V a, V b) {
    V r = _mm512_mul_ps(a, b);
    asm("" : "+v"(r));  // not fused into a sum
    return r;
  }
  static V minus(V a, V b) { return _mm512_sub_ps(a, b); }
  static __mmask16 first(std::size_t n) {
    return static_cast<__mmask16>(n >= lanes ? 0xffffu : (1u << n) - 1);
  }
  V gathered(int value, I at) const {
    return _mm512_i32gather_ps(at, values_[static_cast<std::size_t>(value)].data(), 4);
  }

  void prepare(std::span<const Ray> rays, std::span<const std::uint32_t> numbers) {
    static_assert(sizeof(Ray) == 8 * sizeof(float));
    const float* const base = rays[0].origin.v;
    constexpr float u = geometry::tolerance::unit_roundoff<float>, least = std::numeric_limits<float>::min();
    for (std::size_t i = 0; i < size_; i += lanes) {
      const I at = _mm512_slli_epi32(_mm512_maskz_loadu_epi32(first(size_ - i), numbers.data() + i), 3);
      const auto put = [&](int value, V x) {
        _mm512_storeu_ps(values_[static_cast<std::size_t>(value)].data() + i, x);
      };
      V o[3], d[3], reach = all(0);
      for (int k = 0; k < 3; ++k) {
        const int axis = axes_[k];
        o[k] = minus(_mm512_i32gather_ps(at, base + axis, 4), all(waves_.centre_[axis]));
        d[k] = _mm512_i32gather_ps(at, base + 3 + axis, 4);
        reach = _mm512_max_ps(reach, _mm512_abs_ps(minus(all(waves_.bounds_.low[axis]), o[k])));
        reach = _mm512_max_ps(reach, _mm512_abs_ps(minus(all(waves_.bounds_.high[axis]), o[k])));
      }
      const V box = _mm512_add_ps(times(all(wide::box_slack), reach), all(least));
      for (int k = 0; k < 3; ++k) {
        const V padding = _mm512_add_ps(times(_mm512_abs_ps(o[k]), all(3 * u)), box);
        const V above = _mm512_add_ps(o[k], padding), below = minus(o[k], padding);
        const __mmask16 backward = _mm512_cmp_ps_mask(d[k], all(0), _CMP_LT_OQ);
        put(origin + k, o[k]), put(inverse + k, _mm512_div_ps(all(1), d[k]));
        put(enter_from + k, _mm512_mask_blend_ps(backward, above, below));
        put(exit_from + k, _mm512_mask_blend_ps(backward, below, above));
      }
      for (int k = 0; k < 2; ++k) put(shear + k, _mm512_div_ps(d[k], d[2]));
      put(speed, d[2]);
      put(slack, _mm512_add_ps(times(all(wide::mean_slack), reach), all(least)));
      put(limit, _mm512_min_ps(_mm512_i32gather_ps(at, base + 7, 4), all(std::numeric_limits<float>::max())));
      _mm512_storeu_si512(best_.data() + i, _mm512_set1_epi32(-1));
      _mm512_storeu_si512(given_.data() + i, _mm512_set1_epi32(-1));
      _mm512_storeu_si512(doubtful_.data() + i, _mm512_setzero_si512());
    }
  }

  /// The list of n rays at `begin` has met the node. From `free` on there is room for lists.
  template <bool any>
  void visit(std::uint32_t number, std::size_t begin, std::size_t n, std::size_t free) {
    const BinaryNode& node = waves_.nodes_[number];
    if (node.count > 0) return leaf<any>(node, begin, n);
    const std::size_t list_a = free, list_b = list_a + n + lanes;
    if (lists_.size() < list_b + n + lanes) lists_.resize(2 * (list_b + n + lanes));
    std::size_t met_a = 0, met_b = 0, nearer_a = 0, nearer_b = 0;
    const auto ones = [](__mmask16 m) {
      return static_cast<std::size_t>(std::popcount(static_cast<unsigned>(m)));
    };
    const BinaryNode &a = waves_.nodes_[node.first], &b = waves_.nodes_[node.first + 1];
    for (std::size_t i = 0; i < n; i += lanes) {
      const __mmask16 present = first(n - i);
      const I at = _mm512_maskz_loadu_epi32(present, lists_.data() + begin + i);
      V enter[2] = {all(0), all(0)}, exit[2];
      exit[0] = exit[1] = gathered(limit, at);
      for (int k = 0; k < 3; ++k) {
        const V inv = gathered(inverse + k, at), from = gathered(enter_from + k, at),
                to = gathered(exit_from + k, at);
        const __mmask16 backward = _mm512_movepi32_mask(_mm512_castps_si512(inv));
        for (int c = 0; c < 2; ++c) {
          const Box& box = c == 0 ? a.box : b.box;
          const V low = all(box.low[axes_[k]]), high = all(box.high[axes_[k]]);
          enter[c] =
              _mm512_max_ps(times(minus(_mm512_mask_blend_ps(backward, low, high), from), inv), enter[c]);
          exit[c] = _mm512_min_ps(times(minus(_mm512_mask_blend_ps(backward, high, low), to), inv), exit[c]);
        }
      }
      const __mmask16 in_a = _mm512_mask_cmp_ps_mask(present, enter[0], exit[0], _CMP_LE_OQ);
      const __mmask16 in_b = _mm512_mask_cmp_ps_mask(present, enter[1], exit[1], _CMP_LE_OQ);
      _mm512_storeu_si512(lists_.data() + list_a + met_a, _mm512_maskz_compress_epi32(in_a, at));
      _mm512_storeu_si512(lists_.data() + list_b + met_b, _mm512_maskz_compress_epi32(in_b, at));
      met_a += ones(in_a), met_b += ones(in_b);
      const auto both = static_cast<__mmask16>(in_a & in_b);
      nearer_a += ones(_mm512_mask_cmp_ps_mask(both, enter[0], enter[1], _CMP_LT_OQ));
      nearer_b += ones(_mm512_mask_cmp_ps_mask(both, enter[1], enter[0], _CMP_LT_OQ));
    }
    const std::size_t above = list_b + met_b + lanes;
    if (nearer_b > nearer_a && met_b > 0) visit<any>(node.first + 1, list_b, met_b, above);
    if (met_a > 0) visit<any>(node.first, list_a, met_a, above);
    if (nearer_b <= nearer_a && met_b > 0) visit<any>(node.first + 1, list_b, met_b, above);
  }

  /// Weights of the second and third corner, with exact products of the sheared corners, as WoopTest's.
  void weigh() {
    static_assert(sizeof(Corners) == 10 * sizeof(float));
    const float* const base = waves_.corners_[0].corner[0];
    for (std::size_t i = 0; i < size_; i += lanes) {
      const I best = _mm512_loadu_si512(best_.data() + i);
      const __mmask16 hit = _mm512_mask_cmpneq_epi32_mask(first(size_ - i), best, _mm512_set1_epi32(-1));
      if (hit == 0) continue;
      const I at = _mm512_mullo_epi32(best, _mm512_set1_epi32(10));
      const auto own = [&](int value) {
        return _mm512_loadu_ps(values_[static_cast<std::size_t>(value)].data() + i);
      };
      V x[3], y[3];
      for (int k = 0; k < 3; ++k) {
        const auto along = [&](int axis) {
          const V c = _mm512_mask_i32gather_ps(all(0), hit, at, base + 3 * k + axes_[axis], 4);
          return minus(c, own(origin + axis));
        };
        const V z = along(2);
        x[k] = minus(along(0), times(own(shear), z)), y[k] = minus(along(1), times(own(shear + 1), z));
      }
      for (int half = 0; half < 2; ++half) {
        const auto wide = [&](V v) {
          return _mm512_cvtps_pd(half == 0 ? _mm512_castps512_ps256(v) : _mm512_extractf32x8_ps(v, 1));
        };
        const auto edge = [&](int p, int q) {
          return _mm512_sub_pd(_mm512_mul_pd(wide(x[p]), wide(y[q])), _mm512_mul_pd(wide(y[p]), wide(x[q])));
        };
        const __m512d u = edge(2, 1), v = edge(0, 2), w = edge(1, 0);
        const __m512d sum = _mm512_add_pd(_mm512_add_pd(u, v), w);
        const std::size_t to = i + 8 * static_cast<std::size_t>(half);
        _mm256_storeu_ps(values_[weight_b].data() + to, _mm512_cvtpd_ps(_mm512_div_pd(v, sum)));
        _mm256_storeu_ps(values_[weight_c].data() + to, _mm512_cvtpd_ps(_mm512_div_pd(w, sum)));
      }
    }
  }

  struct Sheared {
    V x, y, z;
  };
  static V edge(const Sheared& p, const Sheared& q) { return minus(times(p.x, q.y), times(p.y, q.x)); }

  template <bool any>
  void leaf(const BinaryNode& node, std::size_t begin, std::size_t n) {
    for (std::size_t i = 0; i < n; i += lanes) {
      const __mmask16 present = first(n - i);
      const I at = _mm512_maskz_loadu_epi32(present, lists_.data() + begin + i);
      const V o[3] = {gathered(origin, at), gathered(origin + 1, at), gathered(origin + 2, at)};
      const V sx = gathered(shear, at), sy = gathered(shear + 1, at);
      for (std::uint32_t r = node.first; r < node.first + node.count; ++r) {
        const Corners& triangle = waves_.corners_[r];
        const auto sheared = [&](int k) {
          const float* const c = triangle.corner[k];
          const V z = minus(all(c[axes_[2]]), o[2]);
          return Sheared{minus(minus(all(c[axes_[0]]), o[0]), times(sx, z)),
                         minus(minus(all(c[axes_[1]]), o[1]), times(sy, z)), z};
        };
        const Sheared a = sheared(0), b = sheared(1), c = sheared(2);
        const V u = edge(c, b), v = edge(a, c), w = edge(b, a);
        const __mmask16 below = _mm512_cmp_ps_mask(_mm512_min_ps(_mm512_min_ps(u, v), w), all(0), _CMP_LT_OQ);
        const __mmask16 above = _mm512_cmp_ps_mask(all(0), _mm512_max_ps(_mm512_max_ps(u, v), w), _CMP_LT_OQ);
        const auto inside = static_cast<__mmask16>(~(below & above) & present);
        if (inside != 0) inside_of<any>(r, at, inside, a, b, c, u, v, w);
      }
    }
  }

  template <bool any>
  [[gnu::always_inline]] void inside_of(std::uint32_t r, I at, __mmask16 inside, const Sheared& a,
                                        const Sheared& b, const Sheared& c, V u, V v, V w) {
    const V sum = _mm512_add_ps(_mm512_add_ps(u, v), w);
    const auto mean = [&](V x, V y, V z) {
      return _mm512_add_ps(_mm512_add_ps(times(u, x), times(v, y)), times(w, z));
    };
    const V t = _mm512_div_ps(mean(a.z, b.z, c.z), times(sum, gathered(speed, at)));
    const V size = _mm512_abs_ps(sum);
    const V least = _mm512_min_ps(_mm512_min_ps(_mm512_abs_ps(u), _mm512_abs_ps(v)), _mm512_abs_ps(w));
    const V gap = _mm512_max_ps(_mm512_abs_ps(mean(a.x, b.x, c.x)), _mm512_abs_ps(mean(a.y, b.y, c.y)));
    __mmask16 sure = _mm512_mask_cmp_ps_mask(inside, all(smallest_sum), size, _CMP_LT_OQ);
    sure = _mm512_mask_cmp_ps_mask(sure, size, all(largest_sum), _CMP_LT_OQ);
    sure = _mm512_mask_cmp_ps_mask(sure, all(0), least, _CMP_LT_OQ);
    sure = _mm512_mask_cmp_ps_mask(sure, gap, times(size, gathered(slack, at)), _CMP_LE_OQ);
    if (const auto doubt = static_cast<__mmask16>(inside & ~sure); doubt != 0)
      _mm512_mask_i32scatter_epi32(doubtful_.data(), doubt, at, _mm512_set1_epi32(1), 4);
    const V so_far = gathered(limit, at);
    __mmask16 hit = _mm512_mask_cmp_ps_mask(sure, all(0), t, _CMP_LE_OQ);
    hit = _mm512_mask_cmp_ps_mask(hit, t, so_far, _CMP_LE_OQ);
    if (hit == 0) return;
    const Id id = waves_.corners_[r].id;
    if (!any) {  // of equals the lowest id
      const I ids = _mm512_i32gather_epi32(at, given_.data(), 4);
      const __mmask16 as_near = _mm512_mask_cmp_ps_mask(hit, t, so_far, _CMP_EQ_OQ);
      hit = static_cast<__mmask16>(
          hit & ~_mm512_mask_cmple_epu32_mask(as_near, ids, _mm512_set1_epi32(static_cast<int>(id))));
      _mm512_mask_i32scatter_epi32(given_.data(), hit, at, _mm512_set1_epi32(static_cast<int>(id)), 4);
    }
    _mm512_mask_i32scatter_epi32(best_.data(), hit, at, _mm512_set1_epi32(static_cast<int>(r)), 4);
    _mm512_mask_i32scatter_ps(values_[limit].data(), hit, at, any ? all(-1) : t, 4);
  }

  static constexpr float smallest_sum = 1e-25f, largest_sum = 1e25f;  // as in wide_woop.hpp

  const RayWaves& waves_;
  int axes_[3] = {0, 1, 2};
  std::size_t room_, size_ = 0;
  std::vector<float> values_[count];
  std::vector<std::uint32_t> best_, given_, doubtful_;  // best_: place in corners_; given_: its id
  std::vector<std::uint32_t> lists_;
};

template <RayWaves::Ask ask, class Finish, class Alone>
void RayWaves::cast(std::span<const Ray> rays, std::size_t begin, std::size_t end, Finish&& finish,
                    Alone&& alone) const {
  constexpr float slow = 1e-15f,
                  fast = 1e8f;            // what is beyond goes by itself: its quotients may be inaccurate
  std::vector<std::uint32_t> numbers[4];  // by largest axis; those that go by themselves
  for (auto& list : numbers) list.resize(end - begin + 16);
  std::size_t sizes[4] = {};
  const float* const base = rays[0].origin.v;
  for (std::size_t i = begin; i < end; i += 16) {
    const __mmask16 present = static_cast<__mmask16>(end - i >= 16 ? 0xffffu : (1u << (end - i)) - 1);
    const __m512i number =
        _mm512_add_epi32(_mm512_load_si512(simd::lane_numbers), _mm512_set1_epi32(static_cast<int>(i)));
    const __m512i at = _mm512_slli_epi32(number, 3);
    const auto gathered = [&](int place) {
      return _mm512_mask_i32gather_ps(_mm512_setzero_ps(), present, at, base + place, 4);
    };
    const __m512 x = _mm512_abs_ps(gathered(3)), y = _mm512_abs_ps(gathered(4)),
                 z = _mm512_abs_ps(gathered(5));
    const __m512 least = _mm512_min_ps(_mm512_min_ps(x, y), z), most = _mm512_max_ps(_mm512_max_ps(x, y), z);
    __mmask16 goes = _mm512_mask_cmp_ps_mask(present, gathered(6), _mm512_setzero_ps(), _CMP_EQ_OQ);
    goes = _mm512_mask_cmp_ps_mask(goes, _mm512_set1_ps(slow), least, _CMP_LT_OQ);
    goes = _mm512_mask_cmp_ps_mask(goes, most, _mm512_set1_ps(fast), _CMP_LT_OQ);
    goes = _mm512_mask_cmp_ps_mask(goes, _mm512_set1_ps(1 / fast), most, _CMP_LT_OQ);
    // The first of equals, as largest_axis() has it.
    const __mmask16 in_x = _mm512_mask_cmp_ps_mask(goes, x, most, _CMP_EQ_OQ);
    const __mmask16 in_y = _mm512_mask_cmp_ps_mask(static_cast<__mmask16>(goes & ~in_x), y, most, _CMP_EQ_OQ);
    const __mmask16 list[4] = {in_x, in_y, static_cast<__mmask16>(goes & ~in_x & ~in_y),
                               static_cast<__mmask16>(present & ~goes)};
    for (int k = 0; k < 4; ++k) {
      _mm512_storeu_si512(numbers[k].data() + sizes[k], _mm512_maskz_compress_epi32(list[k], number));
      sizes[k] += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(list[k])));
    }
  }
  for (std::size_t i = 0; i < sizes[3]; ++i) alone(numbers[3][i]);
  Wave wave(*this, std::max({sizes[0], sizes[1], sizes[2]}));
  for (int axis = 0; axis < 3; ++axis)
    wave.cast<ask>(rays, std::span<const std::uint32_t>(numbers[axis].data(), sizes[axis]), axis, finish,
                   alone);
}

template <bool weights>
void RayWaves::closest_hits(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads) const {
  if (nodes_.empty() || rays.size() < least_rays)
    return in_tree([&](const auto& tree) {
      if constexpr (weights)
        tree.closest_hit(rays, hits, threads);
      else
        tree.closest_face(rays, hits, threads);
    });
  check_rays(rays, hits.size());
  parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
    cast<weights ? Ask::weights : Ask::face>(
        rays, begin, end, [&](std::size_t i, const Hit<float>& hit) { hits[i] = hit; },
        [&](std::size_t i) {
          hits[i] = tree_.closest_hit(rays[i]);
          if (!weights) hits[i].u = hits[i].v = 0;
        });
  });
}
inline void RayWaves::closest_hit(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads) const {
  closest_hits<true>(rays, hits, threads);
}
inline void RayWaves::closest_face(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads) const {
  closest_hits<false>(rays, hits, threads);
}

inline void RayWaves::any_hit(std::span<const Ray> rays, std::span<std::uint8_t> answers, int threads) const {
  if (nodes_.empty() || rays.size() < least_rays)
    return in_tree([&](const auto& tree) { tree.any_hit(rays, answers, threads); });
  check_rays(rays, answers.size());
  parallel_ranges(rays.size(), threads, [&](std::size_t begin, std::size_t end) {
    cast<Ask::any>(
        rays, begin, end, [&](std::size_t i, const Hit<float>& hit) { answers[i] = hit ? 1 : 0; },
        [&](std::size_t i) { answers[i] = tree_.any_hit(rays[i]) ? 1 : 0; });
  });
}

#pragma GCC diagnostic pop

#else

inline void RayWaves::closest_hit(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads) const {
  in_tree([&](const auto& tree) { tree.closest_hit(rays, hits, threads); });
}
inline void RayWaves::closest_face(std::span<const Ray> rays, std::span<Hit<float>> hits, int threads) const {
  in_tree([&](const auto& tree) { tree.closest_face(rays, hits, threads); });
}
inline void RayWaves::any_hit(std::span<const Ray> rays, std::span<std::uint8_t> answers, int threads) const {
  in_tree([&](const auto& tree) { tree.any_hit(rays, answers, threads); });
}

#endif

static_assert(RayIndex<RayWaves>);

}  // namespace treeline::accel
