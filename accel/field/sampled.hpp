// Look-ups in samples of a distance field: trilinear, and tricubic with a continuous gradient.
//
// Tricubic: Catmull and Rom's spline along each axis, through the samples; its error falls with the third
// power of the spacing where the distance is smooth, the trilinear one's with the second. At the edges and
// the medial axis of a shape, where distances have a kink, both are off by up to some two fifths of a cell.
// Between known samples an error has a bound (bound.hpp); elsewhere the answer is a lower bound on the
// distance, which jumps from brick to brick. Cost: 8 or 64 samples, of up to 8 bricks. Memory: a reference.
// For rays take the trilinear one: by the tricubic, whose bounds are wider and whose slope may be steeper,
// they take twice the steps, each three times as dear, and at 128 cells a few that graze the surface run out
// of the default's 512, which spoils the mean error (bench/distance_field, set `trace`).
#pragma once

#include "accel/field/bricks.hpp"
#include "geometry/distance.hpp"

namespace treeline::accel::field {

namespace detail {

/// The value at t in the unit cell, and its gradient in cells, from 2³ samples.
struct TrilinearKernel {
  static constexpr int before = 0, width = 2;

  static double value(const float* v, const Vec3d& t, Vec3d* gradient = nullptr) {
    const auto lerp = [](double a, double b, double s) { return a + (b - a) * s; };
    double line[4];
    for (int n = 0; n < 4; ++n) line[n] = lerp(double(v[2 * n]), double(v[2 * n + 1]), t[0]);
    const double near = lerp(line[0], line[1], t[1]), far = lerp(line[2], line[3], t[1]);
    if (gradient != nullptr) {
      double slope[4];
      for (int n = 0; n < 4; ++n) slope[n] = double(v[2 * n + 1]) - double(v[2 * n]);
      (*gradient)[0] = lerp(lerp(slope[0], slope[1], t[1]), lerp(slope[2], slope[3], t[1]), t[2]);
      (*gradient)[1] = lerp(line[1] - line[0], line[3] - line[2], t[2]);
      (*gradient)[2] = far - near;
    }
    return lerp(near, far, t[2]);
  }
};

/// From 4³ samples, of which the first is one cell before the cell.
struct TricubicKernel {
  static constexpr int before = 1, width = 4;

  static double value(const float* v, const Vec3d& t, Vec3d* gradient = nullptr) {
    double w[3][4];
    for (int a = 0; a < 3; ++a) {
      const double s = t[a], r = 1 - s;
      w[a][0] = -0.5 * s * r * r, w[a][3] = -0.5 * r * s * s;
      w[a][1] = 1 + s * s * (1.5 * s - 2.5), w[a][2] = 1 + r * r * (1.5 * r - 2.5);
    }
    double lines[4][4];
    for (int c = 0; c < 4; ++c)
      for (int b = 0; b < 4; ++b) lines[c][b] = across(v + 16 * c + 4 * b, w[0]);
    double layers[4];
    for (int c = 0; c < 4; ++c) layers[c] = across(lines[c], w[1]);
    if (gradient != nullptr) {
      double d[3][4];
      for (int a = 0; a < 3; ++a) {
        const double s = t[a];
        d[a][0] = -0.5 + s * (2 - 1.5 * s), d[a][1] = s * (4.5 * s - 5);
        d[a][2] = 0.5 + s * (4 - 4.5 * s), d[a][3] = s * (1.5 * s - 1);
      }
      double by_x[4], by_y[4];
      for (int c = 0; c < 4; ++c) {
        double slopes[4];
        for (int b = 0; b < 4; ++b) slopes[b] = across(v + 16 * c + 4 * b, d[0]);
        by_x[c] = across(slopes, w[1]), by_y[c] = across(lines[c], d[1]);
      }
      *gradient = {across(by_x, w[2]), across(by_y, w[2]), across(layers, d[2])};
    }
    return across(layers, w[2]);
  }

 private:
  template <class T>
  static double across(const T* v, const double* w) {
    return double(v[0]) * w[0] + double(v[1]) * w[1] + double(v[2]) * w[2] + double(v[3]) * w[3];
  }
};

}  // namespace detail

/// A distance field over samples, which must outlive it. Points are in units of the mesh; look-ups throw
/// nothing, and answer NaN for NaN.
template <class S, class Kernel>
class SampledField {
 public:
  /// Throws InvalidInput where the samples were built for a narrower look-up than this one.
  explicit SampledField(const S& samples)
      : samples_(&samples),
        origin_(samples.lattice().origin),
        per_cell_(1 / samples.lattice().spacing),
        far_(static_cast<float>(samples.widths().far)),
        // A look-up's samples are no farther than that from its point.
        least_far_(samples.widths().far - width / 2 * 1.7321 * samples.lattice().spacing -
                   samples.widths().rounding) {
    if (least_far_ < samples.widths().band)
      throw InvalidInput("a tricubic look-up in samples that were built for trilinear ones");
  }

