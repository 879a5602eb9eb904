// The directional albedo of facets that reflect all, E(wo), tabulated for one roughness by quadrature.
//
// Columns are even in t = sqrt(μ (1 + a) / (μ + a)), a the roughness along the viewer's azimuth, so that most
// are at the cosines below a, where E has its dip, for any roughness; the root is for correlated masking,
// whose E starts as 1 + μ ln μ. Of an anisotropic surface, rows are even in log a. A part of the values is
// computed, those between by cubic interpolation; the look-up is linear. The average is that of the looked-up
// function, so that what kulla_conty.hpp adds up to is exact. Cost: one look-up of 2 (4) values, a root (and
// a logarithm); to build, 0.1 to 1 ms a computed value. Accuracy: 1e-4 (isotropic), 5e-4 (anisotropic, by up
// to 10 : 1). Known weakness: one table per roughness.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "shading/brdf/albedo_quadrature.hpp"
#include "shading/brdf/check_material.hpp"
#include "shading/brdf/microfacet.hpp"

namespace treeline::shading::brdf {

class AlbedoTable {
 public:
  /// Of the material's distribution, masking and roughness alone. columns, rows: computed; between each two,
  /// refinement - 1 more by interpolation. Isotropic surfaces have one row. Throws InvalidMaterial, and
  /// std::invalid_argument for fewer than four columns or rows, or a refinement below 1.
  explicit AlbedoTable(const Material& m, int columns = 49, int rows = 9, int refinement = 8)
      : ax_(m.alpha_x), ay_(m.alpha_y), columns_(columns), rows_(m.alpha_x == m.alpha_y ? 1 : rows) {
    check_material(m);
    if (columns < 4 || rows < 4 || refinement < 1)
      throw std::invalid_argument("AlbedoTable: fewer than four columns or rows, or a refinement below 1");
    if (m.distribution == Distribution::ggx)
      fill(Microfacets<Ggx<double>>{{ax_, ay_}, m.masking});
    else
      fill(Microfacets<Beckmann<double>>{{ax_, ay_}, m.masking});
    values_ = refined(values_, columns_, refinement);
    if (rows_ > 1) values_ = transposed(refined(transposed(values_, rows_), rows_, refinement), columns_);
    average_ = interpolated_average();
  }

  /// wo above the surface; in [0, 1].
  template <std::floating_point T>
  T operator()(const Direction<T>& wo) const {
    const T a = rows_ == 1 ? T(ax_) : roughness_along(wo);
    const T x = std::sqrt(wo[2] * (T(1) + a) / (wo[2] + a)) * T(columns_ - 1);
    const int column = std::clamp(int(x), 0, columns_ - 2);
    if (rows_ == 1) return between(0, column, x - T(column));
    const T y = std::log(a / T(lower())) * T(rows_ - 1) / T(std::log(upper() / lower()));
    const int row = std::clamp(int(y), 0, rows_ - 2);
    const T f = std::clamp(y - T(row), T(0), T(1));
    return between(row, column, x - T(column)) * (T(1) - f) + between(row + 1, column, x - T(column)) * f;
  }

  /// Ē = (1/π) ∫ E cosθ dω.
  double average() const { return average_; }

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// Row by row; rows from the smaller roughness to the larger, columns from grazing to head-on.
  const std::vector<double>& values() const { return values_; }

 private:
  double lower() const { return std::min(ax_, ay_); }
  double upper() const { return std::max(ax_, ay_); }

