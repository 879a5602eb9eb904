// Averages over samples: of all directions alike, by the cosine, by facets, by facets that are seen, by the
// light, and by facets and light together, each weighed by the power heuristic (Veach and Guibas 1995). With
// points of every kind of geometry/point_sets.hpp.
#include <cmath>

#include "bench/brdf_integral/method.hpp"
#include "bench/brdf_integral/share.hpp"
#include "bench/core/registry.hpp"
#include "geometry/point_sets.hpp"
#include "geometry/sampling.hpp"
#include "shading/brdf/bsdf.hpp"

namespace treeline::bench::brdf_integral {
namespace {

namespace brdf = shading::brdf;
using geometry::PointSet, geometry::Vec2f, geometry::Vec3f;

enum class Way { uniform, cosine, facets, heitz_2018, caps, own, light, together };

constexpr std::uint64_t choice_stream = 0xc401ce, average_stream = 0xa7e4a6e;

/// Adds contributions up: for an answer.
struct Sum {
  Vec3d sum{};
  void operator()(const Vec3f& c) { sum += Vec3d(c); }
};
/// For what is told of their spread.
struct Spread {
  Moments moments;
  void operator()(const Vec3f& c) { moments.add(double(c[0]) + double(c[1]) + double(c[2])); }
};

class Estimator {
 public:
  explicit Estimator(const Material& m)
      : material_(m),
        bsdf_(m),
        ggx_{float(m.alpha_x), float(m.alpha_y)},
        beckmann_{float(m.alpha_x), float(m.alpha_y)} {
    if (bsdf_.delta())
      throw std::invalid_argument("a mirror's reflection is no function that could be integrated");
  }

  /// One contribution a point; of `together` the light's and the facets' in one.
  template <Way way, class Sink>
  void estimate(const Vec3f& wo, const Sky& sky, std::span<const Vec2f> points, std::uint64_t seed,
                Sink& sink) const {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float u = points[i][0], v = points[i][1];
      if constexpr (way == Way::together) {
        sink(by_light(wo, sky, u, v, true) + by_own(wo, sky, choice(seed, i), u, v, true));
      } else if constexpr (way == Way::light) {
        sink(by_light(wo, sky, u, v, false));
      } else if constexpr (way == Way::own) {
        sink(by_own(wo, sky, choice(seed, i), u, v, false));
      } else {
        float pdf = 0;
        const Vec3f wi = direction<way>(wo, u, v, pdf);
        sink(wi[2] > 0 && pdf > 0 ? bsdf_.eval(wi, wo) * (wi[2] * light_of(sky, wi) / pdf) : Vec3f{});
      }
    }
  }

  bool microfacets() const { return material_.kind == shading::SurfaceKind::microfacet; }

 private:
  static float light_of(const Sky& sky, const Vec3f& w) {
    return static_cast<float>(sky(geometry::Vec3d(w)));
  }
  static float choice(std::uint64_t seed, std::size_t i) {
    return geometry::uniform_at<float>(seed ^ choice_stream, i);
  }
  /// Of the power heuristic, from the ratio of densities alone: their squares may be beyond a float.
  static float share(float pdf, float other) {
    const float r = other / pdf;
    return 1 / (1 + r * r);
  }

  template <Way way>
  Vec3f direction(const Vec3f& wo, float u, float v, float& pdf) const {
    constexpr float pi = std::numbers::pi_v<float>;
    if constexpr (way == Way::uniform) {
      pdf = 0.5f / pi;
      return geometry::sample_hemisphere(u, v);
    } else if constexpr (way == Way::cosine) {
      const Vec3f wi = geometry::sample_hemisphere_cosine(u, v);
      pdf = wi[2] / pi;
      return wi;
    } else {
      const bool ggx = material_.distribution == shading::Distribution::ggx;
      const Vec3f h = ggx ? facet<way>(ggx_, wo, u, v) : facet<way>(beckmann_, wo, u, v);
      const Vec3f wi = brdf::reflected(wo, h);
      const float d = ggx ? ggx_.d(h) : beckmann_.d(h);
      if constexpr (way == Way::facets)
        pdf = d * h[2] / (4 * dot(wo, h));
      else
        pdf = d / (4 * (ggx ? ggx_.projected_area(wo) : beckmann_.projected_area(wo)));
      return wi;
    }
  }
  template <Way way>
  static Vec3f facet(const brdf::Ggx<float>& d, const Vec3f& wo, float u, float v) {
    if constexpr (way == Way::facets) return d.sample_normal(u, v);
    if constexpr (way == Way::heitz_2018) return brdf::sample_visible_heitz_2018(d, wo, u, v);
    return brdf::sample_visible_caps(d, wo, u, v);
  }
  template <Way way>
  static Vec3f facet(const brdf::Beckmann<float>& d, const Vec3f& wo, float u, float v) {
    if constexpr (way == Way::facets) return d.sample_normal(u, v);
    return brdf::sample_visible(d, wo, u, v);
  }

