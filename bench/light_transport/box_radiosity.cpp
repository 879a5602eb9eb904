#include "bench/light_transport/box_radiosity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace treeline::bench::light_transport {
namespace {

constexpr std::size_t bounces_kept = 64;
constexpr double half = 1, height = 2;  // of the room

struct Side {
  BoxWall wall;
  int across;
  double at;
};
constexpr Side sides[] = {{BoxWall::floor, 1, 0},    {BoxWall::left, 0, -half},
                          {BoxWall::right, 0, half}, {BoxWall::back, 2, -half},
                          {BoxWall::front, 2, half}, {BoxWall::ceiling, 1, height}};

/// The indefinite integrals, less what cancels in the sums below. d: along the axis that both rectangles
/// span; x, y: of perpendicular ones from the line where their planes meet.
double perpendicular(double x, double y, double d) {
  const double r2 = x * x + y * y, all = r2 + d * d;
  if (all == 0) return 0;
  const double r = std::sqrt(r2);
  return d * (r > 0 ? r * std::atan(d / r) : 0) - 0.25 * (r2 - d * d) * std::log(all);
}
double parallel(double x, double y, double z) {
  const double rx = std::sqrt(x * x + z * z), ry = std::sqrt(y * y + z * z);
  return y * rx * std::atan(y / rx) + x * ry * std::atan(x / ry) -
         0.5 * z * z * std::log(x * x + y * y + z * z);
}

/// The sum over the sixteen corners of f(x of one, x of the other, y of one, y of the other), with signs.
template <class F>
double corners(const double (&a)[2], const double (&b)[2], const double (&c)[2], const double (&d)[2],
               const F& f) {
  double sum = 0;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l) sum += ((i + j + k + l) % 2 == 0 ? 1 : -1) * f(a[i], b[j], c[k], d[l]);
  return sum;
}

/// Form factor times area: the same both ways.
double exchange(const Patch& p, const Patch& q) {
  const auto of = [](const Patch& patch, int axis) {
    const auto k = static_cast<std::size_t>(axis);
    return std::array<double, 2>{patch.low[k], patch.high[k]};
  };
  if (p.across == q.across) {
    const double z = std::abs(p.at - q.at);
    if (z == 0) return 0;
    const auto px = of(p, (p.across + 1) % 3), py = of(p, (p.across + 2) % 3);
    const auto qx = of(q, (p.across + 1) % 3), qy = of(q, (p.across + 2) % 3);
    return corners({px[0], px[1]}, {qx[0], qx[1]}, {py[0], py[1]}, {qy[0], qy[1]},
                   [&](double a, double b, double c, double d) { return parallel(a - b, c - d, z); }) /
           (2 * std::numbers::pi);
  }
  const auto pd = of(p, q.across), qd = of(q, p.across);  // from the other's plane, that is
  const int along = 3 - p.across - q.across;
  const auto pa = of(p, along), qa = of(q, along);
  const auto away = [](const std::array<double, 2>& x, double from) {
    const double a = std::abs(x[0] - from), b = std::abs(x[1] - from);
    return std::array<double, 2>{std::min(a, b), std::max(a, b)};
  };
  const auto x = away(pd, q.at), y = away(qd, p.at);
  return corners({x[0], x[1]}, {y[0], y[1]}, {pa[0], pa[1]}, {qa[0], qa[1]},
                 [](double a, double b, double c, double d) { return perpendicular(a, b, c - d); }) /
         (2 * std::numbers::pi);
}

/// From -half to half, with the lamp's borders among them: m cells on either side of it, and along it.
std::vector<double> lines(double lamp_side, int m) {
  std::vector<double> out;
  const double at[] = {-half, -0.5 * lamp_side, 0.5 * lamp_side, half};
  for (int part = 0; part < 3; ++part)
    for (int k = 0; k < m; ++k) out.push_back(at[part] + (at[part + 1] - at[part]) * k / m);
  out.push_back(half);
  return out;
}

