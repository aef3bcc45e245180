// Counts what a program is given by its system's allocator, to be loaded into it by LD_PRELOAD: the bytes of malloc and
// all that comes down to it, and of memory mapped without a file, in pieces of 4 KiB and more: the small ones depend on
// how tasks meet threads. When the program ends, their sum is written to the file that SCUMBLE_ALLOCATED_TO names.
// Freed memory is not subtracted: bench/required.py needs the total of allocations, not the current one. Not seen: what
// the C library maps for itself, stacks of threads for one, and mapped files.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

extern "C" {

// glibc's own, under the names for replacements of malloc.
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void* __libc_valloc(std::size_t);
}

namespace {

std::atomic<unsigned long long> bytes_given{0};

void* Counted(void* memory, std::size_t bytes) {
  constexpr std::size_t kPage = 4096;
  if (memory && bytes >= kPage) bytes_given.fetch_add(bytes, std::memory_order_relaxed);
  return memory;
}

struct AtTheEnd {
  ~AtTheEnd() {
    const char* const path = std::getenv("SCUMBLE_ALLOCATED_TO");
    if (!path) return;
    const int file = ::open(path, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    char text[32];
    const int length = std::snprintf(text, sizeof text, "%llu\n", bytes_given.load());
    if (file < 0 || ::write(file, text, static_cast<std::size_t>(length)) != length) std::perror(path);
    if (file >= 0) ::close(file);
  }
} at_the_end;

}  // namespace

extern "C" {

void* malloc(std::size_t size) { return Counted(__libc_malloc(size), size); }
void* calloc(std::size_t count, std::size_t size) { return Counted(__libc_calloc(count, size), count * size); }
void* realloc(void* old, std::size_t size) { return Counted(__libc_realloc(old, size), size); }
void* memalign(std::size_t alignment, std::size_t size) { return Counted(__libc_memalign(alignment, size), size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) { return Counted(__libc_memalign(alignment, size), size); }
void* valloc(std::size_t size) { return Counted(__libc_valloc(size), size); }

int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  if (alignment % sizeof(void*) != 0 || alignment == 0 || (alignment & (alignment - 1)) != 0) return EINVAL;
  void* const memory = Counted(__libc_memalign(alignment, size), size);
  if (!memory) return ENOMEM;
  *result = memory;
  return 0;
}

void* mmap(void* at, std::size_t size, int protection, int flags, int file, off_t offset) {
  void* const memory = reinterpret_cast<void*>(::syscall(SYS_mmap, at, size, protection, flags, file, offset));
  if ((flags & MAP_ANONYMOUS) && memory != MAP_FAILED) Counted(memory, size);
  return memory;
}
void* mmap64(void* at, std::size_t size, int protection, int flags, int file, off_t offset) {
  return mmap(at, size, protection, flags, file, offset);
}
}
