#include "bench/brdf_integral/block.hpp"

#include <cmath>

#include "bench/brdf_integral/bounce_walk.hpp"
#include "bench/brdf_integral/judge.hpp"
#include "bench/brdf_integral/reference.hpp"
#include "bench/brdf_integral/shape_truth.hpp"
#include "bench/brdf_integral/share.hpp"
#include "bench/core/refusal.hpp"
#include "shading/brdf/bsdf.hpp"

namespace treeline::bench::brdf_integral {
namespace {

// Of methods whose spread is looked into: it takes as long as an answer, and of fewer samples rare ones are
// missing from the spread as from the mean.
constexpr int least_samples = 1024;

/// One method over the block's surface, with its answers to the last set.
class Asked final : public Subject {
 public:
  Asked(const Method& method, const Input& input, const Knobs& knobs, const std::vector<Set>& sets,
        bool must_answer)
      : sets_(sets) {
    keep_refusal(must_answer, refusal, [&] { answerer = method.build(input, knobs); });
  }

  void run(std::size_t set, const Knobs& knobs, int threads) override {
    if (!answerer) return;
    answers.resize(sets_[set].queries() * sets_[set].channels);
    answerer->answer(sets_[set], knobs, threads, answers);
  }

  std::unique_ptr<Answerer> answerer;
  std::vector<float> answers;
  std::string refusal;

 private:
  const std::vector<Set>& sets_;
};

/// Of every entry of `evaluate`: what textbooks say in double, or shading/brdf where they say nothing.
std::vector<double> values_of(const Material& m, const Set& set) {
  std::vector<double> values;
  const shading::brdf::Bsdf<double> bsdf(m);
  for (std::size_t i = 0; i < set.wo.x.size(); ++i) {
    const auto at = [&](const Directions& d) {
      return normalized(Vec3d{double(d.x[i]), double(d.y[i]), double(d.z[i])});
    };
    values.push_back(m.compensation == shading::Compensation::none
                         ? reference::brdf(m, at(set.wi), at(set.wo))[1]
                         : bsdf.eval(at(set.wi), at(set.wo))[1]);
  }
  return values;
}

class SurfaceBlock final : public Block {
 public:
  SurfaceBlock(const std::vector<Method>& methods, BlockInput input)
      : methods_(methods), input_(std::move(input)), truths_(input_.sets.size()) {
    for (const Set& set : input_.sets) query_sets_.push_back({set.name, set.queries()});
    // Each method of a hard case runs in a child, which would look for the truth again.
    if (input_.hard && input_.must_answer)
      for (std::size_t i = 0; i < input_.sets.size(); ++i) truth_of(i);
  }

  const std::vector<QuerySet>& query_sets() const override { return query_sets_; }
  std::size_t n() const override { return input_.n; }
  std::uint64_t seed() const override { return input_.seed; }
  std::uint64_t dataset_hash() const override { return input_.dataset.hash(); }
  bool quick() const override { return input_.quick; }
  bool offers(std::size_t m) const override { return methods_[m].asks == input_.asks; }

  std::unique_ptr<Subject> build(std::size_t m, const Knobs& knobs, int threads) override {
    return std::make_unique<Asked>(methods_[m], Input{material(), threads, input_.seed}, knobs, input_.sets,
                                   input_.must_answer);
  }

  Errors check(std::size_t m, const Subject& subject, std::size_t set_number, const Knobs& knobs) override {
    const auto& asked = dynamic_cast<const Asked&>(subject);
    if (!asked.answerer) return refused_wrongly(asked.refusal);
    const Set& set = input_.sets[set_number];
    const Truth& truth = truth_of(set_number);
    switch (input_.asks) {
      case Asks::integrals:
        return check_integrals(methods_[m], asked, set, truth, knobs);
      case Asks::kernels:
        return check_kernels(methods_[m], asked, set, truth, knobs);
      case Asks::solid_angles:
        return promised(methods_[m], judge_numbers(asked.answers, truth, true));
      case Asks::fresnel:
      case Asks::furnace:
        break;
    }
    return promised(methods_[m], judge_numbers(asked.answers, truth, false));
  }

 private:
  const Material& material() const { return input_.dataset.material; }

  Errors check_integrals(const Method& method, const Asked& asked, const Set& set, const Truth& truth,
                         const Knobs& knobs) {
    Errors e = judge_integrals(set, asked.answers, truth);
    const bool looked_into = knobs.contains("samples") && knobs["samples"] >= least_samples;
    if (method.info.claim == Claim::stochastic && looked_into && set.repeats > 1 && e.within_claim)
      judge_spread(set, asked.answers, truth, asked.answerer->moments(set, knobs), e);
    if (set.name == "albedo" && method.info.claim != Claim::stochastic && !input_.hard) {
      for (std::size_t k = 0; k < tails().values.size(); ++k)
        e.extra["brdf_integral_beyond_" + std::to_string(10 * (k + 1))] = tails().values[k];
      note_linearity(*asked.answerer, set, knobs, asked.answers, e);
    }
    return e;
  }

