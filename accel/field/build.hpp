// Samples the signed distance to a mesh: all samples of the bricks that the surface comes near, and of the
// rest a side and a lower bound.
//
// Method. Boxes of bricks are halved from the whole lattice down. One closest-point query at the middle of a
// box's cells tells by the 1-Lipschitz property whether all of its samples are out of the band; it is then
// done with, if the distance is also twice the box's size, so that the bounds it leaves are good. In the
// bricks that remain this goes on down to cubes of 2³ samples. The samples left are visited along a Gray
// code, each next to the one before, whose distance and the way from there bound the search (Jones,
// Baerentzen and Sramek 2006 survey such builds). Two neighbours that are farther from the surface, together,
// than from each other lie on one side; what hangs together so has its side decided once. Distances are those
// to the triangle that the tree finds, in double. Cost: some 10 to 20 queries per brick face's worth of
// surface, each a fraction of an ordinary one, and a ray for each piece of a brick that the surface cuts off.
// Known weakness: that of closed_cycle.hpp.
#pragma once

#include <atomic>
#include <mutex>

#include "accel/bvh/build_tasks.hpp"
#include "accel/field/bound.hpp"
#include "accel/field/bricks.hpp"
#include "accel/field/closed_cycle.hpp"
#include "accel/field/sign.hpp"

namespace treeline::accel::field {

template <class S, class Tree, class Sign>
class FieldBuilder {
 public:
  FieldBuilder(const geometry::Mesh3f& mesh, const Tree& tree, const Sign& sign, const FieldOptions& options)
      : mesh_(mesh), tree_(tree), sign_(sign), tasks_(options.threads), most_(options.max_bytes) {
    check_input();
    for (const auto& face : mesh.faces)  // not the tree's: it may leave out what no ray hits
      if (const auto t =
              geometry::Triangle3f{mesh.vertices[face[0]], mesh.vertices[face[1]], mesh.vertices[face[2]]};
          is_finite(t))
        made_.bounds_.grow(geometry::Triangle3d(t).box());
    if (made_.bounds_.empty()) throw InvalidInput("the mesh has no triangles: no distance to it");
    std::tie(made_.lattice_, made_.widths_) = lattice_around(made_.bounds_, options);
    far_ = static_cast<float>(made_.widths_.far);
    link_ = made_.lattice_.spacing * (1 + 0x1p-20) + 2 * made_.widths_.rounding;
  }

