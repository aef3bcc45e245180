#include "core/io/color_profile.h"

#include <lcms2.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "core/io/format_dispatch.h"
#include "core/io/parallel.h"

namespace scumble::internal {
namespace {

using Profile = std::unique_ptr<void, decltype([](void* profile) { cmsCloseProfile(profile); })>;
using Transform = std::unique_ptr<void, decltype([](void* transform) { cmsDeleteTransform(transform); })>;

// From texels of RGBA, or from single values, to texels of RGBA. Threads may share it. What the library would make of
// it to be faster is off by several codes of 8 bits in the darks of linear profiles.
Transform ToSrgb(void* profile, bool is_grey) {
  const Profile srgb(cmsCreate_sRGBProfile());
  return Transform(cmsCreateTransform(profile, is_grey ? TYPE_GRAY_16 : TYPE_RGBA_16, srgb.get(), TYPE_RGBA_16,
                                      INTENT_RELATIVE_COLORIMETRIC,
                                      cmsFLAGS_BLACKPOINTCOMPENSATION | cmsFLAGS_NOCACHE | cmsFLAGS_NOOPTIMIZE));
}

// Whether colours all over the cube stay within half a code of 8 bits.
bool ChangesNothing(void* transform) {
  constexpr int kSteps = 8, kHalfCode = 128;
  std::vector<std::uint16_t> given, made;
  const auto level = [](int i) { return static_cast<std::uint16_t>(65535 * i / kSteps); };
  for (int r = 0; r <= kSteps; ++r) {
    for (int g = 0; g <= kSteps; ++g) {
      for (int b = 0; b <= kSteps; ++b) given.insert(given.end(), {level(r), level(g), level(b), 0});
    }
  }
  made = given;
  cmsDoTransform(transform, given.data(), made.data(), static_cast<cmsUInt32Number>(given.size() / 4));
  return std::equal(given.begin(), given.end(), made.begin(),
                    [](int a, int b) { return std::abs(a - b) <= kHalfCode; });
}

}  // namespace

void ConvertToSrgb(std::span<const std::byte> bytes, Picture& picture) {
  const Profile profile(cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())));
  if (!profile || picture.empty()) return;
  const cmsColorSpaceSignature space = cmsGetColorSpace(profile.get());
  const bool is_grey = space == cmsSigGrayData;
  if (!is_grey && space != cmsSigRgbData) return;
  const Transform transform = ToSrgb(profile.get(), is_grey);
  if (!transform || (!is_grey && ChangesNothing(transform.get()))) return;
  const auto width = static_cast<std::size_t>(picture.width);
  ForEachIndex(picture.height, IoThreads(), [&](int y) {
    std::uint16_t* const row = picture.At(0, y);
    std::vector<std::uint16_t> given(row, row + 4 * width);
    for (std::size_t x = 0; is_grey && x < width; ++x) given[x] = row[4 * x];
    cmsDoTransform(transform.get(), given.data(), row, static_cast<cmsUInt32Number>(width));
  });
}

}  // namespace scumble::internal
