#include "core/image/plane_allocator.h"

#include <atomic>
#include <cstdlib>
#include <mutex>
#include <vector>
#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "core/image/plane_count.h"

namespace scumble {
namespace {

constexpr std::size_t kLargePage = std::size_t(2) << 20;
constexpr std::size_t kCacheLine = 64;

std::atomic<std::size_t> handed_out{0};

bool IsLarge(std::size_t bytes) { return bytes >= kLargePage; }

// Freed blocks, the oldest first.
class KeptPlanes {
 public:
  KeptPlanes() { blocks_.reserve(kMostBlocks + 1); }

  // Null if no block has this size.
  void* Take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = blocks_.size(); i-- > 0;) {
      if (blocks_[i].bytes != bytes) continue;
      void* const memory = blocks_[i].memory;
      blocks_.erase(blocks_.begin() + std::ptrdiff_t(i));
      total_ -= bytes;
      return memory;
    }
    return nullptr;
  }

  void Keep(void* memory, std::size_t bytes) {
    if (bytes > kKeptPlaneBytes) return std::free(memory);
    const std::lock_guard lock(mutex_);
    blocks_.push_back({memory, bytes});
    total_ += bytes;
    while (total_ > kKeptPlaneBytes || blocks_.size() > kMostBlocks) {
      total_ -= blocks_.front().bytes;
      std::free(blocks_.front().memory);
      blocks_.erase(blocks_.begin());
    }
  }

 private:
  struct Block {
    void* memory;
    std::size_t bytes;
  };
  static constexpr std::size_t kMostBlocks = 64;

  std::mutex mutex_;
  std::vector<Block> blocks_;
  std::size_t total_ = 0;
};

// Never destroyed: a guide set may be destroyed at the very end of a program.
KeptPlanes& Kept() {
  static KeptPlanes& kept = *new KeptPlanes;
  return kept;
}

}  // namespace

std::size_t PlaneBytesHandedOut() { return handed_out; }

void* AllocatePlane(std::size_t bytes) {
  handed_out += bytes;
  if (IsLarge(bytes)) {
    if (void* const kept = Kept().Take(bytes)) return kept;
  }
  const std::size_t alignment = IsLarge(bytes) ? kLargePage : kCacheLine;
  void* const memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (!memory) throw std::bad_alloc();
#if defined(__linux__)
  // Only a hint: if the system refuses, pages are small.
  if (IsLarge(bytes)) madvise(memory, bytes / kLargePage * kLargePage, MADV_HUGEPAGE);
#endif
  return memory;
}

void FreePlane(void* memory, std::size_t bytes) {
  if (memory && IsLarge(bytes)) return Kept().Keep(memory, bytes);
  std::free(memory);
}

}  // namespace scumble
