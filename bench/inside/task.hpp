// Task `inside`: is a point inside a mesh?
//
// Meshes: closed ones of every family, and an icosphere with damage of every kind (datasets_gen/meshes/
//   damage.hpp), told by "+" in the dataset's name. Queries: queries.hpp.
// Truth: truth.hpp, of the mesh; of damaged ones, what the mesh was before. A mesh of the user's own must be
//   closed and oriented, and no part of it inside out, since otherwise nothing says what is inside; it is
//   refused if not. Where its faces are found to meet beside their edges or to cross along them, methods that
//   fail there are held to their claims only for points that it winds around 0 times or once, of which all
//   definitions say the same; those that go by the first face on a ray only for those outside, and those that
//   go by the nearest face for none: inside_faces_meet.
// Errors and claims: judge.hpp.
// Advice: on near, uniform and on_vertex; a tolerance is a share of wrong answers.
#pragma once

#include "bench/core/registered_task.hpp"
#include "bench/inside/method.hpp"

namespace treeline::bench::inside {

class InsideTask final : public RegisteredTask<Method> {
 public:
  InsideTask();

  std::string name() const override { return "inside"; }
  int version() const override { return 3; }
  std::vector<BlockSpec> blocks(Profile) const override;
  std::vector<BlockSpec> hard_blocks() const override;
  std::vector<BlockSpec> scaling_blocks(Profile) const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::mesh; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"near", "uniform", "on_vertex"}; }

 private:
  /// whole: what a damaged dataset was before; given: it is a user's.
  std::unique_ptr<Block> open(datasets::Dataset, std::optional<geometry::Mesh3f> whole, const RunContext&,
                              bool scaling, bool given) const;
};

}  // namespace treeline::bench::inside
