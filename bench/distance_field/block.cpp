#include "bench/distance_field/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "bench/core/refusal.hpp"
#include "bench/core/tally.hpp"
#include "bench/distance_field/truth.hpp"
#include "geometry/random.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::distance_field {
namespace {

using geometry::Vec3d;
using geometry::Vec3f;

enum Set : std::size_t { near = 0, uniform = 1, trace = 2 };

constexpr double near_width = 0.01;       // in longest sides
constexpr std::size_t sampled = 4000;     // of a field's own samples
constexpr std::size_t counted = 1000000;  // rays or points have numbers below

double longest_side(const geometry::Box3d& box) {
  const Vec3d e = box.extent();
  return std::max({e[0], e[1], e[2]});
}

class FieldSubject final : public Subject {
 public:
  FieldSubject(const Method& method, const Input& input, const Knobs& knobs,
               const std::vector<std::vector<Vec3f>>& points, const std::vector<geometry::Rayf>& rays,
               bool must_answer)
      : hit_tolerance_(knobs.contains("resolution") ? distance_field::hit_tolerance * input.spacing : 0),
        points_(points),
        rays_(rays) {
    keep_refusal(must_answer, refusal_, [&] { field_ = method.build(input, knobs); });
  }

  void run(std::size_t set, const Knobs& knobs, int threads) override {
    if (!field_) return;
    if (set == Set::trace) {
      traced.resize(rays_.size());
      field_->trace(rays_, knobs, threads, traced);
    } else {
      distances.resize(points_[set].size());
      field_->distances(points_[set], knobs, threads, distances);
    }
  }

  const Field* field() const { return field_.get(); }
  const std::string& refusal() const { return refusal_; }
  /// Within which a hit of its own is one.
  double hit_tolerance() const { return hit_tolerance_; }
  std::vector<float> distances;
  std::vector<TraceAnswer> traced;

 private:
  double hit_tolerance_;
  const std::vector<std::vector<Vec3f>>& points_;
  const std::vector<geometry::Rayf>& rays_;
  std::unique_ptr<Field> field_;
  std::string refusal_;
};

std::string place(const Vec3d& p) { return fmt::format("({:g}, {:g}, {:g})", p[0], p[1], p[2]); }

/// Whether an answer in float is what the field says for certain, rounded.
bool is_rounded(double answer, double certain) {
  return std::abs(answer - certain) <=
         2 * double(geometry::tolerance::unit_roundoff<float>) * std::abs(certain) +
             double(std::numeric_limits<float>::denorm_min());
}

class FieldBlock final : public Block {
 public:
  FieldBlock(const std::vector<Method>& methods, BlockInput input)
      : methods_(methods),
        input_(std::move(input)),
        box_(finite_box()),
        side_(longest_side(box_)),
        slack_(geometry::tolerance::sample_slack<float> * reach() +
               4 * double(std::numeric_limits<float>::denorm_min())) {
    if (!(side_ > 0))
      throw std::invalid_argument("the mesh is a single point: nothing to sample a field over");
    make_points();
    make_rays();
    sets_ = {{"near", points_[Set::near].size()},
             {"uniform", points_[Set::uniform].size()},
             {"trace", rays_.size()}};
  }

  const std::vector<QuerySet>& query_sets() const override { return sets_; }
  std::size_t n() const override { return mesh().size(); }
  std::uint64_t seed() const override { return input_.dataset.seed; }
  std::uint64_t dataset_hash() const override { return input_.dataset.hash(); }
  bool quick() const override { return input_.quick; }

  std::unique_ptr<Subject> build(std::size_t m, const Knobs& knobs, int threads) override {
    const double cells = knobs.contains("resolution") ? knobs.at("resolution").get<double>() : 1;
    return std::make_unique<FieldSubject>(methods_[m],
                                          Input{.mesh = mesh(), .spacing = side_ / cells, .threads = threads},
                                          knobs, points_, rays_, input_.must_answer);
  }

