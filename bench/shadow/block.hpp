// One scene seen by its camera: what each method says of its shadows, and how that is judged.
#pragma once

#include <optional>

#include "bench/shadow/method.hpp"
#include "bench/shadow/truth.hpp"
#include "datasets_gen/hard/hard_shadows.hpp"

namespace treeline::bench::shadow {

/// A share of the light by formula, of a light that may have moved.
using LightForm = std::function<double(const shading::Light&, const Receiver&)>;

struct BlockInput {
  shading::Scene scene;
  std::uint64_t dataset_hash = 0, seed = 1;
  LightForm closed_form;                      // empty: rays tell the truth
  std::vector<datasets::ReceiverLine> lines;  // a query set each
  int frames = 0;                             // of the set `motion`; 0: not asked
  TruthOptions truth;
  int threads = 1;  // for the truth
  std::string truth_cache;
  int version = 0;
  bool quick = false;
  bool must_answer = false;       // a refusal is wrong
  std::vector<std::string> only;  // methods that the scene has something to say of; empty: all
};

/// The light of a frame: moved so that shadows move by about a tenth of a texel of a map of 1024 texels.
shading::Light moved(const shading::Scene&, int frame);

class ShadowBlock final : public Block {
 public:
  /// Methods must outlive the block. Throws shading::InvalidScene for a scene without anything to ask.
  ShadowBlock(const std::vector<Method>& methods, BlockInput input);
  ~ShadowBlock() override;

  const std::vector<QuerySet>& query_sets() const override { return query_sets_; }
  std::unique_ptr<Subject> build(std::size_t m, const Knobs& build_knobs, int threads) override;
  Errors check(std::size_t m, const Subject&, std::size_t query_set, const Knobs& query_knobs) override;
  std::size_t n() const override { return input_.scene.mesh.size(); }
  std::uint64_t seed() const override { return input_.seed; }
  std::uint64_t dataset_hash() const override { return input_.dataset_hash; }
  bool quick() const override { return input_.quick; }
  bool offers(std::size_t method) const override;

  /// Of each set, once for all the children of a hard case.
  void find_truth();
  const Receivers& image() const { return image_; }
  const shading::Scene& scene() const { return input_.scene; }
  /// The answers that a subject holds, of the set that it ran last; for pictures and tests.
  static std::span<const float> answers(const Subject&);
  const Truth& truth(std::size_t query_set) { return truth_of(query_set).front(); }

 private:
  const Knobs& split();

  enum class What { image, line, motion };
  struct Set;

  const std::vector<Truth>& truth_of(std::size_t query_set);  // one a frame
  Truth find(const Set&, const shading::Scene&) const;
  void note_line(const datasets::ReceiverLine&, const Subject&, const Truth&, Knobs& extra) const;
  Errors check_motion(std::span<const float> answers, const std::vector<Truth>&) const;
  std::optional<std::size_t> false_without_reason(std::span<const float> answers, const Set&,
                                                  const Truth&) const;

  const std::vector<Method>& methods_;
  BlockInput input_;
  Tree tree_;
  Receivers image_;
  std::vector<Receiver> asked_;  // of the image and of all lines
  std::vector<shading::Scene> frames_;
  std::vector<Set> sets_;
  std::vector<QuerySet> query_sets_;
  std::optional<Knobs> split_;  // not yet known
};

/// Where the answers on a line from dark to light pass a share, as a share of the line; the first time
/// upwards, between the two receivers beside it. Nothing if they never do.
std::optional<double> crossing(std::span<const float> answers, double share);

}  // namespace treeline::bench::shadow
