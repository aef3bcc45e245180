// Memory for planes of pixels.
#pragma once

#include <cstddef>
#include <new>
#include <utility>

namespace scumble {

// `bytes` of uninitialised memory on a cache line; throws std::bad_alloc. The system hands out large blocks page by
// page on first touch, and clears each page. For a frame's planes that takes as long as a third of casting its rays. So
// AllocatePlane asks for large pages, and keeps freed blocks for the next request of equal size: up to kKeptPlaneBytes
// in all, the oldest is freed first. Free to use from any thread.
void* AllocatePlane(std::size_t bytes);
void FreePlane(void* memory, std::size_t bytes);
inline constexpr std::size_t kKeptPlaneBytes = std::size_t(256) << 20;

// AllocatePlane as an allocator for std::vector. Elements without an initial value stay uninitialised.
template <class T>
class PlaneAllocator {
 public:
  using value_type = T;

  PlaneAllocator() = default;
  template <class U>
  PlaneAllocator(const PlaneAllocator<U>&) {}

  T* allocate(std::size_t count) {
    if (count > std::size_t(-1) / 2 / sizeof(T)) throw std::bad_alloc();
    return static_cast<T*>(AllocatePlane(count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t count) { FreePlane(memory, count * sizeof(T)); }

  template <class U>
  void construct(U* element) {
    ::new (static_cast<void*>(element)) U;
  }
  template <class U, class... Arguments>
  void construct(U* element, Arguments&&... arguments) {
    ::new (static_cast<void*>(element)) U(std::forward<Arguments>(arguments)...);
  }

  bool operator==(const PlaneAllocator&) const { return true; }
};

}  // namespace scumble