  template <class T>
  T roughness_along(const Direction<T>& wo) const {
    const T x2 = wo[0] * wo[0], y2 = wo[1] * wo[1];
    if (!(x2 + y2 > T(0))) return T(lower());
    return std::sqrt((T(ax_ * ax_) * x2 + T(ay_ * ay_) * y2) / (x2 + y2));
  }
  template <class T>
  T between(int row, int column, T f) const {
    const auto i = std::size_t(row) * std::size_t(columns_) + std::size_t(column);
    return T(values_[i]) * (T(1) - f) + T(values_[i + 1]) * f;
  }
  double roughness(double row) const {
    return rows_ == 1
               ? ax_
               : std::clamp(lower() * std::pow(upper() / lower(), row / (rows_ - 1)), lower(), upper());
  }
  double cosine(double a, double column) const {
    const double t = column / (columns_ - 1), t2 = t * t;
    return t2 * a / (1 + a - t2);
  }
  /// A direction of this cosine, the roughness along whose azimuth is a.
  Direction<double> viewer(double a, double mu) const {
    const double share = rows_ == 1 ? 0 : std::clamp((a * a - ax_ * ax_) / (ay_ * ay_ - ax_ * ax_), 0.0, 1.0);
    const double sine = std::sqrt(std::max(0.0, (1 - mu) * (1 + mu)));
    return {sine * std::sqrt(1 - share), sine * std::sqrt(share), mu};
  }

  template <class Facets>
  void fill(const Facets& facets) {
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) {
        const double a = roughness(row), mu = std::max(cosine(a, column), 1e-6 * std::min(a, 1.0));
        const Direction<double> wo = viewer(a, mu);
        const auto f = [&](const Direction<double>& wi) { return facets.eval(wi, wo) * wi[2]; };
        values_.push_back(std::clamp(integrate_by_normals<6>(ax_, ay_, wo, f), 0.0, 1.0));
      }
  }

  /// Each run of `length` values with factor - 1 more between each two, from the cubic through the four
  /// around; sets length to the new one.
  static std::vector<double> refined(const std::vector<double>& v, int& length, int factor) {
    const int finer = (length - 1) * factor + 1;
    std::vector<double> r;
    for (auto run = v.begin(); run != v.end(); run += length)
      for (int i = 0; i < finer; ++i) {
        const int first = std::clamp(i / factor - 1, 0, length - 4);
        const double x = double(i) / factor - first;
        const auto p = run + first;
        r.push_back(std::clamp(-p[0] * (x - 1) * (x - 2) * (x - 3) / 6 + p[1] * x * (x - 2) * (x - 3) / 2 -
                                   p[2] * x * (x - 1) * (x - 3) / 2 + p[3] * x * (x - 1) * (x - 2) / 6,
                               0.0, 1.0));
      }
    length = finer;
    return r;
  }
  static std::vector<double> transposed(const std::vector<double>& v, int rows) {
    const auto height = std::size_t(rows), width = v.size() / height;
    std::vector<double> r(v.size());
    for (std::size_t i = 0; i < v.size(); ++i) r[i % width * height + i / width] = v[i];
    return r;
  }

  /// Cell by cell, where the interpolated function is smooth.
  double interpolated_average() const {
    const auto over_cosines = [&](double a) {
      double sum = 0;
      for (int column = 0; column + 1 < columns_; ++column)
        sum += geometry::integrate<4>([&](double mu) { return 2 * mu * (*this)(viewer(a, mu)); },
                                      cosine(a, column), cosine(a, column + 1));
      return sum;
    };
    if (rows_ == 1) return over_cosines(ax_);
    const auto azimuth = [&](double a) {  // from the smoother tangent
      return std::acos(std::sqrt(
          std::clamp((upper() - a) * (upper() + a) / (upper() * upper() - lower() * lower()), 0.0, 1.0)));
    };
    double sum = 0;
    for (int row = 0; row + 1 < rows_; ++row)
      sum += geometry::integrate<4>(
          [&](double phi) {
            return over_cosines(std::hypot(lower() * std::cos(phi), upper() * std::sin(phi)));
          },
          azimuth(roughness(row)), azimuth(roughness(row + 1)));
    return sum * 2 / std::numbers::pi;
  }

  double ax_, ay_;
  int columns_, rows_;
  std::vector<double> values_;
  double average_ = 0;
};

}  // namespace treeline::shading::brdf
