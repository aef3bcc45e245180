#include "core/style/finish/finish_mask_keys.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "core/io/picture_file.h"

namespace scumble {
namespace {

constexpr double kMostMetres = 1e6;

std::uint16_t MaskShareOf(const std::uint16_t* texel) {
  const double lightness = 0.2126 * texel[0] + 0.7152 * texel[1] + 0.0722 * texel[2];
  return static_cast<std::uint16_t>(std::min(65535.0, lightness * (texel[3] / 65535.0) + 0.5));
}

FinishKey MaskMetres(const char* name, double FinishMask::*field, const char* help) {
  FinishKey key{name, KeyKind::kNumber, 0.0, kMostMetres, {}, "", help, {}, {}};
  key.set = [=](FinishPass& pass, const KeyValue& value) -> Status {
    const auto number = AsNumber(value);
    if (!number || !(*number >= 0.0 && *number <= kMostMetres)) {
      return UsageError("expected metres, 0 to 1e+06");
    }
    pass.mask.*field = *number;
    return Ok();
  };
  key.get = [=](const FinishPass& pass) -> KeyValue { return pass.mask.*field; };
  return key;
}

FinishKey MaskShape() {
  FinishKey key{kMaskKey,
                KeyKind::kText,
                0.0,
                0.0,
                {},
                "",
                "where it works: a picture, light where it does, or \"radial\", at the picture's edge",
                {},
                {}};
  key.set = [](FinishPass& pass, const KeyValue& value) -> Status {
    const auto* text = std::get_if<std::string>(&value);
    if (!text) return UsageError("expected a picture's name, \"radial\", or \"\" for everywhere");
    return SetMaskShape(*text, {}, pass.mask);
  };
  key.get = [](const FinishPass& pass) -> KeyValue { return pass.mask.shape; };
  return key;
}

FinishKey MaskInvert() {
  FinishKey key{
      "mask_invert", KeyKind::kFlag, 0.0, 0.0, {}, "", "the other way round: where these masks do not let it", {}, {}};
  key.set = [](FinishPass& pass, const KeyValue& value) -> Status {
    const auto* flag = std::get_if<bool>(&value);
    if (!flag) return UsageError("expected true or false");
    pass.mask.invert = *flag;
    return Ok();
  };
  key.get = [](const FinishPass& pass) -> KeyValue { return pass.mask.invert; };
  return key;
}

}  // namespace

std::vector<FinishKey> FinishMaskKeys() {
  using M = FinishMask;
  return {MaskShape(), MaskMetres("mask_near", &M::near, "only from this depth on, metres; 0: from the nearest"),
          MaskMetres("mask_far", &M::far, "only up to this depth, metres; 0: to the background"),
          MaskMetres("mask_soft", &M::soft, "metres over which mask_near and mask_far fade"), MaskInvert()};
}

Status SetMaskShape(const std::string& shape, const std::filesystem::path& folder, FinishMask& mask) {
  if (shape.empty() || shape == kRadialMask) {
    mask.shape = shape;
    mask.file.clear(), mask.picture.reset();
    return Ok();
  }
  const std::filesystem::path file = folder / shape;
  std::error_code failed;
  if (!std::filesystem::exists(file, failed) && !failed) {
    return InputError("cannot read " + file.string() +
                      ": there is no such file; a mask is a picture, \"radial\", or \"\" for everywhere");
  }
  SCUMBLE_ASSIGN(Picture picture, ReadPicture(file));
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    std::uint16_t* const texel = picture.rgba.data() + i;
    std::fill_n(texel, 3, MaskShareOf(texel));
    texel[3] = 65535;
  }
  mask.shape = shape, mask.file = file;
  mask.picture = std::make_shared<const Picture>(std::move(picture));
  return Ok();
}

}  // namespace scumble