  Vec3f by_own(const Vec3f& wo, const Sky& sky, float choice, float u, float v, bool shared) const {
    const brdf::BsdfSample<float> s = bsdf_.sample(wo, choice, u, v);
    if (!(s.wi[2] > 0)) return {};
    const float light = light_of(sky, s.wi);
    if (light == 0) return {};
    return s.weight * (shared ? light * share(s.pdf, light_pdf(sky)) : light);
  }
  static float light_pdf(const Sky& sky) { return static_cast<float>(1 / sky.solid_angle()); }
  Vec3f by_light(const Vec3f& wo, const Sky& sky, float u, float v, bool shared) const {
    const geometry::Frame<float> frame{Vec3f(sky.axis)};
    const auto height = static_cast<float>(1 - sky.cosine) * u;  // 1 less the cosine
    const float sine = std::sqrt(height * (2 - height)), turn = 2 * std::numbers::pi_v<float> * v;
    const Vec3f wi = frame({sine * std::cos(turn), sine * std::sin(turn), 1 - height});
    if (!(wi[2] > 0)) return {};
    const float pdf = light_pdf(sky);
    const Vec3f f = bsdf_.eval(wi, wo) * (wi[2] * static_cast<float>(sky.radiance) / pdf);
    return shared ? f * share(pdf, bsdf_.pdf(wi, wo)) : f;
  }

  Material material_;
  brdf::Bsdf<float> bsdf_;
  brdf::Ggx<float> ggx_;
  brdf::Beckmann<float> beckmann_;
};

PointSet point_set(const std::string& name) {
  for (const PointSet set : geometry::point_sets)
    if (name == geometry::name_of(set)) return set;
  throw std::invalid_argument("no points are called '" + name + "'");
}

template <Way way>
class MonteCarlo final : public Answerer {
 public:
  explicit MonteCarlo(const Input& input) : estimator_(input.material), seed_(input.seed) {}

  void answer(const Set& set, const Knobs& knobs, int threads, std::span<float> out) override {
    check(set);
    const std::size_t queries = set.queries();
    each<Sum>(set, knobs, threads, queries, [&](std::size_t q, const Sum& s, double n) {
      for (int c = 0; c < 3; ++c) out[3 * q + std::size_t(c)] = static_cast<float>(s.sum[c] / n);
    });
  }

  std::vector<Moments> moments(const Set& set, const Knobs& knobs) override {
    std::vector<Moments> all(set.queries() / set.repeats);
    each<Spread>(set, knobs, 1, set.queries(), [&](std::size_t q, const Spread& s, double) {
      Moments& m = all[q / set.repeats];
      m.n += s.moments.n, m.sum += s.moments.sum, m.sum2 += s.moments.sum2, m.sum3 += s.moments.sum3;
      m.sum4 += s.moments.sum4, m.largest = std::max(m.largest, s.moments.largest);
    });
    return all;
  }

 private:
  void check(const Set& set) const {
    if ((way == Way::light || way == Way::together) && set.sky.kind != SkyKind::cap)
      throw Unsupported("there is no light to aim at: the sky is all around");
    if (way != Way::uniform && way != Way::cosine && way != Way::own && way != Way::light &&
        !estimator_.microfacets())
      throw Unsupported("the surface has no facets");
  }

  template <class Sink, class Finish>
  void each(const Set& set, const Knobs& knobs, int threads, std::size_t queries,
            const Finish& finish) const {
    const PointSet points = point_set(knobs.at("points").get<std::string>());
    // Of `together` every point is one of the light and one of the facets.
    const auto samples = knobs.at("samples").get<std::size_t>() / (way == Way::together ? 2 : 1);
    share(queries, threads, [&](std::size_t q) {
      thread_local std::vector<Vec2f> square, viewers;
      square.resize(samples);
      const std::uint64_t seed = geometry::hash_u64(seed_, geometry::hash_u64(q, samples));
      geometry::fill_points<float>(points, seed, square);
      Sink sink;
      if (set.averages == 0) {
        estimator_.template estimate<way>(Vec3f(set.views[q]), set.sky, square, seed, sink);
      } else {
        // A viewer for every direction, from points of their own, in an order of their own.
        viewers.resize(samples);
        geometry::fill_points<float>(points, seed ^ average_stream, viewers);
        for (std::size_t i = 0; i + 1 < samples; ++i)
          std::swap(viewers[i], viewers[i + geometry::hash_u64(seed, i) % (samples - i)]);
        for (std::size_t i = 0; i < samples; ++i) {
          const Vec3f wo = geometry::sample_hemisphere_cosine(viewers[i][0], viewers[i][1]);
          if (wo[2] > 0)
            estimator_.template estimate<way>(wo, set.sky, std::span(square).subspan(i, 1), seed + i, sink);
        }
      }
      finish(q, sink, double(samples));
    });
  }

  Estimator estimator_;
  std::uint64_t seed_;
};

/// Every kind of points, or only the worst and the best.
std::vector<Knobs> knobs(bool every) {
  std::vector<Knobs> all;
  for (const PointSet set : geometry::point_sets) {
    if (!every && set != PointSet::random && set != PointSet::sobol_owen) continue;
    for (const int samples : {16, 128, 1024})
      all.push_back({{"points", geometry::name_of(set)}, {"samples", samples}});
  }
  return all;
}

template <Way way>
bool add(const char* name, int ladder, bool every = false) {
  return Registry<Method>::instance().add(
      {.info = {.name = name,
                .family = "samples",
                .claim = Claim::stochastic,
                .query_knobs = knobs(every),
                .ladder = ladder,
                .scales = false},
       .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Answerer> {
         return std::make_unique<MonteCarlo<way>>(input);
       }});
}

[[maybe_unused]] const bool registered =
    add<Way::uniform>("uniform", 1) && add<Way::cosine>("cosine", 2) && add<Way::facets>("facets", 3) &&
    add<Way::heitz_2018>("visible_2018", 4) && add<Way::caps>("visible_caps", 4) &&
    add<Way::own>("own", 5, true) && add<Way::light>("light", 6) && add<Way::together>("mis", 7);

}  // namespace
}  // namespace treeline::bench::brdf_integral
