// Pictures by OpenImageIO: every format, including PNGs that are not plain. Part of the module of formats.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/image/color.h"
#include "core/io/atomic_file.h"
#include "core/io/color_profile.h"
#include "core/io/format_dispatch.h"
#include "core/io/guides/guide_header.h"
#include "core/io/oiio/oiio.h"
#include "core/io/picture_file.h"
#include "core/io/picture_rules.h"

namespace scumble::formats {
using internal::Upper;
namespace {

// The channel of each colour; -1 where there is none.
struct ColorChannels {
  int r = -1, g = -1, b = -1, a = -1;
};

// The view layers of a render whose whole pictures are there, "NAME.Combined.", as the file spells them.
std::vector<std::string> CombinedLayers(const OIIO::ImageSpec& spec) {
  constexpr std::string_view kFirst = ".COMBINED.R";
  std::vector<std::string> found;
  for (const std::string& channel : spec.channelnames) {
    if (Upper(channel).ends_with(kFirst)) found.push_back(channel.substr(0, channel.size() - 1));
  }
  return found;
}

// Finds colours by name first (OpenImageIO sorts EXR channels), and by position where no name fits. A dot in a name
// separates its layer: guides are no colours, whatever their order.
Expected<ColorChannels> FindColorChannels(const OIIO::ImageSpec& spec, const std::string& file,
                                          const std::string& view_layer) {
  const std::vector<std::string> layers = CombinedLayers(spec);
  const std::string combined = layers.size() == 1 ? Upper(layers.front()) : "";
  const auto find = [&](std::initializer_list<std::string> names) {
    for (const std::string& name : names) {
      for (int c = 0; c < spec.nchannels; ++c) {
        if (Upper(spec.channelnames[c]) == name) return c;
      }
    }
    return -1;
  };
  const std::string wanted = Upper(view_layer) + ".COMBINED.";
  const ColorChannels chosen{find({wanted + "R"}), find({wanted + "G"}), find({wanted + "B"}), find({wanted + "A"})};
  if (!view_layer.empty() && chosen.r >= 0 && chosen.g >= 0 && chosen.b >= 0) return chosen;
  ColorChannels found{find({"R", "RED", "COMPOSITE.COMBINED.R", "VIEWLAYER.COMBINED.R", combined + "R"}),
                      find({"G", "GREEN", "COMPOSITE.COMBINED.G", "VIEWLAYER.COMBINED.G", combined + "G"}),
                      find({"B", "BLUE", "COMPOSITE.COMBINED.B", "VIEWLAYER.COMBINED.B", combined + "B"}),
                      find({"A", "ALPHA", "COMPOSITE.COMBINED.A", "VIEWLAYER.COMBINED.A", combined + "A"})};
  if (found.r >= 0 && found.g >= 0 && found.b >= 0) return found;
  if (const int grey = find({"Y", "I", "L"}); grey >= 0) return ColorChannels{grey, grey, grey, found.a};
  const auto& names = spec.channelnames;
  if (std::any_of(names.begin(), names.end(), [](const std::string& name) { return name.find('.') != name.npos; })) {
    return InputError(file + " holds layers and no picture: its channels are " + internal::ListOfChannels(names) +
                      ", expected R, G and B, or Y; name a picture");
  }
  if (spec.nchannels >= 3) return ColorChannels{0, 1, 2, spec.nchannels >= 4 ? 3 : -1};
  return ColorChannels{0, 0, 0, spec.nchannels == 2 ? 1 : -1};
}

// Whether colours are as they would be without alpha, as OpenInput asks for. Three readers give it and do not say so;
// the others say it, or give colours times alpha, as EXR has them.
bool IsStraight(const OIIO::ImageSpec& spec, std::string_view reader) {
  const bool is_silent = reader == "psd" || reader == "jpeg2000" || reader == "bmp";
  return is_silent || spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0;
}

// The file's ICC profile, as its reader gives it, or from its `bytes`; empty: none.
std::span<const std::byte> ProfileOf(const OIIO::ImageSpec& spec, std::span<const std::byte> bytes) {
  const OIIO::ParamValue* const found = spec.find_attribute("ICCProfile");
  if (!found || found->type().basetype != OIIO::TypeDesc::UINT8) return internal::EmbeddedProfile(bytes);
  return {static_cast<const std::byte*>(found->data()), found->type().size()};
}

bool IsLinear(const OIIO::ImageSpec& spec) {
  const std::string space = Upper(std::string(spec.get_string_attribute("oiio:ColorSpace")));
  if (space == "LINEAR" || space == "SCENE_LINEAR") return true;
  return spec.format.is_floating_point() && space != "SRGB";
}

std::uint16_t RoundDivide(std::uint32_t value, std::uint32_t divisor) {
  return static_cast<std::uint16_t>(std::min<std::uint32_t>(65535, (value + divisor / 2) / divisor));
}

// Clamps alpha to [0, 1]; NaN becomes 0.
float ClampAlpha(float alpha) { return alpha > 0.0f ? std::min(alpha, 1.0f) : 0.0f; }

void CountLosses(float light, float alpha, PictureLosses& losses) {
  constexpr float kRounding = 0.002f;
  if (std::isnan(light)) {
    ++losses.nan;
  } else if (light < -kRounding || light > alpha + kRounding) {
    ++losses.clamped;
  }
}

// Converts a file's pixel to a picture's.
struct Decoder {
  ColorChannels channels;
  bool straight = true;
  PictureLosses* losses = nullptr;  // null: not counted

