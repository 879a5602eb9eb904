#include "bench/ray/album.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "bench/ray/png.hpp"

namespace treeline::bench::ray {
namespace {

/// As a part of a file's name: what a user's flags add to a dataset's is more than that takes.
std::string for_file(std::string name) {
  constexpr std::string_view kept = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._+-,";
  for (char& c : name)
    if (kept.find(c) == kept.npos) c = '_';
  return name;
}

}  // namespace

Album::Album(std::string task, std::string dataset, const std::string& folder)
    : root_(folder), task_(std::move(task)), dataset_(std::move(dataset)) {
  std::filesystem::create_directories(root_);
  std::ifstream in(root_ / "pictures.jsonl");
  for (std::string line; std::getline(in, line);) {
    const auto entry = nlohmann::json::parse(line, nullptr, false);
    const auto is = [&](const char* key, const std::string& value) {
      return entry.contains(key) && entry[key] == value;
    };
    if (!(entry.is_object() && is("task", task_) && is("dataset", dataset_))) lines_ += line + '\n';
  }
}

std::string Album::file(const std::string& name) const {
  return task_ + "_" + for_file(dataset_) + "_" + name;
}
std::string Album::path_of(const std::string& name) const { return (root_ / file(name)).string(); }

void Album::add(const std::string& what, const shading::Image& image, const Words& words) {
  if (write_png(path_of(what + ".png"), image)) add_file(what + ".png", words);
}

void Album::add_file(const std::string& name, const Words& words) {
  nlohmann::ordered_json entry{
      {"task", task_},       {"file", file(name)},     {"title", words.title}, {"caption", words.caption},
      {"dataset", dataset_}, {"method", words.method}, {"kind", words.kind}};
  if (words.columns > 0) entry["columns"] = words.columns, entry["panels"] = words.panels;
  lines_ += entry.dump() + '\n';
  write_index();
}

void Album::write_index() const {
  std::ofstream index(root_ / "pictures.jsonl");
  index << lines_ << std::flush;
  if (!index) throw std::runtime_error((root_ / "pictures.jsonl").string() + " cannot be written");
}

shading::Image stacked(const shading::Image& above, const shading::Image& below) {
  shading::Image image(above.width, above.height + below.height, 3);
  std::ranges::copy(above.values, image.values.begin());
  std::ranges::copy(below.values, image.values.begin() + std::ptrdiff_t(above.values.size()));
  return image;
}

}  // namespace treeline::bench::ray
