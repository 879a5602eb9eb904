// Batches of GGX and Beckmann reflection against the scalar models in double, closed forms of what sampling
// loses and reflects, any length of arrays, and hostile directions. Compiled once for each instruction set.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../accel/instruction_set.hpp"
#include "geometry/random.hpp"
#include "shading/brdf/batch_beckmann.hpp"
#include "shading/brdf/batch_ggx.hpp"
#include "shading/brdf/microfacet.hpp"

namespace treeline::shading::brdf {
namespace {

using geometry::Pcg32;
using geometry::Vec3d;
using geometry::Vec3f;

using std::numbers::pi;

/// Relative error of batches' f and pdf; Beckmann's exponential e^-x multiplies x's own by x.
constexpr double relative = 4e-6;

struct Alpha {
  double x, y;
};
constexpr Alpha alphas[] = {{1e-9, 1e-9}, {1e-4, 1e-4}, {0.02, 0.02}, {0.3, 0.3},
                            {1, 1},       {10, 10},     {0.05, 0.6},  {0.9, 0.1}};
constexpr Masking maskings[] = {Masking::separable, Masking::correlated};

/// Directions as a batch takes them.
struct Arrays {
  std::vector<float> x, y, z;

  explicit Arrays(std::size_t n = 0) : x(n), y(n), z(n) {}
  void add(const Vec3d& w) {
    x.push_back(static_cast<float>(w[0])), y.push_back(static_cast<float>(w[1])),
        z.push_back(static_cast<float>(w[2]));
  }
  operator Directions() const { return {x, y, z}; }
  DirectionsOut out() { return {x, y, z}; }
  std::size_t size() const { return x.size(); }
  Vec3d operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
};

Vec3d direction(double cosine, double azimuth) {
  const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}
/// Above the surface, some of them near the horizon, some near the normal.
Vec3d random_direction(Pcg32& random) {
  const double u = random.uniform(), kind = random.uniform();
  const double cosine = kind < 0.1 ? 1e-6 * u + 1e-9 : kind < 0.2 ? 1 - 1e-4 * u : u + 1e-9;
  return direction(std::min(1.0, cosine), 2 * pi * random.uniform());
}

/// Pairs whose half vector is about as far from the normal as the roughness lets facets be.
void random_pairs(const Alpha& a, std::size_t n, Arrays& wi, Arrays& wo) {
  Pcg32 random(11);
  while (wi.size() < n) {
    const Vec3d o = random_direction(random);
    const double r = 2 * random.uniform(), turn = 2 * pi * random.uniform();
    const Vec3d h = geometry::normalized(Vec3d{a.x * r * std::cos(turn), a.y * r * std::sin(turn), 1});
    const Vec3d i = random.uniform() < 0.2 ? random_direction(random) : reflected(o, h);
    if (i[2] > 1e-9) wi.add(geometry::normalized(i)), wo.add(o);
  }
}

/// Largest error, and where it is, against a number that the answer should be.
struct Worst {
  double error = 0;
  std::string where;