  void Linear(const float* pixel, std::uint16_t* out) const {
    const float alpha = channels.a < 0 ? 1.0f : ClampAlpha(pixel[channels.a]);
    const float scale = straight || !(alpha > 0.0f) ? 1.0f : 1.0f / alpha;
    out[0] = Srgb16FromLinear(pixel[channels.r] * scale);
    out[1] = Srgb16FromLinear(pixel[channels.g] * scale);
    out[2] = Srgb16FromLinear(pixel[channels.b] * scale);
    out[3] = static_cast<std::uint16_t>(alpha * 65535.0f + 0.5f);
    if (!losses) return;
    if (channels.a >= 0 && std::isnan(pixel[channels.a])) ++losses->nan;
    for (const int c : {channels.r, channels.g, channels.b}) {
      CountLosses(straight ? pixel[c] * alpha : pixel[c], alpha, *losses);
    }
  }
  void Encoded(const std::uint16_t* pixel, std::uint16_t* out) const {
    const std::uint32_t alpha = channels.a < 0 ? 65535u : pixel[channels.a];
    const std::array<std::uint32_t, 3> color = {pixel[channels.r], pixel[channels.g], pixel[channels.b]};
    for (int c = 0; c < 3; ++c) {
      out[c] = straight || alpha == 0 || alpha == 65535u ? static_cast<std::uint16_t>(color[c])
                                                         : RoundDivide(color[c] * 65535u, alpha);
    }
    out[3] = static_cast<std::uint16_t>(alpha);
  }
};

// Channels that stand side by side in a file: [begin, end).
struct ChannelRange {
  int begin = 0, end = 0;
  int count() const { return end - begin; }
};

ChannelRange RangeOf(const ColorChannels& channels) {
  const auto [first, last] =
      std::minmax({channels.r, channels.g, channels.b, channels.a < 0 ? channels.r : channels.a});
  return {first, last + 1};
}

ColorChannels Within(ColorChannels channels, const ChannelRange& range) {
  for (int* channel : {&channels.r, &channels.g, &channels.b, &channels.a}) {
    if (*channel >= 0) *channel -= range.begin;
  }
  return channels;
}

// Reads channels in the file's own numbers, `T`, and passes each pixel and its place in the picture to `decode`. The
// picture is allocated after the whole file has been read, so that a truncated file does not cost that memory.
template <class T, class Decode>
Expected<Picture> ReadPixels(OIIO::ImageInput& input, const std::string& name, OIIO::TypeDesc type,
                             const ChannelRange& range, Decode decode) {
  const OIIO::ImageSpec spec = input.spec();
  std::vector<T> pixels(std::size_t(range.count()) * std::size_t(spec.width) * std::size_t(spec.height));
  bool read = false;
  SCUMBLE_RETURN_IF_ERROR(internal::WithoutExceptions(name, [&] {
    read = input.read_image(input.current_subimage(), 0, range.begin, range.end, type, pixels.data());
  }));
  if (!read || input.has_error()) return internal::ReadFailure(input, name);
  Picture picture(spec.full_width, spec.full_height);
  const T* pixel = pixels.data();
  for (int y = 0; y < spec.height; ++y) {
    for (int x = 0; x < spec.width; ++x, pixel += range.count()) {
      const int px = x + spec.x - spec.full_x, py = y + spec.y - spec.full_y;
      if (px >= 0 && py >= 0 && px < picture.width && py < picture.height) decode(pixel, picture.At(px, py));
    }
  }
  return picture;
}

// Turns the picture upright by the camera's orientation (Exif's Orientation, 1 to 8).
Picture Upright(Picture stored, int orientation) {
  if (orientation < 2 || orientation > 8) return stored;
  const bool transposed = orientation >= 5;
  Picture upright(transposed ? stored.height : stored.width, transposed ? stored.width : stored.height);
  const bool mirror_x = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  const bool mirror_y = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  for (int y = 0; y < upright.height; ++y) {
    for (int x = 0; x < upright.width; ++x) {
      const int u = transposed ? y : x, v = transposed ? x : y;
      std::copy_n(stored.At(mirror_x ? stored.width - 1 - u : u, mirror_y ? stored.height - 1 - v : v), 4,
                  upright.At(x, y));
    }
  }
  return upright;
}

// "Back, Fore" of what CombinedLayers gives.
std::string NamesOf(const std::vector<std::string>& combined) {
  std::string names;
  for (const std::string& layer : combined)
    names += (names.empty() ? "" : ", ") + layer.substr(0, layer.size() - std::string_view(".COMBINED.").size());
  return names;
}

// Goes to the part that holds the picture, of an EXR of several: that of the view layer, else of the usual names, else
// the first with R, G and B. Where none has them, the first.
Status SeekPicture(OIIO::ImageInput& input, const std::string& file, const std::string& view_layer = {}) {
  if (input.format_name() != std::string("openexr")) return Ok();
  int found = -1, usual = -1, chosen = -1;
  bool has_composite = false;  // of all view layers
  std::vector<std::string> combined;
  for (int part = 0; input.seek_subimage(part, 0); ++part) {
    const OIIO::ImageSpec spec = input.spec();
    const std::vector<std::string> layers = CombinedLayers(spec);
    combined.insert(combined.end(), layers.begin(), layers.end());
    const auto has = [&](const std::string& name) {
      return std::any_of(spec.channelnames.begin(), spec.channelnames.end(),
                         [&](const std::string& channel) { return Upper(channel) == name; });
    };
    if (!view_layer.empty() && has(Upper(view_layer) + ".COMBINED.R")) chosen = part;
    const bool has_colors = has("R") && has("G") && has("B");
    if (found < 0 && (has_colors || !layers.empty())) found = part;
    // Parts of several views are "rgba.left".
    std::string name = Upper(std::string(spec.get_string_attribute("oiio:subimagename")));
    name = name.substr(0, name.find('.'));
    const bool is_usual = name.empty() || name == "RGBA" || name == "RGB" || name == "BEAUTY" || name == "C";
    has_composite = has_composite || has("COMPOSITE.COMBINED.R");
    const bool is_of_blender = has("COMPOSITE.COMBINED.R") || has("VIEWLAYER.COMBINED.R");
    if (usual < 0 && ((has_colors && is_usual) || is_of_blender)) usual = part;
  }
  static_cast<void>(input.geterror());  // of the search for one more
  if (chosen < 0 && !view_layer.empty() && !combined.empty() && !has_composite)
    return InputError(file + " has no view layer '" + view_layer + "'; it has " + NamesOf(combined));
  if (chosen < 0 && usual < 0 && combined.size() > 1) {
    return InputError(
        file + " holds the pictures of several view layers, " + NamesOf(combined) +
        ": expected one; write it by itself, or choose it with --view-layer of `scumble transfer` or `finish`");
  }
  input.seek_subimage(chosen >= 0 ? chosen : usual >= 0 ? usual : std::max(0, found), 0);
  return Ok();
}

// The JPEG reader fills missing data with grey and reports no error. So the markers are followed here, from segment to
// segment and through the coded data, up to the end marker (ITU-T T.81, annex B).
Status CheckJpegIntegrity(std::span<const std::byte> bytes, const std::string& name) {
  constexpr unsigned kFill = 0xff, kStuffed = 0x00, kFirstAlone = 0xd0, kEndOfImage = 0xd9, kStartOfScan = 0xda;
  const auto at = [&](std::size_t i) { return std::to_integer<unsigned>(bytes[i]); };
  std::size_t i = 2;  // after the start marker
  while (i + 1 < bytes.size()) {
    const unsigned marker = at(i + 1);
    const bool in_scan = at(i) != kFill || marker == kStuffed || marker == kFill;
    if (!in_scan && marker == kEndOfImage) return Ok();
    if (in_scan) {
      ++i;
    } else if (marker >= kFirstAlone && marker < kStartOfScan) {
      i += 2;  // restart markers have no length
    } else if (i + 3 < bytes.size()) {
      i += 2 + at(i + 2) * 256 + at(i + 3);
    } else {
      break;
    }
  }
  return InputError("cannot read " + name + ": the JPEG file ends before its picture does; copy or save it again");
}

bool IsJpeg(const OIIO::ImageInput& input) { return input.format_name() == std::string_view("jpeg"); }

// Whether the file's bytes are looked at besides: by CheckJpegIntegrity, or for a profile, which OpenImageIO 2.4 does
// not give of WebP and HEIF.
bool NeedsBytes(const OIIO::ImageInput& input) {
  const std::string_view reader = input.format_name();
  return IsJpeg(input) || reader == "webp" || reader == "heif";
}

// `bytes`: all of the file, if NeedsBytes. Pixels of the display window outside an EXR's data window are transparent;
// those of the data window beyond the display window are cut off.
Expected<Picture> ReadFrom(OIIO::ImageInput& input, std::span<const std::byte> bytes, const std::string& name,
                           const std::string& view_layer, Profiles profiles, PictureLosses* losses) {
  if (IsJpeg(input)) SCUMBLE_RETURN_IF_ERROR(CheckJpegIntegrity(bytes, name));
  SCUMBLE_RETURN_IF_ERROR(SeekPicture(input, name, view_layer));
  const OIIO::ImageSpec spec = input.spec();
  SCUMBLE_RETURN_IF_ERROR(internal::CheckSize(spec, name));
  OIIO::ImageSpec display = spec;
  display.width = spec.full_width, display.height = spec.full_height;
  SCUMBLE_RETURN_IF_ERROR(internal::CheckSize(display, name));
  SCUMBLE_ASSIGN(const ColorChannels channels, FindColorChannels(spec, name, view_layer));
  const ChannelRange range = RangeOf(channels);
  // Read in one call, up to four channels of the largest picture.
  if (std::int64_t(range.count()) * spec.width * spec.height > 4 * kMaxPicturePixels) {
    return InputError(name + " has its colours " + std::to_string(range.count()) +
                      " channels apart, too many for its size; write R, G, B and A side by side");
  }
  const Decoder decoder{Within(channels, range), channels.a < 0 || IsStraight(spec, input.format_name()), losses};
  if (IsLinear(spec)) {
    return ReadPixels<float>(input, name, OIIO::TypeDesc::FLOAT, range,
                             [&](const float* pixel, std::uint16_t* out) { decoder.Linear(pixel, out); });
  }
  auto picture =
      ReadPixels<std::uint16_t>(input, name, OIIO::TypeDesc::UINT16, range,
                                [&](const std::uint16_t* pixel, std::uint16_t* out) { decoder.Encoded(pixel, out); });
  if (!picture || profiles == Profiles::kIgnore) return picture;
  if (const auto profile = ProfileOf(spec, bytes); !profile.empty()) {
    const int change = internal::ConvertToSrgb(profile, *picture);
    if (losses) losses->profile_change = change;
  }
  return picture;
}

PictureHeader HeaderOf(const OIIO::ImageSpec& spec) {
  const double per_unit = spec.get_float_attribute("XResolution", 0.0f);
  const std::string unit(spec.get_string_attribute("ResolutionUnit"));
  // The picture's, not the data window's.
  PictureHeader header{spec.full_width, spec.full_height, static_cast<int>(spec.format.size() * 8), 0};
  if (unit == "in" || unit == "inch") header.dpi = per_unit;
  if (unit == "cm") header.dpi = per_unit * 2.54;
  if (unit == "m") header.dpi = per_unit * 0.0254;
  header.dpi = internal::TrueDpi(header.dpi);
  return header;
}

}  // namespace

Expected<Picture> ReadPicture(const std::filesystem::path& path, const std::string& view_layer, Profiles profiles,
                              PictureLosses* losses) {
  SCUMBLE_ASSIGN(auto input, internal::OpenInput(path));
  std::vector<std::byte> bytes;
  if (NeedsBytes(*input)) {
    SCUMBLE_ASSIGN(bytes, ReadWholeFile(path));
  }
  SCUMBLE_ASSIGN(Picture stored, ReadFrom(*input, bytes, path.string(), view_layer, profiles, losses));
  return Upright(std::move(stored), input->spec().get_int_attribute("Orientation", 1));
}

Expected<PictureHeader> InspectPicture(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const auto input, internal::OpenInput(path));
  if (!SeekPicture(*input, path.string())) input->seek_subimage(0, 0);  // view layers have one size
  return HeaderOf(input->spec());
}

