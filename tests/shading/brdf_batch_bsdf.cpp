// BatchBsdf against Bsdf<double>: values, densities and samples of every kind of Fresnel's factor and
// compensation, and what is refused. Compiled once for each instruction set that reads tables in a way of its
// own.
#include <gtest/gtest.h>

#include "brdf_common.hpp"
#include "geometry/random.hpp"
#include "geometry/sampling.hpp"
#include "shading/brdf/batch_bsdf.hpp"
#include "shading/brdf/bsdf.hpp"

namespace treeline::shading::brdf {
namespace {

using geometry::Pcg32;
using geometry::Vec3d;
using geometry::Vec3f;

constexpr std::size_t n = 2000;

/// Of 2 to 3 units in the last place of floats in each of some ten factors.
constexpr double relative = 1e-5;

struct Case {
  std::string name;
  Material material;
};

std::vector<Case> all_cases() {
  std::vector<Case> all{{"diffuse", {}}};
  all.back().material.reflectance = {0.2f, 0.5f, 1};
  const auto add = [&](std::string name, Distribution d, double ax, double ay, FresnelKind f,
                       Compensation c) {
    Material m = test::facets(d, ax < ay ? Masking::separable : Masking::correlated, ax, ay);
    m.fresnel = f, m.compensation = c, m.reflectance = {0.04f, 0.5f, 0.9f};
    all.push_back({std::move(name), m});
  };
  constexpr auto ggx = Distribution::ggx, beckmann = Distribution::beckmann;
  add("one", ggx, 0.4, 0.4, FresnelKind::one, Compensation::none);
  add("schlick", beckmann, 0.3, 0.5, FresnelKind::schlick, Compensation::none);
  add("dielectric", ggx, 0.4, 0.3, FresnelKind::dielectric, Compensation::none);
  all.push_back(all.back());
  all.back().name = "dielectric near 1", all.back().material.index = 1.001;
  all.push_back(all.back());
  all.back().name = "rarer dielectric", all.back().material.index = 0.6;
  add("gold", ggx, 0.3, 0.3, FresnelKind::conductor, Compensation::none);
  all.push_back(all.back());
  all.back().name = "index above extinction and no extinction";
  all.back().material.conductor_index = {3, 0.05f, 1.5f},
  all.back().material.conductor_extinction = {1, 7, 0};
  add("kulla_conty", ggx, 0.6, 0.6, FresnelKind::schlick, Compensation::kulla_conty);
  add("kulla_conty anisotropic", ggx, 0.9, 0.3, FresnelKind::schlick, Compensation::kulla_conty);
  add("kulla_conty beckmann", beckmann, 0.8, 0.8, FresnelKind::conductor, Compensation::kulla_conty);
  add("textbook", ggx, 0.6, 0.6, FresnelKind::schlick, Compensation::kulla_conty_textbook);
  add("directional", ggx, 1, 1, FresnelKind::schlick, Compensation::kulla_conty_directional);
  add("turquin", ggx, 0.3, 0.8, FresnelKind::schlick, Compensation::turquin);
  add("nothing lost", ggx, 1e-4, 1e-4, FresnelKind::one, Compensation::kulla_conty);
  return all;
}

/// A case with both sides, whose tables are made once.
struct Surface : Case {
  BatchBsdf batch{material};
  Bsdf<double> truth{material};
};
const std::vector<Surface>& surfaces() {
  static const std::vector<Surface> all = [] {
    std::vector<Surface> r;
    for (const Case& c : all_cases()) r.push_back({c});
    return r;
  }();
  return all;
}

/// Directions, numbers and answers of a batch.
struct Arrays {
  std::vector<float> values[3];