  void add(double got, double truth, double scale, const Vec3d& wi, const Vec3d& wo) {
    const double e = std::abs(got - truth) / scale;
    if (e <= error) return;
    error = e;
    where = testing::PrintToString(wi.v) + " " + testing::PrintToString(wo.v) + ": " + std::to_string(got) +
            ", not " + std::to_string(truth);
  }
};

/// How much Beckmann's e^-x multiplies errors.
double exponent(const Ggx<double>&, const Vec3d&) { return 0; }
double exponent(const Beckmann<double>& d, const Vec3d& h) {
  const double x = h[0] / (d.ax * h[2]), y = h[1] / (d.ay * h[2]);
  return x * x + y * y;
}

template <class Lobe, class Normals>
void expect_scalar_answers(const Lobe& lobe, const Normals& normals, Masking masking, bool all_seen) {
  Arrays wi, wo;
  random_pairs({normals.ax, normals.ay}, 3000, wi, wo);
  std::vector<float> f(wi.size()), p(wi.size());
  lobe.eval(wi, wo, f), lobe.pdf(wi, wo, p);
  Worst eval, pdf;
  for (std::size_t i = 0; i < wi.size(); ++i) {
    const Vec3d h = half_vector(wi[i], wo[i]);
    const double d = normals.d(h),
                 area = all_seen ? normals.projected_area(wo[i]) : detail::sampled_area(normals, wo[i]);
    const double truth = 0.25 * d * smith_g2_by_cosines(normals, masking, wi[i], wo[i]);
    const double density = 0.25 * d / area, x = exponent(normals, h);
    // Below 2^-126 the exponential is 0, and above 1e37 the range of floats ends.
    const auto scale = [&](double t) { return x < 86 ? t * (1 + x) : t * std::exp(x - 86); };
    if (truth < 1e37) eval.add(f[i], truth, std::max(scale(truth), 1e-30), wi[i], wo[i]);
    if (density < 1e37) pdf.add(p[i], density, std::max(scale(density), 1e-30), wi[i], wo[i]);
  }
  EXPECT_LE(eval.error, relative) << eval.where;
  EXPECT_LE(pdf.error, relative) << pdf.where;
}

TEST(BrdfBatch, GgxAnswersAsTheScalarModelInDouble) {
  for (const Alpha& a : alphas)
    for (const Masking masking : maskings)
      for (const VisibleNormals normals : {VisibleNormals::caps, VisibleNormals::bounded}) {
        SCOPED_TRACE(testing::Message() << a.x << " " << a.y << " masking " << int(masking));
        expect_scalar_answers(BatchGgx(a.x, a.y, masking, normals), Ggx<double>{a.x, a.y}, masking,
                              normals == VisibleNormals::caps);
      }
}

TEST(BrdfBatch, BeckmannAnswersAsTheScalarModelInDouble) {
  for (const Alpha& a : alphas)
    for (const Masking masking : maskings) {
      SCOPED_TRACE(testing::Message() << a.x << " " << a.y << " masking " << int(masking));
      expect_scalar_answers(BatchBeckmann(a.x, a.y, masking), Beckmann<double>{a.x, a.y}, masking, true);
    }
}

// The same u and v give the same direction, weight and density. Where the normal's components, before they
// are brought to unit length, are short, it has the rounding of its parts over its length, and the density
// that over its square.
TEST(BrdfBatch, GgxSamplesAreThoseOfTheScalarModelInDouble) {
  constexpr std::size_t n = 5000;
  Pcg32 random(5);
  Arrays wo;
  std::vector<float> u(n), v(n), weight(n), pdf(n);
  for (std::size_t i = 0; i < n; ++i) {
    wo.add(random_direction(random));
    u[i] = random.uniform<float>(), v[i] = random.uniform<float>();
  }
  Arrays wi(n);
  for (const Alpha& a : alphas)
    for (const Masking masking : maskings)
      for (const bool bounded : {false, true}) {
        SCOPED_TRACE(testing::Message() << a.x << " " << a.y << " masking " << int(masking) << bounded);
        const BatchGgx lobe(a.x, a.y, masking, bounded ? VisibleNormals::bounded : VisibleNormals::caps);
        const Ggx<double> normals{a.x, a.y};
        lobe.sample(wo, u, v, wi.out(), weight, pdf);
        Worst x, w, p;
        for (std::size_t i = 0; i < n; ++i) {
          const Vec3d o = wo[i], view = detail::stretched(normals, o);
          const double below = (bounded ? bounded_share(normals, o) : 1.0) * view[2];
          const Vec3d sum = detail::plus_cap(view, below, double(u[i]), double(v[i]));
          const Vec3d h = detail::unstretched(normals, sum), truth = reflected(o, h);
          const double steep =
              std::max({1.0, a.x, a.y}) / geometry::length(Vec3d{a.x * sum[0], a.y * sum[1], sum[2]});
          for (int k = 0; k < 3; ++k) x.add(wi[i][k], truth[k], steep, wi[i], o);
          if (!(truth[2] > 1e-4 * steep)) continue;  // which side of the horizon rounding may decide
          const double area = bounded ? bounded_area(normals, o) : normals.projected_area(o);
          const double g = smith_g2_by_cosines(normals, masking, truth, o), d = normals.d(h);
          // The cosine has the direction's error, and the weight is at most 1.
          w.add(weight[i], truth[2] * area * g, steep, wi[i], o);
          if (d / area < 1e37) p.add(pdf[i], 0.25 * d / area, 0.25 * d / area * steep * steep, wi[i], o);
        }
        EXPECT_LE(x.error, 2e-6) << x.where;
        EXPECT_LE(w.error, 3e-5) << w.where;
        EXPECT_LE(p.error, 4e-6) << p.where;
      }
}

/// Share of the facets seen whose slope along the view is above s, in the space of roughness 1.
double seen_beyond(double cosine, double sine, double s) {
  return 0.5 * (cosine * std::erfc(s) + sine * std::exp(-s * s) * std::numbers::inv_sqrtpi);
}

TEST(BrdfBatch, BeckmannSlopesAreSeenAsOftenAsAsked) {
  using namespace batch;
  Pcg32 random(8);
  Worst share;
  for (int i = 0; i < 20'000; ++i) {
    const double kind = random.uniform();
    const double tilt = kind < 0.3   ? std::pow(10.0, -6 * random.uniform())
                        : kind < 0.6 ? pi / 2 - std::pow(10.0, -6 * random.uniform())
                                     : pi / 2 * random.uniform();
    const float cosine = float(std::cos(tilt)), sine = float(std::sin(tilt)), end = random.uniform<float>();
    const float u = i % 3 == 0 ? end : i % 3 == 1 ? end * end * end : 1 - 0x1p-24f - end * end * end * 0.999f;
    const double c = double(cosine), s = double(sine), seen = seen_beyond(c, s, -std::min(7.0, c / s));
    const float slope =
        visible_slope(floats(cosine), floats(sine), floats(cosine / sine), floats(float(seen)), floats(u))[0];
    share.add(seen_beyond(c, s, double(slope)) / seen, double(u), 1, {tilt, 0, 0}, {double(slope), 0, 0});
  }
  EXPECT_LE(share.error, 1e-6) << share.where;
}

// The same u and v give the same direction, weight and density, within a share of 1e-6 of the facets seen:
// over the density of slopes, that is how far slopes may be apart.
TEST(BrdfBatch, BeckmannSamplesAreThoseOfTheScalarModelInDouble) {
  constexpr std::size_t n = 3000;
  Pcg32 random(6);
  Arrays wo, wi(n);
  std::vector<float> u(n), v(n), weight(n), pdf(n);
  for (std::size_t i = 0; i < n; ++i) {
    wo.add(random_direction(random));
    u[i] = random.uniform<float>(), v[i] = random.uniform<float>();
  }
  for (const Alpha& a : alphas)
    for (const Masking masking : maskings) {
      SCOPED_TRACE(testing::Message() << a.x << " " << a.y << " masking " << int(masking));
      const Beckmann<double> normals{a.x, a.y};
      BatchBeckmann(a.x, a.y, masking).sample(wo, u, v, wi.out(), weight, pdf);
      Worst x, w, p;
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3d o = wo[i], h = sample_visible(normals, o, double(u[i]), double(v[i]));
        const Vec3d truth = reflected(o, h), view = geometry::normalized(Vec3d{a.x * o[0], a.y * o[1], o[2]});
        const double c = view[2], s = std::hypot(view[0], view[1]);
        const double along = detail::visible_slope(c, s, double(u[i]));
        const double density = (c + s * along) * std::exp(-along * along) * std::numbers::inv_sqrtpi /
                               seen_beyond(c, s, -std::min(7.0, c / s));
        const double apart = (1 + 1 / density) * std::max({1.0, a.x, a.y});
        for (int k = 0; k < 3; ++k) x.add(wi[i][k], truth[k], apart, wi[i], o);
        if (!(truth[2] > 1e-5 * apart) || apart > 1e3)
          continue;  // which side of the horizon rounding may decide
        const double area = normals.projected_area(o), d = normals.d(h);
        w.add(weight[i], truth[2] * area * smith_g2_by_cosines(normals, masking, truth, o), apart, wi[i], o);
        if (d / area < 1e37) p.add(pdf[i], 0.25 * d / area, 0.25 * d / area * apart, wi[i], o);
      }
      EXPECT_LE(x.error, 3e-6) << x.where;
      EXPECT_LE(w.error, 3e-5) << w.where;
      EXPECT_LE(p.error, 2e-5) << p.where;
    }
}

/// A square of stratified midpoints.
struct Grid {
  std::vector<float> u, v;

