// One room: what each method says of the radiance that its camera sees, and of that of its walls.
#pragma once

#include <optional>

#include "bench/light_transport/method.hpp"
#include "bench/light_transport/truth.hpp"

namespace treeline::bench::light_transport {

struct BlockInput {
  LitScene room;
  std::uint64_t dataset_hash = 0, seed = 1;
  RadianceForm form;                // empty: paths tell the truth
  std::optional<BoxOfWalls> walls;  // a query set of their own
  int wall_repeats = 512;           // pixels a wall
  TruthOptions truth;
  int threads = 1;  // for the truth
  std::string truth_cache;
  int version = 0;
  bool quick = false;
  bool must_answer = false;       // a refusal is wrong
  bool must_refuse = false;       // there is nothing to be right about
  bool seldom = false;            // lamps are too seldom met for methods that do not combine to be tested
  std::string suffix;             // of the query sets' names: of thread scaling
  std::vector<std::string> only;  // methods that the room has something to say of; empty: all
};

class LightBlock final : public Block {
 public:
  /// Methods must outlive the block. Throws std::invalid_argument for a room without faces or pixels.
  LightBlock(const std::vector<Method>& methods, BlockInput input);

  const std::vector<QuerySet>& query_sets() const override { return query_sets_; }
  std::unique_ptr<Subject> build(std::size_t m, const Knobs& build_knobs, int threads) override;
  Errors check(std::size_t m, const Subject&, std::size_t query_set, const Knobs& query_knobs) override;
  std::size_t n() const override { return input_.room.mesh.size(); }
  std::uint64_t seed() const override { return input_.seed; }
  std::uint64_t dataset_hash() const override { return input_.dataset_hash; }
  bool quick() const override { return input_.quick; }
  bool offers(std::size_t method) const override;

  /// Of each set, once for all the children of a hard case.
  void find_truth();
  const LitScene& room() const { return input_.room; }
  const Truth& truth(std::size_t query_set);
  /// What a subject answered last; for pictures and tests.
  static const Film& film(const Subject&);

 private:
  Truth find(std::size_t query_set) const;
  void note_walls(const Film&, const Truth&, const Knobs& query_knobs, Knobs& extra) const;

  const std::vector<Method>& methods_;
  BlockInput input_;
  std::vector<Question> questions_;
  std::vector<QuerySet> query_sets_;
  std::vector<std::optional<Truth>> truths_;
};

}  // namespace treeline::bench::light_transport
