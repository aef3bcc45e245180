// A bench stops without its measured object.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <utility>

#include "core/image/status.h"

namespace scumble {

template <class T>
T OrStop(Expected<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message.c_str());
  std::exit(1);
}

inline void OrStop(const Status& status) {
  if (status) return;
  std::fprintf(stderr, "%s\n", status.error().message.c_str());
  std::exit(1);
}

}  // namespace scumble
