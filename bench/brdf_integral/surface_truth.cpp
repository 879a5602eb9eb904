#include "bench/brdf_integral/surface_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "bench/brdf_integral/adaptive.hpp"
#include "bench/brdf_integral/reference.hpp"
#include "bench/brdf_integral/share.hpp"
#include "geometry/gauss_legendre.hpp"
#include "geometry/sampling.hpp"
#include "shading/brdf/bsdf.hpp"

namespace treeline::bench::brdf_integral {
namespace {

using std::numbers::pi;
constexpr double tolerance_of_viewers = 1e-8;  // of a viewer's integrals; inner ones are ten times finer
constexpr double average_tolerance = 1e-7;

using Rgb = std::array<double, 3>;
/// Under a sky of 1, by channel, and under a cosine.
using Reflected = Values<6>;

/// What shading/brdf says.
class Ours {
 public:
  explicit Ours(const Material& m) : bsdf_(m) {}
  Rgb operator()(const Vec3d& wi, const Vec3d& wo) const {
    const auto f = bsdf_.eval(wi, wo);
    return {f[0], f[1], f[2]};
  }

 private:
  shading::brdf::Bsdf<double> bsdf_;
};

/// What textbooks say, where they have a formula.
class Textbooks {
 public:
  explicit Textbooks(const Material& m) : material_(m), ours_(m) {}
  Rgb operator()(const Vec3d& wi, const Vec3d& wo) const {
    if (material_.kind == shading::SurfaceKind::microfacet &&
        material_.compensation != shading::Compensation::none)
      return ours_(wi, wo);
    return reference::brdf(material_, wi, wo);
  }

 private:
  const Material& material_;
  Ours ours_;
};

/// The roughness that the coordinates are laid out for.
Vec3d scale_of(const Material& m) {
  const bool rough = m.kind == shading::SurfaceKind::microfacet;
  return rough ? Vec3d{m.alpha_x, m.alpha_y, 0} : Vec3d{1, 1, 0};
}

Reflected weighed(const Rgb& f, const Vec3d& wi, double measure) {
  Reflected r;
  for (std::size_t c = 0; c < 3; ++c) r[c] = f[c] * wi[2] * measure, r[c + 3] = r[c] * wi[2];
  return r;
}

/// The integrals of f cosθ over facets' normals.
template <class F>
Reflected by_normals(const F& f, const Vec3d& scale, const Vec3d& wo, double tolerance) {
  const double sine = std::hypot(wo[0], wo[1]), azimuth = std::atan2(wo[1], wo[0]);
  const bool even = scale[0] == scale[1];  // both sides of the plane of the viewer alike
  // The angle in stretched slopes, for one on the surface.
  const auto stretched = [&](double phi) {
    return phi + std::remainder(std::atan2(std::sin(phi) * scale[0], std::cos(phi) * scale[1]) - phi, 2 * pi);
  };
  const auto slice = [&](double psi) {
    const double x = scale[0] * std::cos(psi), y = scale[1] * std::sin(psi), slope = std::hypot(x, y);
    // Normals up to this angle reflect to above the surface.
    const double across = sine * (x * std::cos(azimuth) + y * std::sin(azimuth)) / slope;
    const double steepest = std::tan(std::min(0.5 * std::atan2(across, wo[2]) + 0.25 * pi, 0.5 * pi));
    const double r_end = steepest / slope;
    const auto at = [&](double t) {  // r = t / (1 - t)
      const double r = t / (1 - t), p = r * x, q = r * y, cosine = 1 / std::sqrt(1 + p * p + q * q);
      const Vec3d h{p * cosine, q * cosine, cosine};
      const double oh = dot(wo, h);
      const Vec3d wi = h * (2 * oh) - wo;
      if (!(wi[2] > 0 && oh > 0)) return Reflected{};
      const double measure =
          4 * oh * cosine * cosine * cosine * scale[0] * scale[1] * r / ((1 - t) * (1 - t));
      return weighed(f(wi, wo), wi, measure);
    };
    const double end = r_end / (1 + r_end);
    const double breaks[] = {0, std::min(0.5, end), std::min(0.9, end), std::min(0.99, end), end};
    return integrate<6>(at, breaks, 0.1 * tolerance);
  };
  const double breaks[] = {stretched(azimuth - pi), stretched(azimuth - 0.5 * pi), stretched(azimuth),
                           stretched(azimuth + 0.5 * pi), stretched(azimuth + pi)};
  if (!even) return integrate<6>(slice, breaks, tolerance);
  Reflected half = integrate<6>(slice, std::span(breaks).subspan(2), 0.5 * tolerance);
  for (double& x : half) x *= 2;
  return half;
}

/// Coordinates around the mirror's direction.
struct Polar {
  Vec3d middle, up, side;  // up: the way in which z grows
  double height, slope;