  Errors check(std::size_t m, const Subject& subject, std::size_t set, const Knobs& query_knobs) override {
    const auto& answers = dynamic_cast<const FieldSubject&>(subject);
    if (!answers.field()) return refused_wrongly(answers.refusal());
    const bool bounded = methods_[m].info.claim == Claim::bounded;
    Errors e = set == Set::trace ? check_rays(answers, query_knobs, bounded)
                                 : check_points(answers, set, query_knobs, bounded);
    if (set == Set::near) check_samples(*answers.field(), e);
    const Knobs facts = answers.field()->facts();
    e.extra.update(facts);
    if (!input_.note.empty()) e.extra["distance_field_note"] = input_.note;
    return e;
  }

 private:
  const geometry::Mesh3f& mesh() const { return input_.dataset.mesh; }

  geometry::Box3d finite_box() const {
    geometry::Box3d box;
    for (const auto& face : mesh().faces)
      for (const std::uint32_t v : face)
        if (geometry::is_finite(mesh().vertices.at(v))) box.grow(Vec3d(mesh().vertices[v]));
    if (box.empty()) throw std::invalid_argument("the mesh has no finite triangles: no distance to it");
    return box;
  }
  double reach() const {
    double r = 0;
    for (int k = 0; k < 3; ++k) r = std::max({r, std::abs(box_.low[k]), std::abs(box_.high[k])});
    return 2 * r;
  }

  void make_points() {
    geometry::Pcg32 random(input_.seed, 31);
    points_.resize(2);
    const auto faces = static_cast<std::uint32_t>(mesh().size());
    while (points_[Set::near].size() < input_.points) {
      const geometry::Triangle3d t(mesh().triangle(random.below(faces)));
      double a = random.uniform(), b = random.uniform();
      if (a + b > 1) a = 1 - a, b = 1 - b;
      Vec3d p = t.a + (t.b - t.a) * a + (t.c - t.a) * b, off;
      do {
        for (int k = 0; k < 3; ++k) off[k] = random.uniform(-1.0, 1.0);
      } while (length2(off) > 1);
      p += off * (near_width * side_);
      if (geometry::is_finite(Vec3f(p)))
        points_[Set::near].push_back(Vec3f(p));
      else if (++dropped_ > counted)
        throw std::invalid_argument("the mesh has no finite triangles");
    }
    const Vec3d around = Vec3d::filled(0.1 * side_);
    for (std::size_t i = 0; i < input_.points; ++i) {
      Vec3d p;
      for (int k = 0; k < 3; ++k) p[k] = random.uniform(box_.low[k] - around[k], box_.high[k] + around[k]);
      points_[Set::uniform].push_back(Vec3f(p));
    }
  }
  void make_rays() {
    geometry::Pcg32 random(input_.seed, 32);
    while (rays_.size() < input_.rays) {
      Vec3d out, to;
      do {
        for (int k = 0; k < 3; ++k) out[k] = random.uniform(-1.0, 1.0);
      } while (length2(out) > 1 || length2(out) < 0.01);
      for (int k = 0; k < 3; ++k) to[k] = random.uniform(box_.low[k], box_.high[k]);
      const Vec3f from(box_.centre() + normalized(out) * (1.5 * side_));
      const Vec3d way = to - Vec3d(from);
      rays_.push_back({from, Vec3f(normalized(way))});
    }
  }

  const Truth& truth() {
    if (!truth_) {
      const geometry::Mesh3f* whole = input_.dataset.closed ? &mesh() : nullptr;
      if (!input_.whole.faces.empty()) whole = &input_.whole;
      truth_ = std::make_unique<Truth>(mesh(), whole);
      const auto widened = [](const std::vector<Vec3f>& points) {
        std::vector<Vec3d> r;
        for (const Vec3f& p : points) r.push_back(Vec3d(p));
        return r;
      };
      for (const auto& points : points_)
        true_distances_.push_back(truth_->distances(widened(points), input_.threads));
      true_hits_ = truth_->hits(rays_, input_.threads);
    }
    return *truth_;
  }

