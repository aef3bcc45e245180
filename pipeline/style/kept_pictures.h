// Pictures of styles that stay decoded from call to call.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

// Decodes each file once, and again where it has changed. At most kMostBytes are kept: larger pictures are read each
// time. For one thread at a time.
class KeptPictures {
 public:
  static constexpr std::size_t kMostBytes = std::size_t(64) << 20;

  // A copy of the picture. Errors are those of ReadPicture; nothing is kept of them.
  Expected<Picture> Read(const std::filesystem::path& file);

  // Drops what has not been read since the last call.
  void ForgetUnread();

  std::size_t decoded() const { return decoded_; }  // files so far
  std::size_t bytes() const { return bytes_; }      // that are kept

 private:
  struct Kept {
    std::string stamp;
    Picture picture;
    bool is_read = true;
  };
  std::map<std::string, Kept> kept_;
  std::size_t bytes_ = 0;
  std::size_t decoded_ = 0;
};

}  // namespace scumble
