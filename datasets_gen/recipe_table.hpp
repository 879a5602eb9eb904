// What the tables of scenes, rooms and surfaces have in common: entries, each with a KnobRecipe called
// recipe. Internal to their sources.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "datasets_gen/knobs.hpp"

namespace treeline::datasets {

/// Null if no entry's recipe has the name.
template <class Entry>
const Entry* find_entry(const std::vector<Entry>& table, std::string_view name) {
  for (const Entry& e : table)
    if (names(name, e.recipe)) return &e;
  return nullptr;
}

/// Throws std::invalid_argument, which says what it is ("scene") and lists those known.
template <class Entry>
const Entry& entry_called(const std::vector<Entry>& table, std::string_view what, std::string_view name) {
  if (const Entry* const entry = find_entry(table, name)) return *entry;
  std::string known;
  for (const Entry& e : table) known += (known.empty() ? "" : ", ") + e.recipe.name;
  throw std::invalid_argument("no " + std::string(what) + " is called '" + std::string(name) +
                              "'; known: " + known);
}

template <class Entry>
std::vector<KnobRecipe> recipes_in(const std::vector<Entry>& table) {
  std::vector<KnobRecipe> r;
  for (const Entry& e : table) r.push_back(e.recipe);
  return r;
}

}  // namespace treeline::datasets
