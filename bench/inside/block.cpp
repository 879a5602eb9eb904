#include "bench/inside/block.hpp"

#include "accel/self_intersections.hpp"
#include "bench/core/refusal.hpp"
#include "bench/core/truth_cache.hpp"
#include "geometry/mesh_check.hpp"

namespace treeline::bench::inside {
namespace {

class InsideSubject final : public Subject {
 public:
  /// Methods that refuse must_answer inputs at the build are told apart by build(), which throws.
  InsideSubject(std::unique_ptr<Index> index, const std::vector<PointSet>& sets, bool must_answer)
      : index_(std::move(index)), sets_(sets), must_answer_(must_answer) {}

  void run(std::size_t set, const Knobs& knobs, int threads) override {
    const auto& points = sets_[set].points;
    answers.resize(points.size());
    refusal.clear();
    keep_refusal(must_answer_, refusal, [&] { index_->inside(points, answers, knobs, threads); });
  }

  const Index& index() const { return *index_; }

  std::vector<std::uint8_t> answers;
  std::string refusal;

 private:
  std::unique_ptr<Index> index_;
  const std::vector<PointSet>& sets_;
  bool must_answer_;
};

}  // namespace

InsideBlock::InsideBlock(BlockInput input, const std::vector<Method>& methods)
    : MeshBlock(std::move(input), methods), truths_(input_.sets.size()) {
  for (const PointSet& set : input_.sets) query_sets_.push_back({set.name, set.points.size()});
}

std::unique_ptr<Subject> InsideBlock::build(std::size_t m, const Knobs& build_knobs, int threads) {
  return std::make_unique<InsideSubject>(methods_[m].build(input_.mesh, build_knobs, threads), input_.sets,
                                         input_.must_answer);
}

void InsideBlock::find_truth() {
  for (std::size_t set = 0; set < input_.sets.size(); ++set) truth_of(set);
}

const std::vector<Side>& InsideBlock::truth_of(std::size_t query_set) {
  std::optional<std::vector<Side>>& truth = truths_[query_set];
  if (truth) return *truth;
  const auto& points = input_.sets[query_set].points;
  const TruthKey key{"inside", input_.version, input_.dataset_hash, hash_of(points)};
  if (auto cached = load_truth_as<Side>(input_.truth_cache, key); cached && cached->size() == points.size()) {
    truth = std::move(*cached);
  } else {
    truth = true_sides(input_.whole ? *input_.whole : input_.mesh, points, input_.threads);
    store_truth(input_.truth_cache, key, *truth);
  }
  return *truth;
}

bool InsideBlock::faces_meet() {
  if (!faces_meet_) {
    const geometry::MeshCheck found = geometry::check_mesh(input_.mesh, 0);
    faces_meet_ =
        found.duplicate_faces.count > 0 || found.crossed_edges.count > 0 ||
        accel::self_intersections(input_.mesh, found.sound_faces, {.kept = 0, .threads = input_.threads})
                .count > 0;
  }
  return *faces_meet_;
}

std::vector<std::uint8_t> InsideBlock::held(const Method& method, std::size_t query_set) {
  if (method.by_nearest_face) return {};
  Clarity found = clarity_of(input_.mesh, input_.sets[query_set].points, input_.threads);
  if (!method.by_facing) return std::move(found.clear);
  // From outside every face looks towards the point, as long as nothing is wound around -1 times.
  if (found.less_than_nothing) return {};
  const std::vector<Side>& truth = truth_of(query_set);
  for (std::size_t i = 0; i < truth.size(); ++i)
    found.clear[i] = found.clear[i] != 0 && truth[i] != Side::inside;
  return std::move(found.clear);
}

Errors InsideBlock::check(std::size_t m, const Subject& subject, std::size_t query_set, const Knobs&) {
  const auto& answered = static_cast<const InsideSubject&>(subject);
  if (!answered.refusal.empty()) return refused_wrongly(answered.refusal);
  const Method& method = methods_[m];
  const bool promises = !method.promises_nothing && !(input_.coincident && method.by_nearest_face);
  Promise promise{method.info.claim, !input_.whole && promises};
  const auto judged = [&] {
    return judge(input_.mesh, input_.sets[query_set].points, truth_of(query_set), answered.answers, promise);
  };
  Errors result = judged();
  if (!result.within_claim && input_.given && faces_meet()) {
    const std::vector<std::uint8_t> still = held(method, query_set);
    promise.held = still, promise.whole = !still.empty();
    result = judged();
    result.extra["inside_faces_meet"] = true;
  }
  result.extra.update(answered.index().facts());
  return result;
}

}  // namespace treeline::bench::inside
