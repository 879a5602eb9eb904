#include "bench/region_average/block.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "bench/core/refusal.hpp"
#include "bench/core/tally.hpp"
#include "bench/region_average/figures.hpp"
#include "bench/region_average/truth.hpp"
#include "geometry/tolerances.hpp"
#include "shading/texture/summed_area.hpp"

namespace treeline::bench::region_average {
namespace {

namespace texture = shading::texture;

constexpr std::size_t asked_after_build = 256;

class AveragerSubject final : public Subject {
 public:
  AveragerSubject(const Method& method, const Input& input, const Knobs& knobs,
                  const std::vector<FootprintSet>& sets, bool must_answer)
      : image_(input.image), sets_(sets), first_look_up_(method.info.query_knobs.front()) {
    keep_refusal(must_answer, refusal_, [&] { averager_ = method.build(input, knobs); });
  }

  void run(std::size_t set, const Knobs& knobs, int threads) override {
    if (!averager_) return;
    if (sets_[set].rebuilds()) {
      if (knobs != first_look_up_)
        throw Unsupported("the build is the same for all look-ups: it is timed with the first");
      return averager_->rebuild(image_, threads);
    }
    ask(sets_[set].footprints, knobs, threads, means);
  }
  void ask(std::span<const Footprint> footprints, const Knobs& knobs, int threads,
           std::vector<float>& out) const {
    out.resize(footprints.size() * static_cast<std::size_t>(image_.channels));
    averager_->means(footprints, knobs, threads, out);
  }

  const Averager* averager() const { return averager_.get(); }
  const std::string& refusal() const { return refusal_; }
  std::vector<float> means;

 private:
  const Image& image_;
  const std::vector<FootprintSet>& sets_;
  const Knobs first_look_up_;
  std::unique_ptr<Averager> averager_;
  std::string refusal_;
};

TextureFacts facts_of(const Image& image) {
  TextureFacts f;
  f.levels = true, f.rows_and_columns = double(image.width) + image.height;
  double low = INFINITY, high = -INFINITY, sums[4] = {};
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    const float v = image.values[i];
    if (!std::isfinite(v)) {
      f.levels = false;
      continue;
    }
    f.levels = f.levels && v >= 0 && v <= 1 && std::floor(v * 65535 + 0.5f) / 65535 == v;
    low = std::min(low, double(v)), high = std::max(high, double(v));
    sums[i % static_cast<std::size_t>(image.channels)] += std::abs(double(v));
  }
  f.unit = low >= 0 && high <= 1;
  f.range = std::max(0.0, high - low), f.largest = std::max(std::abs(low), std::abs(high));
  f.absolute_sum = *std::ranges::max_element(sums);
  return f;
}

class TextureBlock final : public Block {
 public:
  TextureBlock(const std::vector<Method>& methods, BlockInput input)
      : methods_(methods), input_(std::move(input)), facts_(facts_of(image())), truths_(input_.sets.size()) {
    for (const FootprintSet& set : input_.sets)
      sets_.push_back({set.name, set.rebuilds() ? input_.dataset.size() : set.footprints.size()});
  }

  const std::vector<QuerySet>& query_sets() const override { return sets_; }
  std::size_t n() const override { return input_.dataset.size(); }
  std::uint64_t seed() const override { return input_.dataset.seed; }
  std::uint64_t dataset_hash() const override { return input_.dataset.hash(); }
  bool quick() const override { return input_.quick; }

  std::unique_ptr<Subject> build(std::size_t m, const Knobs& knobs, int threads) override {
    return std::make_unique<AveragerSubject>(methods_[m], Input{image(), threads}, knobs, input_.sets,
                                             input_.must_answer);
  }

  Errors check(std::size_t m, const Subject& subject, std::size_t set, const Knobs& knobs) override {
    const auto& answers = dynamic_cast<const AveragerSubject&>(subject);
    if (!answers.averager()) return refused_wrongly(answers.refusal());
    if (!input_.sets[set].rebuilds()) {
      Errors e =
          judge(methods_[m], answers.means, input_.sets[set].footprints, input_.sets[set].boxes, truth(set));
      if (input_.moments) variances(answers.means, truth(set), e);
      if (input_.independent && methods_[m].info.name == "sat_float") note_figure(input_.sets[set], e);
      e.extra.update(answers.averager()->facts());
      return e;
    }
    // What was built anew answers as before; its errors are other sets' matter.
    const auto asked =
        std::ranges::find_if(input_.sets, [](const FootprintSet& s) { return s.boxes && !s.rebuilds(); });
    if (asked == input_.sets.end()) return {};
    const std::span some =
        std::span(asked->footprints).first(std::min(asked_after_build, asked->footprints.size()));
    std::vector<float> means;
    answers.ask(some, knobs, 1, means);
    const Errors e =
        judge(methods_[m], means, some, true, truth(static_cast<std::size_t>(asked - input_.sets.begin())));
    Errors promise;
    promise.within_claim = e.within_claim, promise.reason = e.reason;
    return promise;
  }

 private:
  const Image& image() const { return input_.dataset.image; }
  std::size_t channels() const { return static_cast<std::size_t>(image().channels); }

