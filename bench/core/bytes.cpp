#include "bench/core/bytes.hpp"

#if defined(TREELINE_SANITIZED) || !defined(__linux__)

namespace treeline::bench {
ByteCount::ByteCount() = default;
ByteCount::~ByteCount() = default;
std::optional<std::size_t> ByteCount::live() { return std::nullopt; }
}  // namespace treeline::bench

#else

#include <malloc.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>

namespace {

// One counter a thread, or nearly, so that parallel builds do not fight over a cache line.
struct alignas(64) Slot {
  std::atomic<std::int64_t> live{0};
};
constinit Slot slots[64];
constinit std::atomic<unsigned> next_slot{0};
constinit std::atomic<bool> counting{false};

void count(std::int64_t bytes) noexcept {
  static thread_local constinit unsigned mine = ~0u;
  if (mine == ~0u) mine = next_slot.fetch_add(1, std::memory_order_relaxed) % std::size(slots);
  slots[mine].live.fetch_add(bytes, std::memory_order_relaxed);
}
bool on() noexcept { return counting.load(std::memory_order_relaxed); }

void* counted(void* memory) noexcept {
  if (on() && memory) count(static_cast<std::int64_t>(malloc_usable_size(memory)));
  return memory;
}

}  // namespace

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) noexcept { return counted(__libc_malloc(size)); }
void* calloc(std::size_t n, std::size_t size) noexcept { return counted(__libc_calloc(n, size)); }
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  return counted(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return counted(__libc_memalign(alignment, size));
}

int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept {
  if (alignment < sizeof(void*) || (alignment & (alignment - 1)) != 0) return EINVAL;
  void* memory = counted(__libc_memalign(alignment, size));
  if (!memory) return ENOMEM;
  *out = memory;
  return 0;
}

void* realloc(void* old, std::size_t size) noexcept {
  const auto before = on() && old ? static_cast<std::int64_t>(malloc_usable_size(old)) : 0;
  void* memory = __libc_realloc(old, size);
  if (on() && (memory || size == 0)) count(-before);
  return counted(memory);
}

void free(void* memory) noexcept {
  if (on() && memory) count(-static_cast<std::int64_t>(malloc_usable_size(memory)));
  __libc_free(memory);
}

// malloc's own mappings do not pass here. Address space that is only reserved (no write) is not memory.
void* mmap(void* address, std::size_t length, int protection, int flags, int file, off_t offset) noexcept {
  const long memory = syscall(SYS_mmap, address, length, protection, flags, file, offset);
  if (on() && memory != -1 && file == -1 && (protection & PROT_WRITE))
    count(static_cast<std::int64_t>(length));
  return reinterpret_cast<void*>(memory);
}
void* mmap64(void* address, std::size_t length, int protection, int flags, int file,
             off64_t offset) noexcept {
  return mmap(address, length, protection, flags, file, offset);
}
int munmap(void* address, std::size_t length) noexcept {
  const long result = syscall(SYS_munmap, address, length);
  if (on() && result == 0) count(-static_cast<std::int64_t>(length));
  return static_cast<int>(result);
}

}  // extern "C"

namespace treeline::bench {

ByteCount::ByteCount() {
  for (Slot& slot : slots) slot.live.store(0, std::memory_order_relaxed);
  counting.store(true);
}

ByteCount::~ByteCount() { counting.store(false); }

std::optional<std::size_t> ByteCount::live() {
  counting.store(false);
  std::int64_t sum = 0;
  for (const Slot& slot : slots) sum += slot.live.load(std::memory_order_relaxed);
  return static_cast<std::size_t>(sum > 0 ? sum : 0);
}

}  // namespace treeline::bench

#endif
