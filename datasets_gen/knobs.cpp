#include "datasets_gen/knobs.hpp"

#include <charconv>
#include <stdexcept>

#include "datasets_gen/rooms/room.hpp"
#include "datasets_gen/scenes/scene.hpp"
#include "datasets_gen/surfaces/surface.hpp"

namespace treeline::datasets {
namespace {

std::string quoted(std::string_view text) { return std::string("'").append(text).append("'"); }

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace

bool names(std::string_view name, const KnobRecipe& recipe) {
  return name == recipe.name || name.starts_with(recipe.name + "_");
}

std::vector<double> read_knobs(std::string_view what, std::string_view name, const KnobRecipe& recipe) {
  std::vector<double> knobs;
  for (const Knob& knob : recipe.knobs) knobs.push_back(knob.value);
  std::string_view rest = name.substr(recipe.name.size());
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument(std::string(what) + " " + quoted(name) + ": " + why);
  };
  for (std::size_t k = 0; !rest.empty(); ++k) {
    rest.remove_prefix(1);
    const std::string_view text = rest.substr(0, rest.find('_'));
    rest.remove_prefix(text.size());
    if (k == knobs.size())
      refuse(quoted(text) + " is one too many, " + recipe.name + " has " + std::to_string(knobs.size()) +
             " knobs");
    const Knob& knob = recipe.knobs[k];
    const std::string range = " from " + shortest(knob.low) + " to " + shortest(knob.high);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), knobs[k]);
    if (error != std::errc() || end != text.data() + text.size())
      refuse(quoted(text) + " is no number for " + knob.name + ", which is a number alone" + range);
    if (!(knobs[k] >= knob.low && knobs[k] <= knob.high))
      refuse(knob.name + " is " + std::string(text) + "; it must be" + range);
  }
  return knobs;
}

std::string with_defaults(const KnobRecipe& recipe) {
  std::string text = recipe.name;
  for (const Knob& knob : recipe.knobs) text += "_" + knob.name + "=" + shortest(knob.value);
  return text;
}

std::span<const KnobRecipe> knob_recipes(Kind kind) {
  switch (kind) {
    case Kind::scene:
      return scene_recipes();
    case Kind::room:
      return room_recipes();
    case Kind::surface:
      return surface_recipes();
    default:
      return {};
  }
}

}  // namespace treeline::datasets
