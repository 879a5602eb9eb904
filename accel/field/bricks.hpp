// The samples of a field, kept as bricks of 8³ near the surface (BrickSamples) or all of them in rows
// (DenseSamples); for both a table that says of each brick what is certain of it.
//
// A sample that is farther than widths().far holds just that, with its sign; so does one whose brick is not
// kept. What is not certain is therefore never mistaken for a distance, and both kinds answer alike, bit for
// bit. Memory: dense 4 bytes a sample; bricks 2 KiB each, some 16 samples deep for a band of 3 cells on
// either side; both 12 bytes a brick of the lattice. Source: Museth 2013 for sparse bricks (two levels here,
// not four).
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "accel/field/grid.hpp"

namespace treeline::accel::field {

/// What is known of one brick and its cells, those between its samples and on to the next brick.
struct BrickEntry {
  static constexpr std::int32_t outside = -1, inside = -2;

  std::int32_t samples = outside;  ///< its number among the kept bricks; else on which side it lies
  /// Kept: a trilinear look-up in its cells is off by no more. Else: the distance at the middle of its cells
  /// is at least this, in magnitude.
  float bound = 0;
  float cubic_bound = 0;  ///< kept: the same of a tricubic look-up

  bool kept() const { return samples >= 0; }
  float side() const { return samples == inside ? -1.0f : 1.0f; }
  bool operator==(const BrickEntry&) const = default;
};

/// What the build found out about the mesh, and what became of it.
struct FieldReport {
  /// Every edge has as many faces that run one way as the other, by the positions of its ends, and every face
  /// is finite: without that, there is no inside, and neither signs nor bounds are certain.
  bool closed = true;
  /// Closed, but of negative volume: its faces look inward, as a whole. What such a mesh goes around -1 times
  /// is not inside, so that by the default policy all distances are positive: turn the faces, or give a
  /// policy of your own. Of several parts, those that look outward have an inside all the same.
  bool inside_out = false;
  /// By the default policy, of a closed mesh: so many of its parts look inward and lie in no other one. They
  /// have no inside. geometry::check_mesh() names them.
  std::size_t parts_inside_out = 0;
  /// Pairs of neighbouring samples of two bricks between which there is no surface, but which were put on
  /// different sides; within a brick what hangs together is given one side, so that there are none. By the
  /// default policy 0 for every closed mesh, whatever touches or crosses. 0 alone is no proof: a policy may
  /// be wrong about all of a region.
  std::size_t sign_conflicts = 0;
  std::array<int, 3> first_conflict{};  ///< the lower sample of the first such pair
  /// Pieces of bricks and empty boxes whose side the policy could not tell; they were called outside.
  std::size_t undecided_signs = 0;
  std::size_t kept_bricks = 0;
  std::size_t known_samples = 0;                         ///< distances, not bounds
  std::size_t distance_queries = 0, inside_queries = 0;  ///< asked while building

  /// Whether the bounds on errors hold: they follow from distances being 1-Lipschitz with their sign. With a
  /// policy of one's own, as far as that can be relied on.
  bool certain() const { return closed && sign_conflicts == 0 && undecided_signs == 0; }
};

/// What both kinds have in common.
class Samples {
 public:
  const Lattice& lattice() const { return lattice_; }
  const Widths& widths() const { return widths_; }
  const FieldReport& report() const { return report_; }
  /// Of the mesh.
  const geometry::Box3d& bounds() const { return bounds_; }
  const BrickEntry& entry(int brick_x, int brick_y, int brick_z) const {
    return table_[lattice_.brick_index(brick_x, brick_y, brick_z)];
  }
  const std::vector<BrickEntry>& table() const { return table_; }
  /// How steep a trilinear or tricubic look-up gets anywhere.
  double steepest(Support support) const { return steepest_[support == Support::tricubic]; }

 protected:
  template <class S, class Tree, class Sign>
  friend class FieldBuilder;

  bool in_lattice(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < lattice_.samples(0) && j < lattice_.samples(1) &&
           k < lattice_.samples(2);
  }
  float far() const { return static_cast<float>(widths_.far); }

  Lattice lattice_;
  Widths widths_;
  geometry::Box3d bounds_;
  FieldReport report_;
  std::vector<BrickEntry> table_;
  std::array<double, 2> steepest_{1, 1};
};

class BrickSamples : public Samples {
 public:
  using Brick = std::array<float, brick_size>;