  explicit Polar(const Vec3d& wo)
      : middle{-wo[0], -wo[1], wo[2]}, up{1, 0, 0}, side{}, height(wo[2]), slope(std::hypot(wo[0], wo[1])) {
    if (slope > 0) up = {wo[0] * height / slope, wo[1] * height / slope, slope};
    side = cross(middle, up);
  }
  Vec3d operator()(double polar, double turn) const {
    return middle * std::cos(polar) + (up * std::cos(turn) + side * std::sin(turn)) * std::sin(polar);
  }
  /// Up to this angle directions are above the surface.
  double horizon(double turn) const { return std::atan2(slope * std::cos(turn), height) + 0.5 * pi; }
};

/// The integrals of f cosθ over directions, from `first` radians off the mirror's on, up to `last`.
template <class F>
Reflected by_directions(const F& f, const Vec3d& scale, const Vec3d& wo, double tolerance, double first = 0,
                        double last = pi) {
  const Polar polar(wo);
  const bool even = scale[0] == scale[1];
  const auto slice = [&](double turn) {
    const double end = std::min(polar.horizon(turn), last);
    std::array<double, 24> breaks{};
    std::size_t n = 0;
    breaks[n++] = std::min(first, end);
    for (double b = 0.5 * std::min(scale[0], scale[1]); b < end && n + 1 < breaks.size(); b *= 3)
      if (b > first) breaks[n++] = b;
    breaks[n++] = end;
    const auto at = [&](double b) {
      const Vec3d wi = polar(b, turn);
      return wi[2] > 0 ? weighed(f(wi, wo), wi, std::sin(b)) : Reflected{};
    };
    return integrate<6>(at, std::span(breaks).first(n), 0.1 * tolerance);
  };
  const double breaks[] = {0, 0.5 * pi, pi, 1.5 * pi, 2 * pi};
  if (!even) return integrate<6>(slice, breaks, tolerance);
  Reflected half = integrate<6>(slice, std::span(breaks).first(3), 0.5 * tolerance);
  for (double& x : half) x *= 2;
  return half;
}

/// Breaks at the ends and where the mirror's direction lies, if it lies between.
std::array<double, 3> broken(double low, double high, double at) {
  return {low, std::clamp(at, low, high), high};
}

template <class F>
Reflected light_by_angles(const F& f, const Sky& sky, const Vec3d& wo) {
  const geometry::Frame<double> frame(sky.axis);
  const Vec3d mirror{-wo[0], -wo[1], wo[2]};
  const double wide = std::acos(sky.cosine), off = std::acos(std::clamp(dot(mirror, sky.axis), -1.0, 1.0));
  const double turned = std::atan2(dot(mirror, frame.y), dot(mirror, frame.x));
  const auto slice = [&](double turn) {
    const Vec3d side = frame.x * std::cos(turn) + frame.y * std::sin(turn);
    const auto at = [&](double b) {
      const Vec3d wi = sky.axis * std::cos(b) + side * std::sin(b);
      return wi[2] > 0 ? weighed(f(wi, wo), wi, sky.radiance * std::sin(b)) : Reflected{};
    };
    return integrate<6>(at, broken(0, wide, off), 0.1 * tolerance_of_viewers);
  };
  const double breaks[] = {turned - pi, turned, turned + pi};
  return integrate<6>(slice, breaks, tolerance_of_viewers);
}

template <class F>
Reflected light_by_plane(const F& f, const Sky& sky, const Vec3d& wo) {
  const geometry::Frame<double> frame(sky.axis);
  const Vec3d mirror{-wo[0], -wo[1], wo[2]};
  const double radius = std::sqrt(1 - sky.cosine * sky.cosine) / sky.cosine, ahead = dot(mirror, sky.axis);
  const double x_mirror = ahead > 0 ? dot(mirror, frame.x) / ahead : 0,
               y_mirror = ahead > 0 ? dot(mirror, frame.y) / ahead : 0;
  const auto slice = [&](double a) {  // x = radius sin a
    const double x = radius * std::sin(a), half = radius * std::cos(a);
    const auto at = [&](double y) {
      const double l2 = 1 + x * x + y * y;
      const Vec3d wi = (sky.axis + frame.x * x + frame.y * y) * (1 / std::sqrt(l2));
      return wi[2] > 0 ? weighed(f(wi, wo), wi, sky.radiance * half / (l2 * std::sqrt(l2))) : Reflected{};
    };
    return integrate<6>(at, broken(-half, half, y_mirror), 0.1 * tolerance_of_viewers);
  };
  return integrate<6>(slice, broken(-0.5 * pi, 0.5 * pi, std::asin(std::clamp(x_mirror / radius, -1.0, 1.0))),
                      tolerance_of_viewers);
}

/// 2 ∫ E(μ) μ dμ, over azimuths too where these matter. reflect(wo) gives E; nodes of the cosine lie as in
/// cosine(t), whose derivative is slope(t).
template <int n, class Reflect, class Cosine, class Slope>
Rgb average(const Material& m, const Reflect& reflect, const Cosine& cosine, const Slope& slope,
            int threads) {
  const auto& rule = geometry::GaussLegendre<n>::rule();
  const bool even = scale_of(m)[0] == scale_of(m)[1];
  const int turns = even ? 1 : n / 2;  // of a quarter: the rest is alike
  std::vector<Rgb> parts(std::size_t(n * turns));
  share(parts.size(), threads, [&](std::size_t i) {
    const std::size_t k = i / std::size_t(turns);
    const double t = 0.5 * (1 + rule.node[k]), mu = cosine(t);
    const double turn = even ? 0 : 0.5 * pi * (double(i % std::size_t(turns)) + 0.5) / turns;
    const double s = std::sqrt((1 - mu) * (1 + mu));
    const Reflected e = reflect(Vec3d{s * std::cos(turn), s * std::sin(turn), mu});
    for (std::size_t c = 0; c < 3; ++c) parts[i][c] = rule.weight[k] * mu * slope(t) * e[c] / turns;
  });
  Rgb sum{};
  for (const Rgb& p : parts)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += p[c];
  return sum;
}

void note(Truth& truth, const double* first, const double* second, std::size_t n) {
  for (std::size_t c = 0; c < n; ++c) {
    truth.values.push_back(first[c]);
    truth.floor = std::max(truth.floor, std::abs(first[c] - second[c]));
  }
}

}  // namespace

Truth surface_truth(const Material& m, const Set& set, int threads) {
  if (shading::brdf::Bsdf<double>(m).delta())
    throw std::invalid_argument("'" + m.name +
                                "' reflects one direction to one: there is nothing to integrate");
  const Ours ours(m);
  const Textbooks textbooks(m);
  const Vec3d scale = scale_of(m);
  Truth truth;
  if (set.averages > 0) {
    const Rgb a = average<24>(
        m, [&](const Vec3d& wo) { return by_normals(ours, scale, wo, average_tolerance); },
        [](double t) { return t * t; }, [](double t) { return 2 * t; }, threads);
    const Rgb b = average<20>(
        m, [&](const Vec3d& wo) { return by_directions(textbooks, scale, wo, average_tolerance); },
        [](double t) { return 1 - std::cos(0.5 * pi * t); },
        [](double t) { return 0.5 * pi * std::sin(0.5 * pi * t); }, threads);
    note(truth, a.data(), b.data(), 3);
    return truth;
  }
  const std::size_t viewers = set.views.size() / set.repeats;
  std::vector<Reflected> first(viewers), second(viewers);
  share(viewers, threads, [&](std::size_t i) {
    const Vec3d& wo = set.views[i * set.repeats];
    const bool light = set.sky.kind == SkyKind::cap;
    first[i] = light ? light_by_angles(ours, set.sky, wo) : by_normals(ours, scale, wo, tolerance_of_viewers);
    second[i] = light ? light_by_plane(textbooks, set.sky, wo)
                      : by_directions(textbooks, scale, wo, tolerance_of_viewers);
  });
  const std::size_t at = set.sky.kind == SkyKind::cosine ? 3 : 0;
  for (std::size_t i = 0; i < viewers; ++i) note(truth, first[i].data() + at, second[i].data() + at, 3);
  return truth;
}

Truth tail_shares(const Material& m) {
  const Vec3d head_on{0, 0, 1};
  const auto shares = [&](const auto& f) {
    std::array<double, 9> shell{};
    for (std::size_t k = 0; k < shell.size(); ++k) {
      const Reflected r = by_directions(f, scale_of(m), head_on, tolerance_of_viewers, double(k) * pi / 18,
                                        double(k + 1) * pi / 18);
      shell[k] = r[0] + r[1] + r[2];
    }
    std::array<double, 8> beyond{};
    double sum = 0;
    for (std::size_t k = 8; k > 0; --k) beyond[k - 1] = sum += shell[k];
    for (double& x : beyond) x /= sum + shell[0];
    return beyond;
  };
  const auto a = shares(Ours(m)), b = shares(Textbooks(m));
  Truth truth;
  note(truth, a.data(), b.data(), a.size());
  return truth;
}

double unmasked_albedo(const Material& m, double cosine) {
  const auto f = [&](const Vec3d& wi, const Vec3d& wo) {
    const Vec3d h = normalized(wi + wo);
    Rgb r = reference::facet(m, std::min(1.0, dot(wi, h)));
    for (double& x : r) x *= reference::distribution(m, h) / (4 * wi[2] * wo[2]);
    return r;
  };
  const Vec3d wo{std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine};
  const Reflected e = by_normals(f, scale_of(m), wo, tolerance_of_viewers / cosine);
  return std::max({e[0], e[1], e[2]});
}

}  // namespace treeline::bench::brdf_integral