  explicit Grid(int side) {
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        u.push_back(static_cast<float>((x + 0.5) / side)), v.push_back(static_cast<float>((y + 0.5) / side));
  }
};

// Head-on the share α²/(1+α²) of the visible normals reflects downwards; at α = 1 it is μ/(1+μ).
TEST(BrdfBatch, SamplesLostAreThoseOfTheClosedForm) {
  const Grid grid(256);
  const std::size_t n = grid.u.size();
  Arrays wi(n);
  std::vector<float> weight(n), pdf(n);
  const auto lost = [&](double alpha, double mu) {
    const BatchGgx lobe(alpha, alpha, Masking::correlated, VisibleNormals::caps);
    lobe.sample(Vec3f(direction(mu, 0.7)), grid.u, grid.v, wi.out(), weight, pdf);
    std::size_t count = 0, consistent = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const bool below = !(wi.z[i] > 0);
      count += below ? 1u : 0u;
      consistent += (weight[i] == 0) == below && (pdf[i] == 0) == below ? 1u : 0u;
    }
    EXPECT_EQ(consistent, n);
    return static_cast<double>(count) / static_cast<double>(n);
  };
  // A border through the grid miscounts at most the cells along it.
  for (const double alpha : {0.1, 0.5, 1.0, 2.0})
    EXPECT_NEAR(lost(alpha, 1), alpha * alpha / (1 + alpha * alpha), 1.0 / 256) << alpha;
  for (const double mu : {0.05, 0.3, 0.8}) EXPECT_NEAR(lost(1, mu), mu / (1 + mu), 2.0 / 256) << mu;
}

