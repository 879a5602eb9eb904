#include "bench/shadow/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/core/refusal.hpp"
#include "bench/core/truth_cache.hpp"
#include "bench/shadow/figures.hpp"
#include "bench/shadow/judge.hpp"
#include "bench/shadow/lights.hpp"
#include "bench/shadow/split.hpp"
#include "shading/shadow/light_view.hpp"

namespace treeline::bench::shadow {
namespace {

constexpr std::size_t most_moving = 4096;       // receivers of the set `motion`
constexpr double texel_of_motion = 0.1 / 1024;  // of the light's view
constexpr double forgiven = 1e-4;  // of the diagonal: so near to a hard shadow's border nobody is wrong

std::vector<Receiver> on_line(const datasets::ReceiverLine& line) {
  std::vector<Receiver> out;
  for (std::size_t i = 0; i < line.count; ++i) {
    const double t = double(i) / double(std::max<std::size_t>(line.count, 2) - 1);
    out.push_back({line.from + (line.to - line.from) * t, line.normal});
  }
  return out;
}

geometry::Box3d box_of(const shading::Scene& scene) {
  const auto box = scene.mesh.box();
  return {geometry::Vec3d(box.low), geometry::Vec3d(box.high)};
}

}  // namespace

struct ShadowBlock::Set {
  What what;
  std::vector<Receiver> receivers;
  std::vector<std::uint32_t> pixel;  // of the set `image`
  std::vector<Truth> truth;          // one a frame; empty: not yet known
  const datasets::ReceiverLine* line = nullptr;
};

namespace {

/// One built method, or one a frame.
class Made final : public Subject {
 public:
  struct Question {
    std::span<const Receiver> receivers;
    bool moving = false;
  };

  Made(const Method& method, const Input& input, const Knobs& knobs, std::vector<Question> questions,
       const std::vector<shading::Scene>& frames, bool must_answer)
      : method_(method), input_(input), knobs_(knobs), questions_(std::move(questions)), frames_(frames) {
    keep_refusal(must_answer, refusal, [&] { still_ = method.build(input, knobs); });
  }

  /// Maps of the frames are not part of what is timed: a frame's build is that of the row.
  void prepare(std::size_t set, int threads) override {
    if (!questions_[set].moving || !moving_.empty() || !still_) return;
    for (const shading::Scene& scene : frames_)
      moving_.push_back(method_.build(Input{scene, input_.receivers, threads}, knobs_));
  }
  void run(std::size_t set, const Knobs& knobs, int threads) override {
    if (!still_) return;
    const auto receivers = questions_[set].receivers;
    const std::size_t n = receivers.size();
    if (!questions_[set].moving) {
      answers.resize(n);
      still_->visibility(receivers, knobs, threads, answers);
      return;
    }
    answers.resize(n * frames_.size());
    for (std::size_t f = 0; f < frames_.size(); ++f)
      moving_[f]->visibility(receivers, knobs, threads, std::span(answers).subspan(f * n, n));
  }

  Knobs facts() const { return still_ ? still_->facts() : Knobs::object(); }
  const Knobs& build_knobs() const { return knobs_; }

  std::vector<float> answers;
  std::string refusal;

