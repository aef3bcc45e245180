// Errors as values: a user's mistake or a failing disk returns an Error inside Expected<T>. Nothing here throws on
// purpose; what the standard library throws (std::bad_alloc) passes through.
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace scumble {

// The kind of failure. The command line turns it into an exit code.
enum class ErrorKind {
  kUsage,        // the caller asked for something that makes no sense
  kInput,        // a file or value is unreadable or invalid
  kOutput,       // something could not be written
  kUnavailable,  // what it needs is missing: Blender, an installed part, or a feature of this version
  kCancelled,    // the caller has cancelled it
  kMemory,       // the machine, or a limit such as ulimit's, gives no more memory or threads
};

// `message` is one sentence or two: the file, what was found, what was expected, and how to fix it. A Stylizer calls
// settings by the members that set them, as coverage_samples or view.elevation.
struct Error {
  ErrorKind kind = ErrorKind::kInput;
  std::string message;
};

inline Error UsageError(std::string message) { return {ErrorKind::kUsage, std::move(message)}; }
inline Error InputError(std::string message) { return {ErrorKind::kInput, std::move(message)}; }
inline Error OutputError(std::string message) { return {ErrorKind::kOutput, std::move(message)}; }
inline Error UnavailableError(std::string message) { return {ErrorKind::kUnavailable, std::move(message)}; }
inline Error MemoryError(std::string message) { return {ErrorKind::kMemory, std::move(message)}; }
inline Error CancelledError() { return {ErrorKind::kCancelled, "cancelled"}; }

// Either a value or an Error: test it with `if (!result)` first. Taking the wrong one throws std::bad_variant_access.
template <class T>
class [[nodiscard]] Expected {
 public:
  Expected(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Expected(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& value() & { return std::get<0>(state_); }
  const T& value() const& { return std::get<0>(state_); }
  T&& value() && { return std::get<0>(std::move(state_)); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }

  const Error& error() const& { return std::get<1>(state_); }
  Error&& error() && { return std::get<1>(std::move(state_)); }

 private:
  std::variant<T, Error> state_;
};

// Success without a value.
struct Done {};
using Status = Expected<Done>;
inline Status Ok() { return Done{}; }

}  // namespace scumble