// GGX, α = 1, head-on: E = 1 - ln 2, by the weights of both samplers and by the density of any direction.
TEST(BrdfBatch, AlbedoIsThatOfTheClosedForm) {
  const Grid grid(512);
  const std::size_t n = grid.u.size();
  const Vec3f normal{0, 0, 1};
  Arrays wi(n);
  std::vector<float> weight(n), pdf(n);
  const auto mean = [&](const std::vector<float>& a) {
    double sum = 0;
    for (const float x : a) sum += double(x);
    return sum / static_cast<double>(n);
  };
  for (const Masking masking : maskings) {
    const BatchGgx all(1, 1, masking, VisibleNormals::caps), bounded(1, 1, masking);
    all.sample(normal, grid.u, grid.v, wi.out(), weight, pdf);
    EXPECT_NEAR(mean(weight), 1 - std::log(2.0), 1e-5);
    bounded.sample(normal, grid.u, grid.v, wi.out(), weight, pdf);
    EXPECT_NEAR(mean(weight), 1 - std::log(2.0), 1e-5);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3d w = direction(1 - double(grid.v[i]), 2 * pi * double(grid.u[i]));
      wi.x[i] = float(w[0]), wi.y[i] = float(w[1]), wi.z[i] = float(w[2]);
    }
    std::vector<float> f(n);
    all.eval(wi, normal, f);
    for (std::size_t i = 0; i < n; ++i) f[i] *= float(2 * pi) * wi.z[i];
    EXPECT_NEAR(mean(f), 1 - std::log(2.0), 1e-5);
  }
}

