// Errors as values, and how they are passed on. A user's mistake or a failing disk returns Error inside Expected<T>. A
// broken contract inside the program is a CHECK (core/image/check.h). There is no third kind.
#pragma once

#include "scumble/status.h"

#define SCUMBLE_CONCAT_INNER(a, b) a##b
#define SCUMBLE_CONCAT(a, b) SCUMBLE_CONCAT_INNER(a, b)

// SCUMBLE_ASSIGN(auto scene, LoadScene(path));  returns the error from the enclosing function, or declares `scene`.
#define SCUMBLE_ASSIGN(declaration, expression)                                                            \
  auto SCUMBLE_CONCAT(expected_, __LINE__) = (expression);                                                 \
  if (!SCUMBLE_CONCAT(expected_, __LINE__)) return std::move(SCUMBLE_CONCAT(expected_, __LINE__)).error(); \
  declaration = std::move(SCUMBLE_CONCAT(expected_, __LINE__)).value()

// SCUMBLE_RETURN_IF_ERROR(WriteGuides(path, guides));
#define SCUMBLE_RETURN_IF_ERROR(expression)                                    \
  do {                                                                         \
    if (auto status = (expression); !status) return std::move(status).error(); \
  } while (false)