  Errors check_points(const FieldSubject& subject, std::size_t set, const Knobs& knobs, bool bounded) {
    const bool sides = truth().has_sides();
    Errors e;
    ErrorTally tally;
    std::size_t wrong_sides = 0, told = 0;
    for (std::size_t i = 0; i < points_[set].size(); ++i) {
      const double d = true_distances_[set][i];
      const double timed = double(subject.distances[i]);
      double answer = timed;
      if (std::isnan(answer)) {
        broken(e, "point " + std::to_string(i) + " is answered by no number");
        continue;
      }
      const Vec3d p(points_[set][i]);
      const bool wrong = sides && (answer < 0) != (d < 0) && std::abs(d) > slack_;
      wrong_sides += wrong;
      if (!sides) answer = std::abs(answer);
      const double error = std::min((answer - d) / side_, 1.0);
      if (set == Set::uniform) {
        if (sides) tally.add(wrong, wrong ? (answer < 0 ? -1 : 1) : 0);
      } else {
        tally.add(std::abs(error), error);
      }
      if (!bounded) continue;
      const auto certain = subject.field()->certain(p, knobs);
      if (!certain) continue;
      ++told;
      const double own = sides ? certain->distance : std::abs(certain->distance);
      const bool holds = certain->known ? std::abs(own - d) <= certain->error + slack_
                                        : std::abs(own) <= std::abs(d) + slack_ && !wrong;
      if (!holds)
        broken(e, fmt::format("at {} the distance is {:g}, told {:g} within {:g}", place(p), d, own,
                              certain->error));
      // The bound is that of what certain() says: it holds for the answer that was timed if both are one.
      if (!is_rounded(timed, certain->distance))
        broken(e, fmt::format("at {} the batch answers {:g}, and one by one {:g} is certain", place(p), timed,
                              certain->distance));
    }
    tally.write(e);
    if (set == Set::uniform) e.max = e.p99 = std::nullopt;  // sides are right or wrong: no answer is worse
    e.extra = {
        {"distance_field_signs_wrong", sides ? share(wrong_sides, points_[set].size()) : Knobs(nullptr)},
        {"distance_field_bounded_points", told}};
    return e;
  }

  Errors check_rays(const FieldSubject& subject, const Knobs& knobs, bool bounded) {
    truth();
    Errors e;
    ErrorTally tally;
    std::size_t false_hits = 0, false_misses = 0, untold = 0, exhausted = 0, most = 0, doubted = 0,
                groundless = 0, plain_misses = 0;
    double steps = 0;
    std::vector<Place> met;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const TraceAnswer& a = subject.traced[i];
      const double t = true_hits_[i];
      const bool hit = std::isfinite(a.t), truly = std::isfinite(t);
      steps += a.steps, most = std::max<std::size_t>(most, a.steps), exhausted += a.exhausted;
      false_hits += hit && !truly, false_misses += !hit && truly;
      const bool silent = !hit && truly && !a.doubtful && !a.exhausted;
      untold += silent;
      doubted += a.doubtful || a.exhausted;
      const double error = hit && truly ? (double(a.t) - t) / side_ : hit == truly ? 0 : hit ? -1 : 1;
      tally.add(std::min(std::abs(error), 1.0), std::clamp(error, -1.0, 1.0));
      if (!bounded || !subject.field()->certain(Vec3d(rays_[i].origin), knobs)) continue;
      plain_misses += !hit && !a.doubtful && !a.exhausted;
      groundless += (a.doubtful || a.exhausted) && is_clear(subject, knobs, rays_[i]);
      if (silent) broken(e, fmt::format("ray {} meets the surface at {:g}, told a miss", i, t));
      const auto at = [&](double s) { return Vec3d(rays_[i].origin) + Vec3d(rays_[i].direction) * s; };
      if (hit) met.push_back({i, at(double(a.t)), 1});
      if (hit && double(a.t) > t && !a.doubtful)
        for (int k = 1; k < looks; ++k) met.push_back({i, at(t + (double(a.t) - t) * k / looks), passing});
    }
    check_places(subject, knobs, met, e);
    if (groundless > plain_misses)
      broken(e, fmt::format(
                    "{} rays are doubted which pass the surface by what the field says for certain, and {} "
                    "are not",
                    groundless, plain_misses));
    tally.write(e);
    const auto count = static_cast<double>(rays_.size());
    e.extra = {{"distance_field_false_hits", false_hits},
               {"distance_field_false_misses", false_misses},
               {"distance_field_untold_misses", untold},
               {"distance_field_exhausted", exhausted},
               {"distance_field_doubtful", share(doubted, rays_.size())},
               {"distance_field_steps_mean", most > 0 ? Knobs(steps / count) : Knobs(nullptr)},
               {"distance_field_steps_max", most > 0 ? Knobs(most) : Knobs(nullptr)}};
    return e;
  }