// The albedo of facets by the weights of samples and by the values of all directions.
TEST(BrdfBatch, BeckmannSamplesAndValuesGiveOneAlbedo) {
  const Grid grid(512);
  const std::size_t n = grid.u.size();
  Arrays wi(n);
  std::vector<float> weight(n), pdf(n), f(n);
  for (const Masking masking : maskings)
    for (const double mu : {0.2, 0.7, 1.0}) {
      const BatchBeckmann lobe(0.4, 0.7, masking);
      const Vec3f wo(direction(mu, 0.3));
      lobe.sample(wo, grid.u, grid.v, wi.out(), weight, pdf);
      double sampled = 0, valued = 0;
      for (const float w : weight) sampled += double(w);
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3d w = direction(1 - double(grid.v[i]), 2 * pi * double(grid.u[i]));
        wi.x[i] = float(w[0]), wi.y[i] = float(w[1]), wi.z[i] = float(w[2]);
      }
      lobe.eval(wi, wo, f);
      for (std::size_t i = 0; i < n; ++i) valued += 2 * pi * double(f[i]) * double(wi.z[i]);
      // What the grid leaves to the samples' mean; it halves with twice the side.
      EXPECT_NEAR(sampled / double(n), valued / double(n), 3e-4) << mu;
    }
}

// Arrays of any length: the same bits as one entry at a time, and nothing is written behind the last.
TEST(BrdfBatch, LengthChangesNothing) {
  constexpr std::size_t most = 2 * batch::lanes + 3;
  Pcg32 random(3);
  Arrays in, out;
  std::vector<float> u, v;
  for (std::size_t i = 0; i < most; ++i) {
    in.add(random_direction(random)), out.add(random_direction(random));
    u.push_back(random.uniform<float>()), v.push_back(random.uniform<float>());
  }
  const BatchGgx ggx(0.3, 0.2, Masking::correlated);
  const BatchBeckmann beckmann(0.3, 0.2, Masking::separable);
  const auto part = [](const Arrays& a, std::size_t first, std::size_t n) {
    return Directions{std::span(a.x).subspan(first, n), std::span(a.y).subspan(first, n),
                      std::span(a.z).subspan(first, n)};
  };
  // All answers for entries [first, first + n), each array with one more float than is asked for.
  const auto answers = [&](std::size_t first, std::size_t n) {
    std::vector<std::vector<float>> a(13, std::vector<float>(n + 1, -7.0f));
    const auto to = [&](std::size_t k) { return std::span(a[k]).first(n); };
    const Directions wi = part(in, first, n), wo = part(out, first, n);
    ggx.eval(wi, wo, to(0)), ggx.pdf(wi, wo, to(1)), beckmann.eval(wi, wo, to(2));
    ggx.sample(wo, std::span(u).subspan(first, n), std::span(v).subspan(first, n), {to(3), to(4), to(5)},
               to(6), to(7));
    beckmann.sample(wo, std::span(u).subspan(first, n), std::span(v).subspan(first, n),
                    {to(8), to(9), to(10)}, to(11), to(12));
    return a;
  };
  std::vector<std::vector<std::vector<float>>> single;
  for (std::size_t i = 0; i < most; ++i) single.push_back(answers(i, 1));
  for (std::size_t n = 0; n <= most; ++n) {
    const auto all = answers(most - n, n);
    for (std::size_t k = 0; k < all.size(); ++k) {
      for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(all[k][i], single[most - n + i][k][0]) << n << " " << k;
      EXPECT_EQ(all[k][n], -7.0f);
    }
  }
}

TEST(BrdfBatch, OneViewForAllIsThatViewForEach) {
  constexpr std::size_t n = 100;
  Pcg32 random(4);
  const Vec3f view(direction(0.4, 2.0));
  Arrays wi, wo, a(n), b(n);
  std::vector<float> u, v, f(n), g(n), p(n), q(n);
  for (std::size_t i = 0; i < n; ++i) {
    wi.add(random_direction(random)), wo.add(Vec3d(view));
    u.push_back(random.uniform<float>()), v.push_back(random.uniform<float>());
  }
  const BatchGgx lobe(0.1, 0.4, Masking::separable);
  lobe.eval(wi, wo, f), lobe.eval(wi, view, g), lobe.pdf(wi, wo, p), lobe.pdf(wi, view, q);
  EXPECT_EQ(f, g);
  EXPECT_EQ(p, q);
  lobe.sample(wo, u, v, a.out(), f, p), lobe.sample(view, u, v, b.out(), g, q);
  EXPECT_TRUE(a.x == b.x && a.y == b.y && a.z == b.z && f == g && p == q);
}