  S operator()() && {
    if constexpr (requires { sign_.closed(); })
      made_.report_.closed = sign_.closed();
    else
      made_.report_.closed = is_closed_cycle(mesh_);
    made_.report_.inside_out = made_.report_.closed && is_inside_out(mesh_);
    if constexpr (requires { sign_.closed(); })
      if (sign_.closed())
        made_.report_.parts_inside_out =
            parts_inside_out(mesh_, [&](const Vec3f& p) { return sign_.inside(p); });
    made_.table_.resize(made_.lattice_.brick_count());
    refuse(S::bytes_for(made_.lattice_, 0));
    tasks_.run([&] {
      std::vector<Candidate> candidates;
      halve({0, 0, 0}, made_.lattice_.bricks, infinity, candidates);
      refuse(S::bytes_for(made_.lattice_, candidates.size()));
      made_.prepare(candidates.size());
      tasks_.pieces(
          candidates.size(), [&](std::size_t begin, std::size_t end) { sample(candidates, begin, end); },
          bricks_at_once);
      keep(candidates);
      find_conflicts();
      bound_errors(made_, kept_at_, tasks_, made_.table_, made_.steepest_);
    });
    made_.report_.distance_queries = distance_queries_, made_.report_.inside_queries = inside_queries_;
    made_.report_.known_samples = known_, made_.report_.undecided_signs = undecided_;
    return std::move(made_);
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  static constexpr std::size_t bricks_at_once = 4;
  using Triple = std::array<int, 3>;

  struct Candidate {
    Triple brick;
    double middle;  // distance at the middle of its cells
    bool known = false, inside = false;
  };

  void check_input() const {
    check_faces(mesh_);
    if constexpr (Inspectable<Tree>) {
      const TreeStats stats = tree_.stats();
      if (stats.primitives + stats.dropped != mesh_.size())
        throw InvalidInput("the tree is over " + std::to_string(stats.primitives + stats.dropped) +
                           " faces, the mesh has " + std::to_string(mesh_.size()));
    }
  }
  void refuse(double bytes) const {
    const double table = double(made_.table_.size()) * sizeof(BrickEntry);
    refuse_bytes(bytes + table, most_, std::to_string(made_.table_.size()) + " bricks");
  }

  // ---- which bricks -------------------------------------------------------------------------------------

  double distance_at(const Vec3d& p, double at_most, ClosestPoint<float>& closest) const {
    const auto limit = static_cast<float>(std::min(at_most * (1 + 0x1p-20) + 2 * made_.widths_.rounding,
                                                   double(std::numeric_limits<float>::max())));
    closest = tree_.closest_point(Vec3f(p), limit);
    if (!closest) return infinity;
    return std::sqrt(
        closest_point_on_triangle(p, geometry::Triangle3d(mesh_.triangle(closest.primitive))).distance2);
  }

  /// Sorts the bricks low, …, high - 1 into candidates, in the order of halving, and those done with.
  /// `at_most` bounds the distance at the middle.
  void halve(const Triple& low, const Triple& high, double at_most, std::vector<Candidate>& candidates) {
    const geometry::Box3d cells = made_.lattice_.cells_of(low, high);
    const Vec3d middle = cells.centre();
    const double radius = 0.5 * length(cells.extent());
    ClosestPoint<float> closest;
    const double d = distance_at(middle, at_most, closest);
    ++distance_queries_;
    Triple size;
    for (std::size_t k = 0; k < 3; ++k) size[k] = high[k] - low[k];
    const std::size_t count = std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]);
    const bool empty = d - radius - made_.widths_.rounding >= made_.widths_.far;
    if (empty && (count == 1 || d >= 2 * radius)) return mark(low, high, middle, d);
    if (count == 1) return candidates.push_back({low, d});
    const auto axis = static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
    Triple end = high, begin = low;
    end[axis] = begin[axis] = low[axis] + size[axis] / 2;
    // The middle moves by half of what the halves differ in length from the whole.
    const auto moved = [&](const Triple& a, const Triple& b) {
      return d + distance(middle, made_.lattice_.cells_of(a, b).centre());
    };
    std::vector<Candidate> more;
    tasks_.both(
        count * brick_size / 8, [&] { halve(low, end, moved(low, end), candidates); },
        [&] { halve(begin, high, moved(begin, high), more); });
    candidates.insert(candidates.end(), more.begin(), more.end());
  }

  void mark(const Triple& low, const Triple& high, const Vec3d& middle, double d) {
    const bool inside = ask_inside(middle);
    for (int z = low[2]; z < high[2]; ++z)
      for (int y = low[1]; y < high[1]; ++y)
        for (int x = low[0]; x < high[0]; ++x) {
          const Vec3d own = made_.lattice_.cells_of({x, y, z}, {x + 1, y + 1, z + 1}).centre();
          made_.table_[made_.lattice_.brick_index(x, y, z)] = empty_entry(inside, d - distance(own, middle));
        }
  }
  BrickEntry empty_entry(bool inside, double least) const {
    constexpr double most = std::numeric_limits<float>::max();
    return {inside ? BrickEntry::inside : BrickEntry::outside,
            static_cast<float>(std::min((least - made_.widths_.rounding) * (1 - 0x1p-23), most)), 0};
  }
  bool ask_inside(const Vec3d& p) {
    ++inside_queries_;
    if constexpr (DecidingPolicy<Sign>) {
      const std::optional<bool> inside = sign_.decided(Vec3f(p));
      undecided_ += !inside;
      return inside.value_or(false);
    } else {
      return sign_.inside(Vec3f(p));
    }
  }

  // ---- their samples ------------------------------------------------------------------------------------

  void sample(std::vector<Candidate>& candidates, std::size_t begin, std::size_t end) {
    std::array<float, brick_size> values;
    std::array<ClosestPoint<float>, brick_size> closest;
    std::size_t known = 0;
    for (std::size_t n = begin; n < end; ++n) {
      Candidate& c = candidates[n];
      const std::size_t here = measure(c, values.data(), closest.data());
      c.known = here > 0, known += here;
      c.inside = choose_sides(c.brick, values.data(), closest.data());
      made_.put(n, c.brick, values.data());
    }
    known_ += known;
  }

