// What all tasks have in common whose methods register themselves (registry.hpp).
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/core/registry.hpp"

namespace treeline::bench {

template <MethodEntry Method>
class RegisteredTask : public Task {
 public:
  const std::vector<MethodInfo>& methods() const final { return infos_; }
  std::vector<std::pair<std::string, std::string>> not_built() const final { return not_built_; }
  /// None, if the task has none.
  void pictures(const BlockSpec&, const RunContext&, const std::string& /*folder*/) const override {}

  const std::vector<Method>& registered() const { return methods_; }

 protected:
  /// As CMake knows them: TREELINE_TASK_METHODS and TREELINE_TASK_NOT_BUILT. Throws std::logic_error if the
  /// methods that registered are others.
  RegisteredTask(std::string_view methods, std::string_view not_built)
      : methods_(Registry<Method>::instance().in_order_of(methods)), not_built_(parse_not_built(not_built)) {
    for (const Method& m : methods_) infos_.push_back(m.info);
  }

 private:
  std::vector<Method> methods_;
  std::vector<MethodInfo> infos_;
  std::vector<std::pair<std::string, std::string>> not_built_;
};

}  // namespace treeline::bench
