// Where the methods of a task register themselves, one file each:
//
//   static const bool registered = Registry<KnnMethod>::instance().add({.info = {.name = "bvh", …}, …});
//
// Files are linked as object libraries: the linker drops unreferenced registrations from static ones. So that
// a method can never go missing unseen, the task asks for them by the names that CMake knows.
#pragma once

#include <algorithm>
#include <concepts>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/core/task.hpp"

namespace treeline::bench {

template <class Entry>
concept MethodEntry = requires(const Entry& e) {
  { e.info } -> std::convertible_to<const MethodInfo&>;
};

/// "a,b" → {"a", "b"}; empty → {}.
inline std::vector<std::string> split_names(std::string_view names, char separator = ',') {
  std::vector<std::string> out;
  while (!names.empty()) {
    const std::size_t end = std::min(names.find(separator), names.size());
    if (end > 0) out.emplace_back(names.substr(0, end));
    names.remove_prefix(std::min(end + 1, names.size()));
  }
  return out;
}

/// Reads TREELINE_TASK_NOT_BUILT: "method:package,…" → pairs, for Task::not_built().
inline std::vector<std::pair<std::string, std::string>> parse_not_built(std::string_view names) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const std::string& item : split_names(names)) {
    const std::size_t colon = std::min(item.find(':'), item.size() - 1);
    out.emplace_back(item.substr(0, colon), item.substr(colon + 1));
  }
  return out;
}

template <class Entry>
class Registry {
 public:
  static Registry& instance() {
    static Registry registry;
    return registry;
  }

  bool add(Entry entry) requires MethodEntry<Entry> {
    entries_.push_back(std::move(entry));
    return true;
  }

  /// In the order of registration, which is the linker's.
  const std::vector<Entry>& entries() const { return entries_; }

  /// In the order of `names` (comma separated; pass TREELINE_TASK_METHODS).
  /// Throws std::logic_error if a name has not registered, has twice, or is not expected.
  std::vector<Entry> in_order_of(std::string_view names) const {
    std::vector<Entry> out;
    for (const std::string& name : split_names(names)) {
      const auto has_name = [&](const Entry& e) { return e.info.name == name; };
      const auto found = std::count_if(entries_.begin(), entries_.end(), has_name);
      if (found != 1)
        throw std::logic_error("method " + name + " registered " + std::to_string(found) + " times");
      out.push_back(*std::find_if(entries_.begin(), entries_.end(), has_name));
    }
    for (const Entry& e : entries_)
      if (std::none_of(out.begin(), out.end(), [&](const Entry& o) { return o.info.name == e.info.name; }))
        throw std::logic_error("method " + e.info.name + " registered, but CMake does not list it");
    return out;
  }

 private:
  std::vector<Entry> entries_;
};

}  // namespace treeline::bench
