// Memory for planes of pixels.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace scumble {

// For std::vector. Elements without an initial value stay as the memory came. Large blocks ask for large pages: a frame's
// planes are tens of megabytes, and the system hands them out page by page as they are first touched.
template <class T>
class PlaneAllocator {
 public:
  using value_type = T;

  PlaneAllocator() = default;
  template <class U>
  PlaneAllocator(const PlaneAllocator<U>&) {}

  T* allocate(std::size_t count) {
    if (count > std::size_t(-1) / 2 / sizeof(T)) throw std::bad_alloc();
    const std::size_t bytes = count * sizeof(T);
    const std::size_t alignment = bytes >= kLargePage ? kLargePage : kCacheLine;
    void* memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    if (!memory) throw std::bad_alloc();
#if defined(__linux__)
    // Only ever a wish: where it is not granted, pages are small.
    if (alignment == kLargePage) madvise(memory, bytes / kLargePage * kLargePage, MADV_HUGEPAGE);
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) { std::free(memory); }

  template <class U>
  void construct(U* element) {
    ::new (static_cast<void*>(element)) U;
  }
  template <class U, class... Arguments>
  void construct(U* element, Arguments&&... arguments) {
    ::new (static_cast<void*>(element)) U(std::forward<Arguments>(arguments)...);
  }

  bool operator==(const PlaneAllocator&) const { return true; }

 private:
  static constexpr std::size_t kLargePage = std::size_t(2) << 20;
  static constexpr std::size_t kCacheLine = 64;
};

}  // namespace scumble