  Arrays() {
    for (auto& v : values) v.resize(n);
  }
  void set(std::size_t i, const Vec3d& w) {
    for (int k = 0; k < 3; ++k) values[k][i] = float(w[k]);
  }
  operator Directions() const { return {values[0], values[1], values[2]}; }
  Components<float> out() { return {values[0], values[1], values[2]}; }
  Vec3d operator[](std::size_t i) const { return {values[0][i], values[1][i], values[2][i]}; }
};

class BatchBsdfs : public testing::Test {
 protected:
  BatchBsdfs() {
    Pcg32 random(21);
    for (std::size_t i = 0; i < n; ++i) {
      const auto anywhere = [&] {
        const double a = random.uniform(), b = random.uniform();
        return geometry::sample_hemisphere(a, b);
      };
      wi.set(i, i % 20 == 0 ? -anywhere() : anywhere());
      wo.set(i, i % 20 == 1 ? -anywhere() : anywhere());
      choice.push_back(random.uniform<float>()), u.push_back(random.uniform<float>());
      v.push_back(random.uniform<float>());
    }
  }
  Arrays wi, wo;
  std::vector<float> choice, u, v;
};

double worst_of(const Vec3d& got, const Vec3d& truth) {
  double most = 0;
  for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(got[k] - truth[k]) / std::max(truth[k], 1e-30));
  return most;
}

TEST_F(BatchBsdfs, ValuesAndDensitiesAreThoseOfBsdfInDouble) {
  for (const Surface& c : surfaces()) {
    SCOPED_TRACE(c.name);
    Arrays f;
    std::vector<float> pdf(n);
    c.batch.eval(wi, wo, f.out()), c.batch.pdf(wi, wo, pdf);
    double eval_error = 0, pdf_error = 0;
    for (std::size_t i = 0; i < n; ++i) {
      // Beckmann's tails, and nearly total reflection, multiply the rounding of their arguments.
      const Vec3d h = wi[i][2] > 0 && wo[i][2] > 0 ? half_vector(wi[i], wo[i]) : Vec3d{0, 0, 1};
      const double steep =
          c.material.distribution == Distribution::beckmann
              ? 1 + (h[0] * h[0] + h[1] * h[1]) / (h[2] * h[2] * c.material.alpha_x * c.material.alpha_x)
              : 1;
      if (steep > 60) continue;
      if (c.material.index < 1 && c.material.fresnel == FresnelKind::dielectric &&
          std::abs(geometry::dot(wi[i], h) - 0.8) < 1e-3)
        continue;
      eval_error = std::max(eval_error, worst_of(f[i], c.truth.eval(wi[i], wo[i])) / steep);
      const double p = c.truth.pdf(wi[i], wo[i]);
      pdf_error = std::max(pdf_error, std::abs(double(pdf[i]) - p) / std::max(p, 1e-30) / steep);
    }
    EXPECT_LE(eval_error, relative);
    EXPECT_LE(pdf_error, relative);
  }
}

// A sample's weight is f cos / pdf of its direction, and its density that of the direction, by Bsdf in
// double; the direction itself is Bsdf's for the same numbers, as far as the tests of the lobes say.
TEST_F(BatchBsdfs, SamplesAreThoseOfBsdfInDouble) {
  for (const Surface& c : surfaces()) {
    if (c.material.alpha_x < 0.1 || c.material.alpha_y < 0.1) continue;  // the direction's rounding is seen
    SCOPED_TRACE(c.name);
    Arrays to, weight;
    std::vector<float> pdf(n);
    c.batch.sample(wo, choice, u, v, to.out(), weight.out(), pdf);
    std::size_t lost = 0, astray = 0, same = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const BsdfSample<double> s = c.truth.sample(wo[i], double(choice[i]), double(u[i]), double(v[i]));
      if (pdf[i] == 0) {
        EXPECT_TRUE(weight[i] == Vec3d{});
        EXPECT_LT(s.wi[2] * s.pdf, 1e-4) << i;  // lost there as well, or nearly
        ++lost;
        continue;
      }
      const double p = c.truth.pdf(to[i], wo[i]);
      ASSERT_NEAR(double(pdf[i]) / p, 1, 1e-3) << i;
      const Vec3d w = c.truth.eval(to[i], wo[i]) * (to[i][2] / p);
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(weight[i][k], w[k], 2e-4 * w[k] + 1e-6) << i;
      // Which lobe is sampled may depend on the last bit.
      astray += geometry::distance(s.wi, to[i]) > 1e-4 ? 1u : 0u;
      ++same;
    }
    EXPECT_LE(astray, same / 500);
    EXPECT_LE(lost, n / 2);
    EXPECT_GE(lost, n / 20);  // those seen from below
  }
}

TEST_F(BatchBsdfs, OneViewForAllIsThatViewForEach) {
  Material m = test::ggx(0.5);
  m.compensation = Compensation::kulla_conty;
  const BatchBsdf bsdf(m);
  const Vec3f view{0.6f, 0, 0.8f};
  for (std::size_t i = 0; i < n; ++i) wo.set(i, Vec3d(view));
  Arrays a, b, c, d;
  std::vector<float> p(n), q(n);
  bsdf.eval(wi, wo, a.out()), bsdf.eval(wi, view, b.out());
  bsdf.pdf(wi, wo, p), bsdf.pdf(wi, view, q);
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(a.values[k] == b.values[k]);
  EXPECT_TRUE(p == q);
  bsdf.sample(wo, choice, u, v, a.out(), c.out(), p), bsdf.sample(view, choice, u, v, b.out(), d.out(), q);
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(a.values[k] == b.values[k] && c.values[k] == d.values[k]);
  EXPECT_TRUE(p == q);
}

