// The limit of pixels in all pictures of a scene.
#pragma once

#include <cstdint>
#include <string>

#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

// A picture of a few bytes can hold up to 2^28 pixels, and a scene any number of such pictures. This budget refuses
// more pixels than a machine can be expected to hold.
class PictureBudget {
 public:
  static constexpr std::uint64_t kMaxPixels = std::uint64_t(1) << 30;  // 8 GiB, 64 pictures of 4096 × 4096

  explicit PictureBudget(std::uint64_t max_pixels = kMaxPixels) : max_pixels_(max_pixels) {}

  // Takes one more picture; kInput, naming the file, over the limit.
  Status Take(const std::string& file, const Picture& picture) {
    return Take(file, std::uint64_t(picture.width) * std::uint64_t(picture.height));
  }
  Status Take(const std::string& file, std::uint64_t pixels) {
    if (pixels <= max_pixels_ - taken_) {
      taken_ += pixels;
      return Ok();
    }
    return InputError(file + " has textures of at least " + std::to_string(taken_ + pixels) +
                      " pixels together; expected at most " + std::to_string(max_pixels_) + ": make them smaller");
  }

 private:
  std::uint64_t max_pixels_;
  std::uint64_t taken_ = 0;
};

}  // namespace scumble