 private:
  const Method& method_;
  Input input_;
  Knobs knobs_;
  std::vector<Question> questions_;
  const std::vector<shading::Scene>& frames_;
  std::unique_ptr<ShadowSubject> still_;
  std::vector<std::unique_ptr<ShadowSubject>> moving_;
};

Knobs number(std::optional<double> x) { return x ? Knobs(*x) : Knobs(nullptr); }

/// How wide the answers' penumbra is, in lengths of the scene.
void note_width(std::span<const float> answers, std::span<const double> truth, double line, Knobs& extra) {
  const std::vector<float> exact(truth.begin(), truth.end());
  const auto width = [&](std::span<const float> a) -> std::optional<double> {
    const auto low = crossing(a, 0.1), high = crossing(a, 0.9);
    if (!low || !high) return std::nullopt;
    return (*high - *low) * line;
  };
  const auto told = width(answers), is = width(exact);
  extra["shadow_width"] = number(told), extra["shadow_width_true"] = number(is);
  extra["shadow_width_error"] = told && is && *is > 0 ? Knobs(*told / *is - 1) : Knobs(nullptr);
}

/// How much of the shadow at a blocker's foot is lost: the length that is lit without a break, in lengths of
/// the scene and in texels.
void note_gap(std::span<const float> answers, double line, double texel, Knobs& extra) {
  std::size_t lit = 0;
  while (lit < answers.size() && answers[lit] > 0.5f) ++lit;
  const double gap = line * double(lit) / double(std::max<std::size_t>(answers.size(), 2) - 1);
  extra["shadow_gap"] = gap;
  extra["shadow_gap_texels"] = texel > 0 ? Knobs(gap / texel) : Knobs(nullptr);
}

}  // namespace

std::optional<double> crossing(std::span<const float> a, double share) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (double(a[i]) < share) continue;
    const auto last = double(std::max<std::size_t>(a.size(), 2) - 1);
    if (i == 0) return 0;
    return (double(i - 1) + (share - double(a[i - 1])) / (double(a[i]) - double(a[i - 1]))) / last;
  }
  return std::nullopt;
}

shading::Light moved(const shading::Scene& scene, int frame) {
  shading::Light light = scene.light;
  const auto view = shading::shadow::fit_view(
      light, geometry::Box3d{geometry::Vec3d(scene.mesh.box().low), geometry::Vec3d(scene.mesh.box().high)});
  const double middle = 0.5 * (view.near + view.far);
  const double step = frame * texel_of_motion * 2 * view.half_width * (view.perspective ? middle : 1);
  // Askew to the map's axes, or edges along them would all jump in one frame.
  const geometry::Vec3d way = normalized(view.right * 0.8 + view.down * 0.6);
  if (light.kind == LightKind::directional)
    light.direction = normalized(light.direction + way * (step / std::max(view.far - view.near, 1e-9)));
  else
    light.position += way * step;
  return light;
}

ShadowBlock::ShadowBlock(const std::vector<Method>& methods, BlockInput input)
    : methods_(methods),
      input_(std::move(input)),
      tree_([&] {
        Tree::Options options;
        options.non_finite = accel::NonFinite::drop;
        return Tree(input_.scene.mesh, options);
      }()),
      image_(receivers_of(input_.scene, tree_, input_.threads)) {
  const auto add = [&](std::string name, Set set, std::size_t frames = 1) {
    query_sets_.push_back({std::move(name), set.receivers.size() * frames});
    sets_.push_back(std::move(set));
  };
  add("image", {What::image, image_.list, image_.pixel, {}, nullptr});
  for (const auto& line : input_.lines) add(line.name, {What::line, on_line(line), {}, {}, &line});
  for (const Set& set : sets_) asked_.insert(asked_.end(), set.receivers.begin(), set.receivers.end());
  if (input_.frames > 1) {
    for (int f = 0; f < input_.frames; ++f) {
      frames_.push_back(input_.scene);
      frames_.back().light = moved(input_.scene, f);
    }
    Set set{What::motion, {}, {}, {}, nullptr};
    // Where the light's border moves, if that is known.
    const auto& from = sets_.size() > 1 ? sets_[1].receivers : image_.list;
    const std::size_t stride = from.size() / (most_moving + 1) + 1;
    for (std::size_t i = 0; i < from.size(); i += stride) set.receivers.push_back(from[i]);
    add("motion", std::move(set), frames_.size());
  }
}
ShadowBlock::~ShadowBlock() = default;

