// A task whose truth is known by heart: "what is 2 i?" for i < n. Its methods misbehave in every way that the
// harness must survive.
#pragma once

#include "bench/core/task.hpp"

namespace treeline::bench {

class FakeTask : public Task {
 public:
  FakeTask();
  std::string name() const override { return "fake"; }
  int version() const override { return 1; }
  const std::vector<MethodInfo>& methods() const override { return methods_; }
  std::vector<std::pair<std::string, std::string>> not_built() const override;
  std::vector<BlockSpec> blocks(Profile) const override;
  std::vector<BlockSpec> hard_blocks() const override;
  std::vector<BlockSpec> scaling_blocks(Profile) const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::cloud; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"forward", "backward"}; }
  void pictures(const BlockSpec&, const RunContext&, const std::string& folder) const override;

 private:
  std::vector<MethodInfo> methods_;
};

}  // namespace treeline::bench