  /// brdf_integral_linearity: how far the answer under two skies at once is from the sum of the answers under
  /// each, relatively; of methods that answer both.
  static void note_linearity(Answerer& method, const Set& set, const Knobs& knobs,
                             std::span<const float> first, Errors& e) {
    Set cosine = set, both = set;
    cosine.sky.kind = SkyKind::cosine, both.sky.kind = SkyKind::both;
    std::vector<float> second(first.size()), together(first.size());
    try {
      method.answer(cosine, knobs, 1, second), method.answer(both, knobs, 1, together);
    } catch (const Unsupported&) {
      return;
    }
    double most = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      const double sum = double(first[i]) + double(second[i]);
      if (sum > 0) most = std::max(most, std::abs(double(together[i]) / sum - 1));
    }
    e.extra["brdf_integral_linearity"] = most;
  }

  Errors check_kernels(const Method& method, const Asked& asked, const Set& set, const Truth& truth,
                       const Knobs& knobs) {
    if (!set.samples) {
      Errors e = judge_values(asked.answers, truth.values);
      judge_laws(*asked.answerer, set, knobs, asked.answers, e);
      return promised(method, std::move(e));
    }
    // Samples of one viewer each: their mean weight is the mean of what the viewers see.
    Errors e;
    const double n = double(asked.answers.size());
    double sum = 0, squares = 0;
    for (const float w : asked.answers) sum += double(w), squares += double(w) * double(w);
    const double mean = sum / n, error = std::sqrt(std::max(squares / n - mean * mean, 1e-12) / n);
    e.bias = mean - truth.values[0], e.error = std::abs(*e.bias);
    e.floor = error;  // of the mean
    e.extra["brdf_integral_z"] = *e.bias / error;
    if (!(std::abs(*e.bias) <= most_z * error)) {
      e.within_claim = false;
      e.reason = "the mean weight is " + std::to_string(mean) + ", not " + std::to_string(truth.values[0]);
    }
    return e;
  }

  /// Of methods that promise something.
  static Errors promised(const Method& method, Errors e) {
    if (method.allowed > 0 && e.max && !(*e.max <= method.allowed)) {
      if (e.within_claim) e.reason = "off by " + std::to_string(*e.max);
      e.within_claim = false;
    }
    return e;
  }

  const Truth& truth_of(std::size_t number) {
    std::optional<Truth>& known = truths_[number];
    if (known) return *known;
    const Set& set = input_.sets[number];
    Truth t;
    switch (input_.asks) {
      case Asks::integrals:
        t = surface_truth(material(), set, input_.threads);
        break;
      case Asks::kernels:
        t = set.samples ? mean_albedo(set) : Truth{values_of(material(), set), 0};
        break;
      case Asks::furnace:
        t = furnace(set);
        break;
      case Asks::fresnel:
        for (const double c : set.cosines) {
          const double is = reference::fresnel(c, set.medium.index, set.medium.extinction);
          const double ours =
              set.medium.extinction == 0
                  ? shading::brdf::fresnel_dielectric(c, set.medium.index)
                  : shading::brdf::fresnel_conductor(c, set.medium.index, set.medium.extinction);
          t.values.push_back(is), t.floor = std::max(t.floor, std::abs(is - ours));
        }
        break;
      case Asks::solid_angles:
        for (const Shape& s : set.shapes) {
          const SolidAngle a = solid_angle_truth(s);
          t.values.push_back(a.value), t.floor = std::max(t.floor, a.apart);
        }
        break;
    }
    known = std::move(t);
    return *known;
  }

  /// Of the viewers of `sample`, who are few.
  Truth mean_albedo(const Set& set) {
    Set albedo;
    for (std::size_t i = 0; i < std::min(set.wo.x.size(), kernel_viewers); ++i)
      albedo.views.push_back(
          normalized(Vec3d{double(set.wo.x[i]), double(set.wo.y[i]), double(set.wo.z[i])}));
    const Truth each = surface_truth(material(), albedo, input_.threads);
    double sum = 0;
    for (std::size_t i = 1; i < each.values.size(); i += 3) sum += each.values[i];
    return {{sum / double(albedo.views.size())}, each.floor};
  }

  /// Facets that reflect all lose nothing, whatever the light does between them.
  Truth furnace(const Set& set) {
    if (set.reflectance == 1) return {{1.0}, 0};
    const auto fresnel = [&](double cosine) { return reference::schlick(cosine, set.reflectance); };
    const Walked w = bounce_walk(set.alpha, fresnel, input_.walks, input_.seed, input_.threads);
    return {{w.albedo}, 3 * w.standard_error};
  }

  const Truth& tails() {
    if (!tails_) tails_ = tail_shares(material());
    return *tails_;
  }

  const std::vector<Method>& methods_;
  const BlockInput input_;
  std::vector<QuerySet> query_sets_;
  std::vector<std::optional<Truth>> truths_;
  std::optional<Truth> tails_;
};

}  // namespace

std::unique_ptr<Block> open_block(const std::vector<Method>& methods, BlockInput input) {
  return std::make_unique<SurfaceBlock>(methods, std::move(input));
}

}  // namespace treeline::bench::brdf_integral