// Directions that are none read no memory but the tables', and those below the surface get nothing.
TEST_F(BatchBsdfs, HostileDirectionsAreHarmless) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const double bad[] = {0, -1, 1, 1e-30, 1e30, inf, -inf, nan};
  Pcg32 random(22);
  const auto any = [&] { return bad[random.below(std::size(bad))]; };
  for (std::size_t i = 0; i < n; ++i) {
    wi.set(i, {any(), any(), any()}), wo.set(i, {any(), any(), any()});
    if (i % 4 == 0) wi.set(i, {0, 0, 1});
    choice[i] = u[i] = float(random.below(2));
  }
  for (const Surface& c : surfaces()) {
    Arrays f, to;
    std::vector<float> pdf(n);
    c.batch.eval(wi, wo, f.out()), c.batch.pdf(wi, wo, pdf);
    for (std::size_t i = 0; i < n; ++i) {
      const bool nothing = f[i] == Vec3d{} && pdf[i] == 0;
      ASSERT_TRUE(nothing || (wi[i][2] > 0 && wo[i][2] > 0)) << c.name;
    }
    c.batch.sample(wo, choice, u, v, to.out(), f.out(), pdf);
    for (std::size_t i = 0; i < n; ++i) {
      const bool nothing = f[i] == Vec3d{} && pdf[i] == 0;
      ASSERT_TRUE(nothing || wo[i][2] > 0) << c.name;
    }
  }
}

/// Views from inside of glass, too, and total reflection among them.
TEST_F(BatchBsdfs, MirrorsAndGlassSampleAsBsdfInDouble) {
  for (std::size_t i = 0; i < n; i += 3) wo.set(i, -wo[i]);
  for (const auto& [kind, index] :
       {std::pair(SurfaceKind::mirror, 1.5), std::pair(SurfaceKind::glass, 1.5),
        std::pair(SurfaceKind::glass, 1.01), std::pair(SurfaceKind::glass, 0.6)}) {
    Material m;
    m.kind = kind, m.index = index, m.reflectance = {0.2f, 0.5f, 1};
    const BatchBsdf batch(m);
    const Bsdf<double> truth(m);
    Arrays to, weight, f;
    std::vector<float> pdf(n), none(n);
    batch.sample(wo, choice, u, v, to.out(), weight.out(), pdf);
    batch.eval(to, wo, f.out()), batch.pdf(to, wo, none);
    std::size_t refracted = 0, reflected = 0, total = 0, near_choice = 0;
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_TRUE(f[i] == Vec3d{} && none[i] == 0 && pdf[i] == 0) << i;
      const double eta = wo[i][2] >= 0 ? index : 1 / index, cosine = std::min(std::abs(wo[i][2]), 1.0);
      const double share = fresnel_dielectric(cosine, eta);
      if (kind == SurfaceKind::glass && std::abs(double(choice[i]) - share) < 1e-4) {
        ++near_choice;  // either will do
        continue;
      }
      const BsdfSample<double> s = truth.sample(wo[i], double(choice[i]), double(u[i]), double(v[i]));
      const Vec3d w = s.weight;
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(weight[i][k], w[k], relative * w[k]) << i;
      if (w == Vec3d{}) continue;  // a mirror from below
      // Where light leaves along the boundary its cosine is the root of a difference of rounded numbers.
      const double slack = 2e-6 + 1e-6 / std::max(std::abs(s.wi[2]), 1e-3);
      ASSERT_LE(geometry::distance(s.wi, to[i]), slack) << i;
      const bool through = s.wi[2] * wo[i][2] < 0;
      refracted += through, reflected += !through, total += share == 1;
    }
    EXPECT_LE(near_choice, n / 100);
    EXPECT_GT(reflected, n / 100);
    if (kind == SurfaceKind::mirror) continue;
    EXPECT_GT(refracted, n / 4);
    EXPECT_GT(total, n / 100);
  }
}

TEST_F(BatchBsdfs, WhatCannotBeAnsweredIsRefused) {
  Material m = test::ggx(0);
  EXPECT_THROW(BatchBsdf{m}, InvalidMaterial);
  const BatchBsdf bsdf{Material{}};
  Arrays f;
  std::vector<float> few(3);
  EXPECT_THROW(bsdf.eval(wi, Directions(few, few, few), f.out()), std::invalid_argument);
  EXPECT_THROW(bsdf.pdf(wi, wo, few), std::invalid_argument);
  EXPECT_THROW(bsdf.sample(wo, few, u, v, f.out(), f.out(), choice), std::invalid_argument);
}

}  // namespace
}  // namespace treeline::shading::brdf
