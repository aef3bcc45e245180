// Assertions about our own code. CHECK stays on in release builds and throws InternalError, which the command line
// reports with exit code 6. DCHECK is for hot loops and vanishes when NDEBUG is defined.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace scumble {

class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

namespace internal {
[[noreturn]] inline void FailCheck(const char* file, int line, const std::string& what) {
  std::ostringstream message;
  message << file << ":" << line << ": check failed: " << what;
  throw InternalError(message.str());
}
template <class A, class B>
[[noreturn]] void FailCompare(const char* file, int line, const char* text, const A& a, const B& b) {
  std::ostringstream message;
  message << text << " (" << a << " against " << b << ")";
  FailCheck(file, line, message.str());
}
}  // namespace internal
}  // namespace scumble

#define SCUMBLE_CHECK(condition) \
  ((condition) ? void(0) : ::scumble::internal::FailCheck(__FILE__, __LINE__, #condition))

#define SCUMBLE_CHECK_OP(op, a, b)                                                               \
  do {                                                                                           \
    const auto& check_a = (a);                                                                   \
    const auto& check_b = (b);                                                                   \
    if (!(check_a op check_b))                                                                   \
      ::scumble::internal::FailCompare(__FILE__, __LINE__, #a " " #op " " #b, check_a, check_b); \
  } while (false)
#define SCUMBLE_CHECK_EQ(a, b) SCUMBLE_CHECK_OP(==, a, b)
#define SCUMBLE_CHECK_LT(a, b) SCUMBLE_CHECK_OP(<, a, b)
#define SCUMBLE_CHECK_LE(a, b) SCUMBLE_CHECK_OP(<=, a, b)

#ifdef NDEBUG
#define SCUMBLE_DCHECK(condition) void(0)
#else
#define SCUMBLE_DCHECK(condition) SCUMBLE_CHECK(condition)
#endif