  /// Whether the field's own word, for certain, is that a ray passes the surface: balls that hold none of it
  /// cover the way.
  bool is_clear(const FieldSubject& subject, const Knobs& knobs, const geometry::Rayf& ray) const {
    constexpr int most = 256;      // balls; a ray that grazes takes more
    const double far = 4 * side_;  // beyond the box: rays begin 1.5 from its centre
    double t = 0;
    for (int i = 0; i < most && t < far; ++i) {
      const auto there = subject.field()->certain(Vec3d(ray.origin) + Vec3d(ray.direction) * t, knobs);
      if (!there || !(there->clearance() > subject.hit_tolerance())) return false;
      t += there->clearance();
    }
    return t >= far;
  }

  /// On a ray: no farther from the surface than so many times what the field leaves open there.
  struct Place {
    std::size_t ray;
    Vec3d at;
    double times;
  };
  /// Places between the surface that a ray meets first and a hit behind it that the field does not doubt. As
  /// long as it passes what it has taken for that surface by no more than its error, it is nowhere farther
  /// away than three of these: the field's own distance may be one, the true one another more, and the next
  /// step as long as the first.
  static constexpr int looks = 8;
  static constexpr double passing = 3;

  void check_places(const FieldSubject& subject, const Knobs& knobs, const std::vector<Place>& places,
                    Errors& e) {
    std::vector<Vec3d> at;
    for (const Place& p : places) at.push_back(p.at);
    const std::vector<double> there = truth().distances(at, input_.threads);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto [ray, p, times] = places[i];
      const double error = subject.field()->certain(p, knobs)->error, tolerance = subject.hit_tolerance();
      if (std::abs(there[i]) <= times * (error + tolerance) + slack_) continue;
      broken(e,
             times > 1
                 ? fmt::format("ray {} goes through the surface before its hit: at {} it is {:g} away", ray,
                               place(p), there[i])
                 : fmt::format("the hit of ray {} at {} is {:g} from the surface", ray, place(p), there[i]));
    }
  }

  /// The samples themselves, in longest sides.
  void check_samples(const Field& field, Errors& e) {
    const std::vector<Sample> samples = field.samples(sampled);
    Knobs max, mean, wrong;  // null where there is nothing to say
    const auto tell = [&] {
      e.extra["distance_field_sample_error_max"] = max;
      e.extra["distance_field_sample_error_mean"] = mean;
      e.extra["distance_field_sample_signs_wrong"] = wrong;
    };
    if (samples.empty()) return tell();
    std::vector<Vec3d> at;
    for (const Sample& s : samples) at.push_back(s.at);
    const std::vector<double> d = truth().distances(at, input_.threads);
    double sum = 0, worst = 0;
    std::size_t signs = 0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      const double off = std::abs(std::abs(samples[i].distance) - std::abs(d[i])) / side_;
      sum += off, worst = std::max(worst, off);
      signs += truth().has_sides() && (samples[i].distance < 0) != (d[i] < 0) && std::abs(d[i]) > slack_;
    }
    max = worst, mean = sum / static_cast<double>(at.size());
    if (truth().has_sides()) wrong = share(signs, at.size());
    tell();
  }

  static Knobs share(std::size_t part, std::size_t whole) {
    return Knobs(static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1)));
  }
  static void broken(Errors& e, std::string reason) {
    if (e.within_claim) e.reason = std::move(reason);
    e.within_claim = false;
  }

  const std::vector<Method>& methods_;
  const BlockInput input_;
  const geometry::Box3d box_;
  const double side_, slack_;
  std::size_t dropped_ = 0;
  std::vector<std::vector<Vec3f>> points_;  // by set
  std::vector<geometry::Rayf> rays_;
  std::vector<QuerySet> sets_;
  std::unique_ptr<Truth> truth_;
  std::vector<std::vector<double>> true_distances_;
  std::vector<double> true_hits_;
};

}  // namespace

std::unique_ptr<Block> open_block(const std::vector<Method>& methods, BlockInput input) {
  return std::make_unique<FieldBlock>(methods, std::move(input));
}

}  // namespace treeline::bench::distance_field
