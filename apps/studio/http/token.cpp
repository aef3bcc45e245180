#include "apps/studio/http/token.h"

#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstddef>

#include "core/image/check.h"

namespace scumble {

std::string MakeToken() {
  std::array<unsigned char, 32> bytes;
  ssize_t filled = 0;
  do {
    filled = ::getrandom(bytes.data(), bytes.size(), 0);
  } while (filled < 0 && errno == EINTR);
  SCUMBLE_CHECK_EQ(filled, static_cast<ssize_t>(bytes.size()));
  std::string token;
  for (const unsigned char byte : bytes) {
    token += "0123456789abcdef"[byte >> 4];
    token += "0123456789abcdef"[byte & 15];
  }
  return token;
}

bool EqualInConstantTime(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) different |= static_cast<unsigned char>(a[i] ^ b[i]);
  return different == 0;
}

}  // namespace scumble