Expected<PictureHeader> InspectEncoded(std::span<const std::byte> bytes, const std::string& name) {
  OIIO::Filesystem::IOMemReader proxy(const_cast<std::byte*>(bytes.data()), bytes.size());
  SCUMBLE_ASSIGN(const auto input, internal::OpenInput(proxy, name));
  return HeaderOf(input->spec());
}

Expected<Picture> DecodePicture(std::span<const std::byte> bytes, const std::string& name, Profiles profiles) {
  OIIO::Filesystem::IOMemReader proxy(const_cast<std::byte*>(bytes.data()), bytes.size());
  SCUMBLE_ASSIGN(auto input, internal::OpenInput(proxy, name));
  return ReadFrom(*input, bytes, name, {}, profiles, nullptr);
}

Expected<StoredPicture> InspectStored(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const auto input, internal::OpenInput(path));
  const OIIO::ImageSpec& spec = input->spec();
  return StoredPicture{spec.full_width, spec.full_height, spec.nchannels, static_cast<int>(8 * spec.format.basesize()),
                       std::string(spec.get_string_attribute(kSettingsKey))};
}

// JPEG has no alpha: transparent pixels become white paper, blended in linear light.
Expected<std::vector<std::byte>> EncodeJpeg(const std::filesystem::path& path, const Picture& picture,
                                            const PictureWriteOptions& options) {
  constexpr int kChannels = 3;
  std::vector<std::uint8_t> bytes(std::size_t(kChannels) * picture.width * picture.height);
  for (std::size_t i = 0; i < bytes.size() / kChannels; ++i) {
    const std::uint16_t* pixel = picture.rgba.data() + 4 * i;
    const float alpha = static_cast<float>(pixel[3]) / 65535.0f;
    for (int c = 0; c < kChannels; ++c) {
      const std::uint16_t value =
          pixel[3] == 65535 ? pixel[c] : Srgb16FromLinear(Srgb16ToLinear(pixel[c]) * alpha + (1.0f - alpha));
      bytes[kChannels * i + c] = static_cast<std::uint8_t>((value + 128u) / 257u);
    }
  }
  OIIO::ImageSpec spec(picture.width, picture.height, kChannels, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("CompressionQuality", options.jpeg_quality);
  if (options.dpi > 0) {
    spec.attribute("XResolution", static_cast<float>(options.dpi));
    spec.attribute("YResolution", static_cast<float>(options.dpi));
    spec.attribute("ResolutionUnit", "in");
  }
  return internal::Encode(
      path, spec, [&](OIIO::ImageOutput& output) { return output.write_image(OIIO::TypeDesc::UINT8, bytes.data()); });
}

}  // namespace scumble::formats
