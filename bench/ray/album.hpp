// The pictures of one dataset as a task's folder of pictures keeps them: PNG files, and a line for each in
// pictures.jsonl, which the report reads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shading/image.hpp"

namespace treeline::bench::ray {

/// What the report says of a picture.
struct Words {
  std::string title, caption, method, kind;
  int columns = 0;                       ///< of panels (work_picture.hpp: beside); 0: it is one picture
  std::vector<std::string> panels = {};  ///< what stands on each, row after row
};

class Album {
 public:
  /// Drawn again, a task's pictures of a dataset take the place of the earlier ones.
  Album(std::string task, std::string dataset, const std::string& folder);

  /// Into the file <task>_<dataset>_<what>.png. In builds that cannot write PNG nothing is added. Throws
  /// std::runtime_error naming the file if it, or the index, cannot be written.
  void add(const std::string& what, const shading::Image& image, const Words& words);
  /// A file of another format, already written to path_of(name).
  void add_file(const std::string& name, const Words& words);
  std::string path_of(const std::string& name) const;

 private:
  std::string file(const std::string& name) const;
  void write_index() const;

  std::filesystem::path root_;
  std::string task_, dataset_, lines_;
};

/// One image above another of the same width.
shading::Image stacked(const shading::Image& above, const shading::Image& below);

}  // namespace treeline::bench::ray