  /// Distances without sign; returns how many are known.
  std::size_t measure(const Candidate& c, float* values, ClosestPoint<float>* closest) {
    const Triple first{8 * c.brick[0], 8 * c.brick[1], 8 * c.brick[2]};
    const Triple next{c.brick[0] + 1, c.brick[1] + 1, c.brick[2] + 1};
    Walk walk{first, made_.lattice_.cells_of(c.brick, next).centre(), c.middle, values, closest};
    visit<8>(walk, {0, 0, 0}, true);
    distance_queries_ += walk.queries;
    return walk.known;
  }
  /// A brick's samples on their way: the last point whose distance is bounded bounds the next.
  struct Walk {
    Triple first;
    Vec3d at;
    double bound;
    float* values;
    ClosestPoint<float>* closest;
    std::size_t known = 0, queries = 0;
  };
  double step(Walk& walk, const Vec3d& p, double at_most, ClosestPoint<float>& closest) const {
    const double bound = walk.bound + distance(walk.at, p),
                 d = distance_at(p, std::min(bound, at_most), closest);
    walk.at = p, walk.bound = std::min(bound, d), ++walk.queries;
    return d;
  }
  /// The samples of a cube of a brick. Where it may be out of the band altogether, its middle is asked first.
  template <int side>
  void visit(Walk& walk, const Triple& low, bool may_be_far) const {
    if constexpr (side == 1) {
      const Vec3d p =
          made_.lattice_.position(walk.first[0] + low[0], walk.first[1] + low[1], walk.first[2] + low[2]);
      const int place = (low[2] * 8 + low[1]) * 8 + low[0];
      const double d = step(walk, p, made_.widths_.far, walk.closest[place]);
      const float value = std::min(static_cast<float>(std::min(d, made_.widths_.far)), far_);
      walk.values[place] = value, walk.known += value < far_;
    } else {
      if (may_be_far && side < 8) {
        constexpr double half = 0.5 * (side - 1);
        const double h = made_.lattice_.spacing, radius = half * h * 1.7321 + 2 * made_.widths_.rounding;
        Vec3d p =
            made_.lattice_.position(walk.first[0] + low[0], walk.first[1] + low[1], walk.first[2] + low[2]);
        p += Vec3d::filled(half * h);
        ClosestPoint<float> closest;
        const double d = step(walk, p, made_.widths_.far + radius, closest);
        if (d >= made_.widths_.far + radius) return fill(walk, low, side);
        may_be_far = d + radius >= made_.widths_.far;
      }
      // There and back again, so that each is next to the one before.
      constexpr int part = side / 2;
      for (const int n : {0, 1, 3, 2, 6, 7, 5, 4})
        visit<part>(walk, {low[0] + (n & 1) * part, low[1] + (n >> 1 & 1) * part, low[2] + (n >> 2) * part},
                    may_be_far);
    }
  }
  void fill(Walk& walk, const Triple& low, int side) const {
    for (int k = low[2]; k < low[2] + side; ++k)
      for (int j = low[1]; j < low[1] + side; ++j)
        for (int i = low[0]; i < low[0] + side; ++i)
          walk.values[(k * 8 + j) * 8 + i] = far_, walk.closest[(k * 8 + j) * 8 + i] = {};
  }

  /// Gives the samples of a brick their signs; whether the last patch was inside.
  bool choose_sides(const Triple& brick, float* values, const ClosestPoint<float>* closest) {
    std::array<std::int8_t, brick_size> seen{};
    std::array<std::int16_t, brick_size> patch;
    bool inside = false;
    for (int start = 0; start < brick_size; ++start) {
      if (seen[std::size_t(start)]) continue;
      int size = 0, best = start;
      const auto visit = [&](int n) {
        seen[std::size_t(n)] = 1, patch[std::size_t(size++)] = static_cast<std::int16_t>(n);
      };
      visit(start);
      for (int next = 0; next < size; ++next) {
        const int n = patch[std::size_t(next)];
        if (values[n] > values[best]) best = n;
        const int place[3] = {n % 8, n / 8 % 8, n / 64}, step[3] = {1, 8, 64};
        for (int k = 0; k < 3; ++k)
          for (const int way : {-1, 1}) {
            if (place[k] + way < 0 || place[k] + way > 7) continue;
            const int m = n + way * step[k];
            if (!seen[std::size_t(m)] && one_side(values[n], values[m])) visit(m);
          }
      }
      const Vec3d p = made_.lattice_.position(brick[0] * 8 + best % 8, brick[1] * 8 + best / 8 % 8,
                                              brick[2] * 8 + best / 64);
      std::optional<bool> side;
      if constexpr (SidePolicy<Sign>)
        if (closest[best]) side = sign_.side(p, closest[best]);
      inside = side ? *side : ask_inside(p);
      if (inside)
        for (int n = 0; n < size; ++n) values[patch[std::size_t(n)]] *= -1;
    }
    return inside;
  }
  /// Whether the surface cannot pass between two neighbouring samples: the two balls cover the way.
  bool one_side(float a, float b) const { return double(std::abs(a)) + double(std::abs(b)) > link_; }