  const std::vector<double>& truth(std::size_t set) {
    if (!truths_[set]) truths_[set] = true_means(image(), input_.sets[set].footprints, input_.threads);
    return *truths_[set];
  }

  /// Beside float's last digit.
  double allowed(const Method& m, const Footprint& f) const {
    if (!m.allowed) return 0;
    const texture::Box b = texture::bounding_box(f);
    const auto weight = [](const texture::TexelRuns& r) { return r.weight[0] + r.weight[1] + r.weight[2]; };
    const double entries = weight(texture::texel_runs(b.x0, b.x1, image().width)) *
                           weight(texture::texel_runs(b.y0, b.y1, image().height));
    return m.allowed(facts_, entries);
  }

  Errors judge(const Method& m, const std::vector<float>& means, std::span<const Footprint> asked, bool boxes,
               const std::vector<double>& truth) const {
    Errors e;
    const bool promised =
        (m.info.claim == Claim::exact || m.info.claim == Claim::bounded) && (boxes || !m.boxes_only);
    const double scale = facts_.range > 0 ? facts_.range : facts_.largest > 0 ? facts_.largest : 1;
    ErrorTally tally;
    double squares = 0, squares_last = 0;
    std::size_t last = 0;
    for (std::size_t i = 0; i < asked.size(); ++i)
      for (std::size_t c = 0; c < channels(); ++c) {
        const double t = truth[i * channels() + c], answer = double(means[i * channels() + c]);
        if (!std::isfinite(t)) continue;  // no mean to be right about
        const double off = (answer - t) / scale;
        if (!std::isfinite(off)) {
          broken(e, place(asked[i]) + " is answered by no finite number");
          continue;
        }
        tally.add(std::abs(off), off);
        squares += off * off;
        if (asked[i].x > 0.5 * image().width && asked[i].y > 0.5 * image().height)
          squares_last += off * off, ++last;
        const double ulp = 2 * double(geometry::tolerance::unit_roundoff<float>) *
                           std::max(std::abs(t), double(std::numeric_limits<float>::min()));
        if (promised && std::abs(answer - t) > ulp + allowed(m, asked[i]))
          broken(e,
                 place(asked[i]) + " has the mean " + std::to_string(t) + ", told " + std::to_string(answer));
      }
    const std::size_t judged = tally.errors.size();
    tally.write(e);
    if (judged == 0) return e;
    e.error = std::sqrt(squares / double(judged));
    e.floor =
        double(geometry::tolerance::unit_roundoff<float>) * facts_.largest / scale;  // of the answers: floats
    if (last > 0) e.extra["region_average_last_quarter"] = std::sqrt(squares_last / double(last));
    e.extra["region_average_mean"] = facts_.absolute_sum / double(n());
    return e;
  }

  /// Of z from the means of z and z²: what cancellation leaves of it.
  static void variances(const std::vector<float>& means, const std::vector<double>& truth, Errors& e) {
    double worst = 0;
    std::size_t negative = 0;
    for (std::size_t i = 0; i + 1 < truth.size(); i += 2) {
      const double is = truth[i + 1] - truth[i] * truth[i];
      const double told = double(means[i + 1]) - double(means[i]) * double(means[i]);
      worst = std::max(worst, std::abs(told - is)), negative += told < 0;
    }
    e.extra["region_average_variance_error"] = worst;
    e.extra["region_average_negative_variances"] = double(negative) / (0.5 * double(truth.size()));
  }

  void note_figure(const FootprintSet& set, Errors& e) const {
    const double scale = facts_.range > 0 ? facts_.range : 1;
    const auto figure = rounding_of_sums(set.footprints, facts_.absolute_sum / double(n()));
    if (!figure) return;
    e.extra["region_average_figure"] = "error";
    e.extra["region_average_figure_value"] = figure->value / scale;
    e.extra["region_average_figure_slack"] = figure->slack / scale;
  }

  static std::string place(const Footprint& f) {
    const texture::Box b = texture::bounding_box(f);
    return "[" + std::to_string(b.x0) + ", " + std::to_string(b.x1) + "] x [" + std::to_string(b.y0) + ", " +
           std::to_string(b.y1) + "]";
  }
  static void broken(Errors& e, std::string reason) {
    if (e.within_claim) e.reason = std::move(reason);
    e.within_claim = false;
  }

  const std::vector<Method>& methods_;
  const BlockInput input_;
  const TextureFacts facts_;
  std::vector<QuerySet> sets_;
  std::vector<std::optional<std::vector<double>>> truths_;
};

}  // namespace

std::unique_ptr<Block> open_block(const std::vector<Method>& methods, BlockInput input) {
  const Image& image = input.dataset.image;
  if (image.width < 1 || image.height < 1 || image.channels < 1 || image.channels > 4)
    throw std::invalid_argument("the texture has " + std::to_string(image.width) + " x " +
                                std::to_string(image.height) + " texels of " +
                                std::to_string(image.channels) + " channels; it needs texels, of 1 to 4");
  return std::make_unique<TextureBlock>(methods, std::move(input));
}

}  // namespace treeline::bench::region_average