std::unique_ptr<Subject> ShadowBlock::build(std::size_t m, const Knobs& knobs, int threads) {
  std::vector<Made::Question> questions;
  for (const Set& set : sets_) questions.push_back({set.receivers, set.what == What::motion});
  return std::make_unique<Made>(methods_[m], Input{input_.scene, asked_, threads}, knobs,
                                std::move(questions), frames_, input_.must_answer);
}

std::span<const float> ShadowBlock::answers(const Subject& subject) {
  return dynamic_cast<const Made&>(subject).answers;
}

bool ShadowBlock::offers(std::size_t m) const {
  const auto& only = input_.only;
  return only.empty() || std::ranges::find(only, methods_[m].info.name) != only.end();
}

void ShadowBlock::find_truth() {
  for (std::size_t set = 0; set < sets_.size(); ++set) truth_of(set);
  split();
}

/// Fields of the row: what a diffuse surface is off by, and a GGX one of each roughness.
const Knobs& ShadowBlock::split() {
  if (split_) return *split_;
  const auto off = split_errors(input_.scene, tree_, image_.list, truth(0), {}, input_.threads);
  split_.emplace();
  for (std::size_t k = 0; k < off.size(); ++k)
    (*split_)[std::isinf(split_roughness[k]) ? "shadow_split"
                                             : fmt::format("shadow_split_ggx_{:g}", split_roughness[k])] =
        off[k];
  return *split_;
}

/// From the cache: the halves' difference and the samples stand behind the shares.
Truth ShadowBlock::find(const Set& set, const shading::Scene& scene) const {
  Truth truth;
  if (input_.closed_form) {
    for (const Receiver& r : set.receivers) truth.visibility.push_back(input_.closed_form(scene.light, r));
    truth.closed_form = true;
    return truth;
  }
  const TruthKey key{"shadow", input_.version, input_.dataset_hash,
                     truth_hash(scene, set.receivers, input_.truth)};
  if (auto cached = load_truth_as<double>(input_.truth_cache, key);
      cached && cached->size() == set.receivers.size() + 2) {
    truth.samples = cached->back(), cached->pop_back();
    truth.halves = cached->back(), cached->pop_back();
    truth.visibility = std::move(*cached);
    return truth;
  }
  truth = traced_truth(scene, tree_, set.receivers, set.pixel, set.what == What::image ? image_.width : 0,
                       input_.truth, input_.threads);
  std::vector<double> kept = truth.visibility;
  kept.push_back(truth.halves), kept.push_back(truth.samples);
  store_truth(input_.truth_cache, key, kept);
  return truth;
}

const std::vector<Truth>& ShadowBlock::truth_of(std::size_t query_set) {
  Set& set = sets_[query_set];
  if (!set.truth.empty()) return set.truth;
  if (set.what == What::motion)
    for (const shading::Scene& scene : frames_) set.truth.push_back(find(set, scene));
  else
    set.truth.push_back(find(set, input_.scene));
  return set.truth;
}

Errors ShadowBlock::check(std::size_t m, const Subject& subject, std::size_t query_set,
                          const Knobs& query_knobs) {
  const auto& made = dynamic_cast<const Made&>(subject);
  if (!made.refusal.empty()) return refused_wrongly(made.refusal);
  const Set& set = sets_[query_set];
  const auto& truths = truth_of(query_set);
  if (set.what == What::motion) return check_motion(made.answers, truths);
  const Truth& truth = truths.front();
  Errors e = judged(made.answers, truth.visibility, truth.halves);
  e.extra["shadow_truth_samples"] = truth.samples;
  const Claim claim = methods_[m].info.claim;
  if (e.within_claim && is_hard(input_.scene.light) && (claim == Claim::exact || claim == Claim::bounded))
    if (const auto i = false_without_reason(made.answers, set, truth)) {
      e.within_claim = false;
      e.reason = "receiver " + std::to_string(*i) + " is answered " + std::to_string(made.answers[*i]) +
                 ", true is " + std::to_string(truth.visibility[*i]) + " there and all around it";
    }
  if (set.what == What::image) e.extra.update(split());
  if (set.line) note_line(*set.line, made, truth, e.extra);
  if (const auto figure = figure_of(input_.scene, query_sets_[query_set].name, set.receivers,
                                    methods_[m].info.name, made.build_knobs(), query_knobs)) {
    e.extra["shadow_figure"] = figure->field, e.extra["shadow_figure_value"] = figure->value;
    e.extra["shadow_figure_bias"] = number(figure->bias);
    e.extra["shadow_figure_slack"] = figure->slack;
  }
  e.extra.update(made.facts());
  return e;
}

