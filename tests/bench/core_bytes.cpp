// Bytes: what stays allocated counts, whoever allocated it and however.
#include "bench/core/bytes.hpp"

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/mman.h>

#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

namespace treeline::bench {
namespace {

#ifdef TREELINE_SANITIZED
TEST(Bytes, AreNotCountedUnderSanitizers) { EXPECT_FALSE(ByteCount().live().has_value()); }
#else

constexpr std::size_t size = 1 << 20;
constexpr std::size_t slack = 8192;  // malloc's rounding to pages and its headers

void* volatile keep;  // so that no allocation is optimised away

template <class Allocate, class Free>
void expect_counted(Allocate allocate, Free release) {
  ByteCount kept;
  void* memory = allocate();
  keep = memory;
  const std::size_t live = *kept.live();
  EXPECT_GE(live, size);
  EXPECT_LE(live, size + slack);
  release(memory);
  ByteCount passing;
  memory = allocate();
  keep = memory;
  release(memory);
  EXPECT_LE(*passing.live(), slack);
}

TEST(Bytes, EveryWayToAllocate) {
  expect_counted([] { return std::malloc(size); }, [](void* p) { std::free(p); });
  expect_counted([] { return std::calloc(size / 8, 8); }, [](void* p) { std::free(p); });
  expect_counted([] { return std::realloc(std::malloc(10), size); }, [](void* p) { std::free(p); });
  expect_counted([] { return std::aligned_alloc(64, size); }, [](void* p) { std::free(p); });
  expect_counted([] { return memalign(64, size); }, [](void* p) { std::free(p); });
  expect_counted(
      [] {
        void* p = nullptr;
        EXPECT_EQ(posix_memalign(&p, 64, size), 0);
        return p;
      },
      [](void* p) { std::free(p); });
  expect_counted([] { return operator new(size); }, [](void* p) { operator delete(p); });
  expect_counted([] { return operator new(size, std::align_val_t(128)); },
                 [](void* p) { operator delete(p, std::align_val_t(128)); });
  expect_counted(
      [] { return mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0); },
      [](void* p) { munmap(p, size); });
}

TEST(Bytes, ReservedAddressSpaceIsNoMemory) {
  ByteCount count;
  void* memory = mmap(nullptr, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  EXPECT_LE(*count.live(), slack);
  munmap(memory, size);
}

TEST(Bytes, OfAllThreads) {
  std::vector<std::unique_ptr<char[]>> kept(4);
  ByteCount count;
  std::vector<std::thread> threads;
  for (auto& memory : kept) threads.emplace_back([&memory] { memory = std::make_unique<char[]>(size); });
  for (std::thread& thread : threads) thread.join();
  const std::size_t live = *count.live();
  EXPECT_GE(live, 4 * size);
  EXPECT_LE(live, 4 * size + 16 * slack);
}

TEST(Bytes, BadAlignmentIsRefusedAsPosixSays) {
  void* p = nullptr;
  EXPECT_EQ(posix_memalign(&p, 3, 8), EINVAL);
}

#endif

}  // namespace
}  // namespace treeline::bench