// Directions below the surface, along it, opposite to each other, of no length; numbers at the ends of [0,
// 1]: every answer is a number, none is negative, and no weight is above 1.
TEST(BrdfBatch, HostileDirectionsGetNumbers) {
  const double tiny = 1e-30;
  const Vec3d hostile[] = {{0, 0, 1},           {0, 0, -1},    {1, 0, 0},      {-1, 0, 0},
                           {0, 1, tiny},        {0, 0, 0},     {-1, 0, tiny},  {1, 0, 1e-19},
                           {-1, 0, 1e-19},      {1, 0, -1e-9}, {-0., 0, 1},    {0.6, 0.8, 1e-17},
                           {-0.6, -0.8, 1e-17}, {0.8, 0, 0.6}, {-0.8, 0, -0.6}};
  const float ends[] = {0, 0x1p-24f, 0.5f, 0x1.fffffep-1f, 1};
  Arrays wi, wo;
  std::vector<float> u, v;
  for (const Vec3d& i : hostile)
    for (const Vec3d& o : hostile)
      for (const float a : ends)
        for (const float b : ends) wi.add(i), wo.add(o), u.push_back(a), v.push_back(b);
  const std::size_t n = wi.size();
  std::vector<float> f(n), p(n), weight(n);
  Arrays to(n);
  for (const Alpha& a : alphas)
    for (const Masking masking : maskings) {
      // By entry: at least 0 and a number; 0 where a direction is below the surface.
      const auto check_above = [&](const std::vector<float>& answers) {
        for (std::size_t i = 0; i < n; ++i) {
          const bool above = wi.z[i] > 0 && wo.z[i] > 0;
          ASSERT_TRUE(above ? answers[i] >= 0 : answers[i] == 0)
              << answers[i] << " at " << testing::PrintToString(wi[i].v) << testing::PrintToString(wo[i].v)
              << " roughness " << a.x << " " << a.y;
        }
      };
      const auto check = [&](const auto& lobe) {
        lobe.eval(wi, wo, f), lobe.pdf(wi, wo, p);
        check_above(f), check_above(p);
        lobe.sample(wo, u, v, to.out(), weight, p);
        for (std::size_t i = 0; i < n; ++i) {
          ASSERT_TRUE(weight[i] >= 0 && weight[i] <= 1.000001f && p[i] >= 0)
              << weight[i] << " " << p[i] << " at " << testing::PrintToString(wo[i].v) << u[i] << " " << v[i]
              << " roughness " << a.x << " " << a.y;
          ASSERT_TRUE(p[i] > 0 || weight[i] == 0);
          ASSERT_TRUE(std::isfinite(to.x[i]) && std::isfinite(to.y[i]) && std::isfinite(to.z[i]));
        }
      };
      check(BatchBeckmann(a.x, a.y, masking));
      for (const VisibleNormals normals : {VisibleNormals::caps, VisibleNormals::bounded})
        check(BatchGgx(a.x, a.y, masking, normals));
    }
}

TEST(BrdfBatch, BadInputIsRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -0.1, 1e-10, 11.0, nan, double(INFINITY)}) {
    EXPECT_THROW(BatchGgx(bad, 0.5, Masking::correlated), InvalidMaterial) << bad;
    EXPECT_THROW(BatchBeckmann(0.5, bad, Masking::correlated), InvalidMaterial) << bad;
  }
  const BatchGgx lobe(0.5, 0.5, Masking::correlated);
  const Arrays three(3), two(2);
  std::vector<float> f(3);
  try {
    lobe.eval(three, two, f);
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(), "batch of 3 entries: wo has 2");
  }
  Arrays to(3);
  std::vector<float> u(3), v(2), w(3);
  EXPECT_THROW(lobe.sample(three, u, v, to.out(), w, f), std::invalid_argument);
  EXPECT_NO_THROW(lobe.eval(Directions{}, Directions{}, std::span<float>{}));
}

}  // namespace
}  // namespace treeline::shading::brdf

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return treeline::accel::test::runs_here() ? RUN_ALL_TESTS() : 0;
}