void ShadowBlock::note_line(const datasets::ReceiverLine& line, const Subject& subject, const Truth& truth,
                            Knobs& extra) const {
  const auto& made = dynamic_cast<const Made&>(subject);
  const double length = distance(line.from, line.to);
  double sum = 0;
  std::set<float> levels;
  for (const float a : made.answers) sum += double(a), levels.insert(a);
  extra["shadow_answered"] = sum / double(std::max<std::size_t>(made.answers.size(), 1));
  extra["shadow_levels"] = levels.size();
  if (line.name == "edge") note_width(made.answers, truth.visibility, length, extra);
  if (line.name != "contact") return;
  double texel = 0;
  if (const Knobs& knobs = made.build_knobs(); knobs.contains("resolution")) {
    const auto view = shading::shadow::fit_view(input_.scene.light, box_of(input_.scene));
    texel = view.texel_width(knobs.at("resolution").get<int>(), dot(line.from - view.origin, view.forward));
  }
  note_gap(made.answers, length, texel, extra);
}

/// By how much the answers' change from frame to frame differs from the truth's.
Errors ShadowBlock::check_motion(std::span<const float> answers, const std::vector<Truth>& truths) const {
  Errors e;
  const std::size_t n = truths.front().visibility.size();
  double squares = 0, peak = 0, floor = 0;
  for (std::size_t f = 1; f < truths.size(); ++f) {
    for (std::size_t i = 0; i < n; ++i) {
      const double told = double(answers[f * n + i]) - double(answers[(f - 1) * n + i]);
      const double off = told - (truths[f].visibility[i] - truths[f - 1].visibility[i]);
      if (std::isnan(off)) {
        e.within_claim = false, e.reason = "receiver " + std::to_string(i) + " is answered by no number";
        continue;
      }
      squares += off * off, peak = std::max(peak, std::abs(off));
    }
    floor = std::max(floor, truths[f].halves);
  }
  e.error = std::sqrt(squares / (double(n) * double(truths.size() - 1)));
  e.floor = floor;
  e.extra = {{"shadow_crawl_peak", peak}};
  return e;
}

/// The first receiver whose hard shadow is told wrong, though it is the same all around.
std::optional<std::size_t> ShadowBlock::false_without_reason(std::span<const float> answers, const Set& set,
                                                             const Truth& truth) const {
  const double r = forgiven * length(box_of(input_.scene).extent());
  for (std::size_t i = 0; i < set.receivers.size(); ++i) {
    if (std::abs(double(answers[i]) - truth.visibility[i]) <= much) continue;
    const Receiver& at = set.receivers[i];
    const geometry::Frame<double> frame(at.normal);
    std::vector<Receiver> around;
    for (int k = 0; k < 8; ++k) {
      const double angle = k * std::numbers::pi / 4;
      around.push_back(
          {at.position + frame(geometry::Vec3d{r * std::cos(angle), r * std::sin(angle), 0.0}), at.normal});
    }
    const Truth there = traced_truth(input_.scene, tree_, around, {}, 0, input_.truth, 1);
    if (std::ranges::all_of(there.visibility, [&](double v) { return v == truth.visibility[i]; })) return i;
  }
  return std::nullopt;
}

}  // namespace treeline::bench::shadow