  double distance(const Vec3d& p) const { return sample(p).distance; }
  /// Of distance(), by its formula; zero where the distance is not known.
  Vec3d gradient(const Vec3d& p) const {
    Cell cell;
    Vec3d slope{};
    float v[size];
    if (!find(p, cell)) return slope;
    samples_->template gather<width>(cell.i, cell.j, cell.k, v);
    if (!known(v)) return slope;
    Kernel::value(v, cell.t, &slope);
    return slope * per_cell_;
  }
  FieldSample sample(const Vec3d& p) const {
    Cell cell;
    if (!find(p, cell)) return outside(p);
    const int x = (cell.i + Kernel::before) / brick_side, y = (cell.j + Kernel::before) / brick_side,
              z = (cell.k + Kernel::before) / brick_side;
    const BrickEntry& e = samples_->entry(x, y, z);
    if (!e.kept()) return in_empty(p, e, x, y, z);
    float v[size];
    samples_->template gather<width>(cell.i, cell.j, cell.k, v);
    if (!known(v)) return {farthest(v) < 0 ? -least_far_ : least_far_, 0, false};
    return {Kernel::value(v, cell.t), double(width == 2 ? e.bound : e.cubic_bound), true};
  }
  double lipschitz() const { return samples_->steepest(width == 2 ? Support::trilinear : Support::tricubic); }
  /// Of the mesh: the surface is nowhere else.
  const geometry::Box3d& bounds() const { return samples_->bounds(); }
  const S& samples() const { return *samples_; }

 private:
  static constexpr int width = Kernel::width, size = width * width * width;

  struct Cell {
    int i, j, k;  // the first sample
    Vec3d t;
  };

  /// False outside of what has all of its samples.
  bool find(const Vec3d& p, Cell& cell) const {
    int* const first[3] = {&cell.i, &cell.j, &cell.k};
    for (int a = 0; a < 3; ++a) {
      const double u = (p[a] - origin_[a]) * per_cell_;
      if (!(u >= Kernel::before && u < samples_->lattice().samples(a) - width / 2)) return false;
      const int whole = static_cast<int>(u);
      *first[a] = whole - Kernel::before, cell.t[a] = u - whole;
    }
    return true;
  }
  bool known(const float* v) const {
    bool all = true;
    for (int n = 0; n < size; ++n) all &= std::abs(v[n]) < far_;
    return all;
  }
  static float farthest(const float* v) {
    float r = v[0];
    for (int n = 1; n < size; ++n)
      if (std::abs(v[n]) > std::abs(r)) r = v[n];
    return r;
  }
  FieldSample outside(const Vec3d& p) const {
    const double d = std::sqrt(distance2(p, samples_->bounds()));
    return {d <= std::numeric_limits<double>::max() ? d : far_outside(p), 0, false};
  }
  /// Where the square overflows, or p is not finite.
  [[gnu::noinline, gnu::cold]] double far_outside(const Vec3d& p) const {
    for (int k = 0; k < 3; ++k)
      if (std::isnan(p[k])) return p[k];
    const Vec3d gap = max(max(samples_->bounds().low - p, p - samples_->bounds().high), Vec3d{});
    if (!is_finite(p)) return std::numeric_limits<double>::infinity();
    return std::min(std::hypot(gap[0], gap[1], gap[2]) * (1 - 0x1p-50), std::numeric_limits<double>::max());
  }
  FieldSample in_empty(const Vec3d& p, const BrickEntry& e, int x, int y, int z) const {
    const Vec3d middle = samples_->lattice().cells_of({x, y, z}, {x + 1, y + 1, z + 1}).centre();
    const double least = std::max(double(e.bound) - geometry::distance(p, middle), least_far_);
    return {least * double(e.side()), 0, false};
  }

  const S* samples_;
  Vec3d origin_;
  double per_cell_;
  float far_;
  double least_far_;
};

/// See SampledField.
template <class S>
struct Trilinear : SampledField<S, detail::TrilinearKernel> {
  using SampledField<S, detail::TrilinearKernel>::SampledField;
};
template <class S>
Trilinear(const S&) -> Trilinear<S>;
template <class S>
struct Tricubic : SampledField<S, detail::TricubicKernel> {
  using SampledField<S, detail::TricubicKernel>::SampledField;
};
template <class S>
Tricubic(const S&) -> Tricubic<S>;

static_assert(DistanceField<Trilinear<BrickSamples>> && DistanceField<Tricubic<DenseSamples>>);

}  // namespace treeline::accel::field