  /// Sample (i, j, k); outside of the lattice, far.
  float value(int i, int j, int k) const {
    if (!in_lattice(i, j, k)) return far();
    const BrickEntry& e = entry(i / brick_side, j / brick_side, k / brick_side);
    return e.kept() ? bricks_[std::size_t(e.samples)][place(i, j, k)] : e.side() * far();
  }
  /// The N³ samples from (i, j, k) on, x fastest; all in the lattice.
  template <int N>
  void gather(int i, int j, int k, float* out) const {
    const int x = i % brick_side, y = j % brick_side, z = k % brick_side;
    constexpr int last = brick_side - N;
    if (x <= last && y <= last && z <= last) {
      const BrickEntry& e = entry(i / brick_side, j / brick_side, k / brick_side);
      if (!e.kept()) return static_cast<void>(std::fill_n(out, N * N * N, e.side() * far()));
      const float* from = bricks_[std::size_t(e.samples)].data() + place(i, j, k);
      for (int c = 0; c < N; ++c)
        for (int b = 0; b < N; ++b)
          for (int a = 0; a < N; ++a) *out++ = from[(c * brick_side + b) * brick_side + a];
      return;
    }
    for (int c = k; c < k + N; ++c)
      for (int b = j; b < j + N; ++b)
        for (int a = i; a < i + N; ++a) *out++ = value(a, b, c);
  }
  std::size_t bytes() const {
    return sizeof(*this) + table_.capacity() * sizeof(BrickEntry) + bricks_.capacity() * sizeof(Brick);
  }

 private:
  template <class S, class Tree, class Sign>
  friend class FieldBuilder;

  static std::size_t place(int i, int j, int k) {
    return std::size_t((k % brick_side * brick_side + j % brick_side) * brick_side + i % brick_side);
  }
  // For the builder: room for so many bricks that may be kept; the n-th of them; and only the kept ones stay.
  static double bytes_for(const Lattice&, std::size_t bricks) { return double(bricks) * sizeof(Brick); }
  void prepare(std::size_t candidates) { bricks_.resize(candidates); }
  void put(std::size_t n, const std::array<int, 3>&, const float* values) {
    std::copy_n(values, brick_size, bricks_[n].data());
  }
  void settle(const std::vector<std::uint32_t>& kept, const std::vector<std::array<int, 3>>&) {
    for (std::size_t n = 0; n < kept.size(); ++n)
      if (kept[n] != n) bricks_[n] = bricks_[kept[n]];
    bricks_.resize(kept.size());
    bricks_.shrink_to_fit();
  }

  std::vector<Brick> bricks_;
};

class DenseSamples : public Samples {
 public:
  float value(int i, int j, int k) const { return in_lattice(i, j, k) ? values_[place(i, j, k)] : far(); }
  template <int N>
  void gather(int i, int j, int k, float* out) const {
    for (int c = 0; c < N; ++c)
      for (int b = 0; b < N; ++b) {
        const float* from = values_.data() + place(i, j + b, k + c);
        for (int a = 0; a < N; ++a) *out++ = from[a];
      }
  }
  std::size_t bytes() const {
    return sizeof(*this) + table_.capacity() * sizeof(BrickEntry) + values_.capacity() * sizeof(float);
  }

 private:
  template <class S, class Tree, class Sign>
  friend class FieldBuilder;

  std::size_t place(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(lattice_.samples(1)) + std::size_t(j)) *
               std::size_t(lattice_.samples(0)) +
           std::size_t(i);
  }
  static double bytes_for(const Lattice& lattice, std::size_t) {
    return double(lattice.sample_count()) * sizeof(float);
  }
  void prepare(std::size_t) { values_.resize(lattice_.sample_count()); }
  void put(std::size_t, const std::array<int, 3>& brick, const float* values) {
    for (int c = 0; c < brick_side; ++c)
      for (int b = 0; b < brick_side; ++b)
        std::copy_n(values + (c * brick_side + b) * brick_side, brick_side,
                    values_.data() +
                        place(brick[0] * brick_side, brick[1] * brick_side + b, brick[2] * brick_side + c));
  }
  /// The bricks that are not kept, from the table.
  void settle(const std::vector<std::uint32_t>&, const std::vector<std::array<int, 3>>&) {
    std::array<float, brick_size> all;
    for (int z = 0; z < lattice_.bricks[2]; ++z)
      for (int y = 0; y < lattice_.bricks[1]; ++y)
        for (int x = 0; x < lattice_.bricks[0]; ++x)
          if (const BrickEntry& e = entry(x, y, z); !e.kept())
            all.fill(e.side() * far()), put(0, {x, y, z}, all.data());
  }

  std::vector<float> values_;
};

}  // namespace treeline::accel::field
