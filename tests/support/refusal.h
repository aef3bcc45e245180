// The checks of a refusal: the right kind of error, and words in its message.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/image/status.h"

namespace scumble {

template <class T>
void ExpectRefusal(const Expected<T>& result, ErrorKind kind, const std::vector<std::string>& words) {
  ASSERT_FALSE(result) << "expected words like '" << (words.empty() ? "" : words.back()) << "'";
  EXPECT_EQ(static_cast<int>(result.error().kind), static_cast<int>(kind)) << result.error().message;
  for (const std::string& word : words) {
    EXPECT_NE(result.error().message.find(word), std::string::npos)
        << "'" << word << "' in: " << result.error().message;
  }
}

// The input is at fault.
template <class T>
void ExpectRefusal(const Expected<T>& result, const std::vector<std::string>& words) {
  ExpectRefusal(result, ErrorKind::kInput, words);
}

}  // namespace scumble