struct Walls {
  std::vector<Patch> patches;
  std::vector<std::size_t> wall;
};
Walls split(double lamp_side, int m) {
  Walls out;
  const auto level = lines(lamp_side, m);
  for (const Side& side : sides) {
    const auto a = static_cast<std::size_t>((side.across + 1) % 3),
               b = static_cast<std::size_t>((side.across + 2) % 3);
    const auto place = [&](std::size_t axis, double x) { return axis == 1 ? x + half : x; };
    for (std::size_t i = 0; i + 1 < level.size(); ++i)
      for (std::size_t j = 0; j + 1 < level.size(); ++j) {
        Patch p{side.across, side.at, {}, {}};
        p.low[a] = place(a, level[i]), p.high[a] = place(a, level[i + 1]);
        p.low[b] = place(b, level[j]), p.high[b] = place(b, level[j + 1]);
        const auto inside = [&](double low, double high) {
          return std::max(std::abs(low), std::abs(high)) <= 0.5 * lamp_side * (1 + 1e-12);
        };
        const bool lamp =
            side.wall == BoxWall::ceiling && inside(p.low[a], p.high[a]) && inside(p.low[b], p.high[b]);
        out.patches.push_back(p);
        out.wall.push_back(static_cast<std::size_t>(lamp ? BoxWall::lamp : side.wall));
      }
  }
  return out;
}

using Means = std::vector<std::array<double, box_walls>>;

Means solve(double albedo, double lamp_side, double emission, int m) {
  const Walls walls = split(lamp_side, m);
  const std::size_t n = walls.patches.size();
  std::vector<double> area(n);
  for (std::size_t i = 0; i < n; ++i) area[i] = walls.patches[i].area();
  std::vector<double> factor(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const double x = exchange(walls.patches[i], walls.patches[j]);
      factor[i * n + j] = x / area[i], factor[j * n + i] = x / area[j];
    }
  std::vector<double> light(n), next(n);
  for (std::size_t i = 0; i < n; ++i)
    if (walls.wall[i] == static_cast<std::size_t>(BoxWall::lamp)) light[i] = emission;
  Means means;
  for (std::size_t bounce = 0; bounce <= bounces_kept; ++bounce) {
    std::array<double, box_walls> sum{}, all{};
    for (std::size_t i = 0; i < n; ++i)
      sum[walls.wall[i]] += light[i] * area[i], all[walls.wall[i]] += area[i];
    for (std::size_t w = 0; w < box_walls; ++w) sum[w] /= all[w];
    means.push_back(sum);
    for (std::size_t i = 0; i < n; ++i) {
      double reached = 0;
      for (std::size_t j = 0; j < n; ++j) reached += factor[i * n + j] * light[j];
      next[i] = albedo * reached;
    }
    std::swap(light, next);
  }
  // By now each bounce is the one before, darker by the albedo.
  for (double& x : means.back()) x /= 1 - albedo;
  return means;
}

}  // namespace

double Patch::area() const {
  double a = 1;
  for (std::size_t k = 0; k < 3; ++k)
    if (static_cast<int>(k) != across) a *= high[k] - low[k];
  return a;
}

double form_factor(const Patch& from, const Patch& to) { return exchange(from, to) / from.area(); }

std::array<double, box_walls> BoxLight::sum(std::size_t most) const {
  std::array<double, box_walls> out{};
  for (std::size_t k = 0; k < bounces.size() && k <= most; ++k)
    for (std::size_t w = 0; w < box_walls; ++w) out[w] += bounces[k][w];
  return out;
}

BoxLight box_radiosity(double albedo, double lamp_side, double emission, int m) {
  if (!(albedo >= 0 && albedo < 1))
    throw std::invalid_argument("the albedo is " + std::to_string(albedo) + "; it must be in [0, 1)");
  if (!(lamp_side > 0 && lamp_side < 2 * half))
    throw std::invalid_argument("the lamp's side is " + std::to_string(lamp_side) +
                                " m; it must be in (0, 2)");
  const Means coarse = solve(albedo, lamp_side, emission, m),
              fine = solve(albedo, lamp_side, emission, 2 * m);
  BoxLight light;
  light.bounces = fine;
  for (std::size_t k = 0; k < fine.size(); ++k)
    for (std::size_t w = 0; w < box_walls; ++w)
      light.bounces[k][w] += (fine[k][w] - coarse[k][w]) / 3;  // errors fall with the square of the patches
  const auto last = light.sum(bounces_kept);
  BoxLight before;
  before.bounces = fine;
  const auto told = before.sum(bounces_kept);
  for (std::size_t w = 0; w < box_walls; ++w)
    light.error = std::max(light.error, std::abs(told[w] / last[w] - 1));
  return light;
}

}  // namespace treeline::bench::light_transport
