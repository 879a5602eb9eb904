#include "bench/core/selection.hpp"

namespace treeline::bench {

datasets::Dataset read_input(const std::string& file, datasets::Kind) {
  throw UsageError("--input " + file + ": this build has no readers");
}

}  // namespace treeline::bench