  // ---- the table ----------------------------------------------------------------------------------------

  void keep(const std::vector<Candidate>& candidates) {
    std::vector<std::uint32_t> kept;
    for (std::size_t n = 0; n < candidates.size(); ++n) {
      const Candidate& c = candidates[n];
      BrickEntry& e = made_.table_[made_.lattice_.brick_index(c.brick[0], c.brick[1], c.brick[2])];
      if (!c.known) {
        e = empty_entry(c.inside, c.middle);
        continue;
      }
      e.samples = static_cast<std::int32_t>(kept.size());
      kept.push_back(static_cast<std::uint32_t>(n)), kept_at_.push_back(c.brick);
    }
    made_.report_.kept_bricks = kept.size();
    made_.settle(kept, kept_at_);
  }

  /// Patches were chosen brick by brick, and what is empty box by box: looks across the bricks' sides.
  void find_conflicts() {
    std::mutex mutex;
    const Triple& end = made_.lattice_.bricks;
    for (int z = 0; z < end[2]; ++z)
      for (int y = 0; y < end[1]; ++y)
        for (int x = 0; x < end[0]; ++x)
          for (std::size_t axis = 0; axis < 3; ++axis) {
            Triple next{x, y, z};
            if (++next[axis] == end[axis]) continue;
            const BrickEntry &a = made_.entry(x, y, z), &b = made_.entry(next[0], next[1], next[2]);
            if (!a.kept() && !b.kept() && a.samples != b.samples) look_across({x, y, z}, axis, 1, mutex);
          }
    tasks_.pieces(
        kept_at_.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t n = begin; n < end; ++n)
            for (std::size_t axis = 0; axis < 3; ++axis)
              for (const int way : {-1, 1}) {
                // Towards a kept brick from one side only.
                Triple next = kept_at_[n];
                next[axis] += way;
                if (next[axis] < 0 || next[axis] >= made_.lattice_.bricks[axis]) continue;
                if (way < 0 && made_.entry(next[0], next[1], next[2]).kept()) continue;
                look_across(kept_at_[n], axis, way, mutex);
              }
        },
        64);
  }
  void look_across(const Triple& brick, std::size_t axis, int way, std::mutex& mutex) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    Triple at;
    at[axis] = brick[axis] * 8 + (way > 0 ? 7 : 0);
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b) {
        at[u] = brick[u] * 8 + a, at[v] = brick[v] * 8 + b;
        Triple to = at;
        to[axis] += way;
        const float x = made_.value(at[0], at[1], at[2]), y = made_.value(to[0], to[1], to[2]);
        if (std::signbit(x) == std::signbit(y) || !one_side(x, y)) continue;
        const std::scoped_lock lock(mutex);
        FieldReport& r = made_.report_;
        const Triple lower = std::min(at, to);
        if (r.sign_conflicts++ == 0 || lower < r.first_conflict) r.first_conflict = lower;
      }
  }

  const geometry::Mesh3f& mesh_;
  const Tree& tree_;
  const Sign& sign_;
  BuildTasks tasks_;
  std::size_t most_;
  S made_;
  double link_ = 0;
  float far_ = 0;
  std::vector<Triple> kept_at_;
  std::atomic<std::size_t> distance_queries_ = 0, inside_queries_ = 0, known_ = 0, undecided_ = 0;
};

/// Samples of the signed distance to a mesh: BrickSamples or DenseSamples. The tree is over the mesh's faces
/// and answers closest_point(); the sign is an InsidePolicy. Throws InvalidInput for options out of range, a
/// mesh without triangles, and a field of more bytes than max_bytes, before it takes them.
template <class S, ClosestPointIndex Tree, InsidePolicy Sign>
S sample_mesh(const geometry::Mesh3f& mesh, const Tree& tree, const Sign& sign,
              const FieldOptions& options = {}) {
  return FieldBuilder<S, Tree, Sign>(mesh, tree, sign, options)();
}
/// By MeshSign: counted crossings where the mesh is closed, else the facing of the nearest faces.
template <class S, ClosestPointIndex Tree>
S sample_mesh(const geometry::Mesh3f& mesh, const Tree& tree, const FieldOptions& options = {}) {
  check(options);
  return sample_mesh<S>(mesh, tree, MeshSign<Tree>(mesh, tree, options.threads), options);
}

}  // namespace treeline::accel::field
