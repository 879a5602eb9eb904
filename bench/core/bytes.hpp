// Bytes that a build leaves allocated, counted the same way for everyone: the program's malloc family and
// mmap are interposed and counted while a ByteCount lives.
//
// Known weakness: what a library keeps in a pool from earlier builds is not seen; sanitizers interpose the
// same functions, so under them there is no count.
#pragma once

#include <cstddef>
#include <optional>

namespace treeline::bench {

/// Counts from construction to the first call of live(); one at a time.
class ByteCount {
 public:
  ByteCount();
  ~ByteCount();
  ByteCount(const ByteCount&) = delete;
  ByteCount& operator=(const ByteCount&) = delete;
  /// Allocated less freed by all threads since construction; ends the count. Empty where it cannot be
  /// counted.
  std::optional<std::size_t> live();
};

}  // namespace treeline::bench
