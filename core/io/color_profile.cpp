#include "core/io/color_profile.h"

#include <lcms2.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/io/format_dispatch.h"
#include "core/io/parallel.h"

namespace scumble::internal {
namespace {

using Profile = std::unique_ptr<void, decltype([](void* profile) { cmsCloseProfile(profile); })>;
using Transform = std::unique_ptr<void, decltype([](void* transform) { cmsDeleteTransform(transform); })>;

// From texels of RGBA, or from single values, to texels of RGBA. Threads may share it.
Transform ToSrgb(void* profile, bool is_grey, cmsUInt32Number more) {
  const Profile srgb(cmsCreate_sRGBProfile());
  return Transform(cmsCreateTransform(profile, is_grey ? TYPE_GRAY_16 : TYPE_RGBA_16, srgb.get(), TYPE_RGBA_16,
                                      INTENT_RELATIVE_COLORIMETRIC,
                                      cmsFLAGS_BLACKPOINTCOMPENSATION | cmsFLAGS_NOCACHE | more));
}

// Greys of all 8-bit codes, and colours all over the cube.
std::vector<std::uint16_t> Samples() {
  constexpr int kSteps = 8;
  std::vector<std::uint16_t> given;
  for (int code = 0; code < 256; ++code) given.insert(given.end(), 4, static_cast<std::uint16_t>(257 * code));
  const auto level = [](int i) { return static_cast<std::uint16_t>(65535 * i / kSteps); };
  for (int r = 0; r <= kSteps; ++r) {
    for (int g = 0; g <= kSteps; ++g) {
      for (int b = 0; b <= kSteps; ++b) given.insert(given.end(), {level(r), level(g), level(b), 0});
    }
  }
  return given;
}

// To half a code of 8 bits. Alphas are not looked at.
bool AreAlike(const std::vector<std::uint16_t>& a, const std::vector<std::uint16_t>& b) {
  constexpr int kHalfCode = 128;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (i % 4 != 3 && std::abs(a[i] - b[i]) > kHalfCode) return false;
  }
  return true;
}

// Returns the largest change of a code.
int Convert(void* transform, bool is_grey, std::uint16_t* texels, std::size_t count) {
  std::vector<std::uint16_t> given(texels, texels + 4 * count);
  for (std::size_t i = 0; is_grey && i < count; ++i) given[i] = texels[4 * i];
  cmsDoTransform(transform, given.data(), texels, static_cast<cmsUInt32Number>(count));
  int largest = 0;
  for (std::size_t i = 0; i < 4 * count; ++i) {
    if (i % 4 != 3) largest = std::max(largest, std::abs(texels[i] - given[is_grey ? i / 4 : i]));
  }
  return largest;
}

std::vector<std::uint16_t> Converted(void* transform, bool is_grey, std::vector<std::uint16_t> texels) {
  Convert(transform, is_grey, texels.data(), texels.size() / 4);
  return texels;
}

// What a profile does to codes.
struct Conversion {
  Transform transform;
  bool is_grey = false;
};

// None of a profile that is not applied, or keeps the codes of every picture.
std::optional<Conversion> ConversionOf(std::span<const std::byte> bytes) {
  const Profile profile(cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())));
  if (!profile) return std::nullopt;
  const cmsColorSpaceSignature space = cmsGetColorSpace(profile.get());
  const bool is_grey = space == cmsSigGrayData;
  if (!is_grey && space != cmsSigRgbData) return std::nullopt;
  Transform exact = ToSrgb(profile.get(), is_grey, cmsFLAGS_NOOPTIMIZE);
  // Twenty times as fast, and off by several codes of 8 bits in the darks of some profiles, such as linear ones.
  Transform quick = ToSrgb(profile.get(), is_grey, 0);
  if (!exact || !quick) return std::nullopt;
  const std::vector<std::uint16_t> given = Samples(), right = Converted(exact.get(), is_grey, given);
  if (!is_grey && AreAlike(given, right)) return std::nullopt;
  const bool may_be_quick = AreAlike(Converted(quick.get(), is_grey, given), right);
  return Conversion{std::move(may_be_quick ? quick : exact), is_grey};
}

bool HasColors(const Picture& picture) {
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    if (picture.rgba[i] != picture.rgba[i + 1] || picture.rgba[i] != picture.rgba[i + 2]) return true;
  }
  return false;
}

// The number at an offset, its lowest byte first or last.
std::size_t NumberAt(std::span<const std::byte> bytes, std::size_t at, bool lowest_first) {
  std::size_t number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    number = number << 8 | std::to_integer<std::size_t>(bytes[at + (lowest_first ? 3 - i : i)]);
  return number;
}

bool HasText(std::span<const std::byte> bytes, std::size_t at, std::string_view text) {
  if (at + text.size() > bytes.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (std::to_integer<char>(bytes[at + i]) != text[i]) return false;
  }
  return true;
}

// Chunks of a RIFF: a name, the length of the data, the data, and a byte more where that is odd.
std::span<const std::byte> ProfileOfWebp(std::span<const std::byte> file) {
  for (std::size_t at = 12; at + 8 <= file.size();) {
    const std::size_t length = NumberAt(file, at + 4, true);
    if (length > file.size() - at - 8) break;
    if (HasText(file, at, "ICCP")) return file.subspan(at + 8, length);
    at += 8 + length + length % 2;
  }
  return {};
}

// The box `colr` (ISO/IEC 14496-12, 12.1.5): its length, its name, the kind, and a profile. It lies some boxes deep,
// near the file's beginning.
std::span<const std::byte> ProfileOfHeif(std::span<const std::byte> file) {
  constexpr std::size_t kMost = 1 << 20, kHead = 12;
  for (std::size_t at = 4; at + 8 < std::min(file.size(), kMost); ++at) {
    if (!HasText(file, at, "colrprof") && !HasText(file, at, "colrrICC")) continue;
    const std::size_t length = NumberAt(file, at - 4, false);
    if (length > kHead && length - 4 <= file.size() - at) return file.subspan(at + 8, length - kHead);
  }
  return {};
}

}  // namespace

bool IsAlwaysIgnored(std::span<const std::byte> profile) { return !ConversionOf(profile); }

int ConvertToSrgb(std::span<const std::byte> profile, Picture& picture) {
  if (picture.empty()) return 0;
  const std::optional<Conversion> conversion = ConversionOf(profile);
  if (!conversion) return 0;
  if (conversion->is_grey && HasColors(picture)) return 0;  // a grey scan's profile that stayed when it was coloured
  std::vector<int> changes(static_cast<std::size_t>(picture.height));
  ForEachIndex(picture.height, IoThreads(), [&](int y) {
    changes[static_cast<std::size_t>(y)] = Convert(conversion->transform.get(), conversion->is_grey, picture.At(0, y),
                                                   static_cast<std::size_t>(picture.width));
  });
  return *std::max_element(changes.begin(), changes.end());
}

std::span<const std::byte> EmbeddedProfile(std::span<const std::byte> file) {
  if (HasText(file, 0, "RIFF") && HasText(file, 8, "WEBP")) return ProfileOfWebp(file);
  return HasText(file, 4, "ftyp") ? ProfileOfHeif(file) : std::span<const std::byte>();
}

}  // namespace scumble::internal
