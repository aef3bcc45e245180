// scumble compare --flip: the visibility of the difference.
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "apps/cli/app/json_text.h"
#include "apps/cli/verbs/compare_verb.h"
#include "core/io/channel_file.h"
#include "core/io/picture_file.h"
#include "measure/heat_map.h"
#include "measure/json_number.h"

namespace scumble {
namespace {

// A file's layers of light, those of R, G and B or of Y, as a list; "" where there are none or no file.
std::string LightLayers(const ChannelImage& image) {
  std::string list;
  for (const std::string& channel : image.names) {
    if (!channel.ends_with(".R") && !channel.ends_with(".Y")) continue;
    const std::string layer = LayerOfChannel(channel);
    if (!channel.ends_with(".Y") || !image.Find(layer + ".X")) list += (list.empty() ? "" : ", ") + layer;
  }
  return list;
}

// A file of layers is no picture; the user may have meant one of its layers.
Expected<Picture> ReadSeen(const std::string& path, PictureLosses& losses) {
  PictureLosses own;
  auto picture = ReadPicture(path, {}, Profiles::kApply, &own);
  losses.clamped += own.clamped, losses.nan += own.nan;
  if (picture) return picture;
  Error error = picture.error();
  const auto channels = error.kind == ErrorKind::kInput ? ReadChannels(path) : Expected<ChannelImage>(error);
  const std::string layers = channels ? LightLayers(*channels) : "";
  if (!layers.empty()) error.message += ", or by --layer one of its layers of light: " + layers;
  return error;
}

// Values outside of 0 … 1 are counted in `losses`.
Expected<LinearColors> LightOf(const ChannelImage& image, const std::string& layer, PictureLosses& losses) {
  LinearColors colors{image.width, image.height, {}};
  const char* const kNames[] = {".R", ".G", ".B"};
  const auto* const grey = image.Find(layer + ".X") ? nullptr : image.Find(layer + ".Y");
  for (std::size_t c = 0; c < 3; ++c) {
    const auto* const own = image.Find(layer + kNames[c]);
    if (!own && !grey) {
      const std::string layers = LightLayers(image);
      return InputError(image.name + " has no layer of light " + layer + ", with R, G and B or with Y; it has " +
                        (layers.empty() ? "none" : layers));
    }
    colors.planes[c] = own ? *own : *grey;
    if (!own && c > 0) continue;  // the same values
    for (const float value : colors.planes[c]) {
      losses.nan += std::isnan(value), losses.clamped += value < 0.0f || value > 1.0f;
    }
  }
  return colors;
}

Expected<FlipReport> OfLayer(const CompareVerb& verb, const std::string& layer, const FlipOptions& options,
                             PictureLosses& losses) {
  SCUMBLE_ASSIGN(const ChannelImage a, ReadChannels(verb.a));
  SCUMBLE_ASSIGN(const ChannelImage b, ReadChannels(verb.b));
  if (a.x != b.x || a.y != b.y) {
    return InputError(fmt::format("{} begins at ({}, {}) of its picture, {} at ({}, {}): compare the same crop of both",
                                  a.name, a.x, a.y, b.name, b.x, b.y));
  }
  SCUMBLE_ASSIGN(const LinearColors first, LightOf(a, layer, losses));
  SCUMBLE_ASSIGN(const LinearColors second, LightOf(b, layer, losses));
  return MeasureFlip(first, second, options);
}

Expected<FlipReport> OfPictures(const CompareVerb& verb, const FlipOptions& options, PictureLosses& losses) {
  SCUMBLE_ASSIGN(const Picture a, ReadSeen(verb.a, losses));
  SCUMBLE_ASSIGN(const Picture b, ReadSeen(verb.b, losses));
  return MeasureFlip(a, b, options);
}

}  // namespace

Expected<ExitCode> CompareByFlip(const CompareVerb& verb, const Globals& globals) {
  if (verb.options.layers.size() > 1) return UsageError("--flip compares one --layer, not several");
  if (verb.flip_fail && !(*verb.flip_fail >= 0.0)) {
    return UsageError(
        fmt::format("--fail {}: expected 0 or more, the largest mean FLIP that is no failure", *verb.flip_fail));
  }
  FlipOptions options = verb.flip_options;
  options.threads = globals.threads;
  const std::string layer = verb.options.layers.empty() ? "color" : verb.options.layers.front();
  PictureLosses losses;  // of both files together
  SCUMBLE_ASSIGN(const FlipReport report,
                 layer == "color" ? OfPictures(verb, options, losses) : OfLayer(verb, layer, options, losses));
  if (losses.clamped > 0) {
    globals.Note(fmt::format("{} values of {} lie outside of 0 … 1 and count as its ends", losses.clamped, layer));
  }
  if (losses.nan > 0) globals.Warn(fmt::format("{} values of {} are no numbers and count as 0", losses.nan, layer));
  if (!verb.heat_map.empty()) {
    const Picture map = ValueHeatMap(report.map, report.width, report.height, 1.0);
    SCUMBLE_RETURN_IF_ERROR(WritePicture(verb.heat_map, map));
    globals.Note(verb.heat_map + ": yellow is a FLIP of 1");
  }
  const bool fails = verb.flip_fail && (!(report.mean <= *verb.flip_fail) || losses.nan > 0);
  nlohmann::ordered_json json = {{"a", verb.a},
                                 {"b", verb.b},
                                 {"layer", layer},
                                 {"flip", report.mean},
                                 {"flip_max", report.max},
                                 {"rms", report.rms},
                                 {"clamped_values", losses.clamped},
                                 {"nan_values", losses.nan},
                                 {"pixels_per_degree", options.pixels_per_degree}};
  std::string text = fmt::format("FLIP mean {:.6f}, most {:.6f}, at {:.2f} pixels per degree\nRMS  {:.6f} of 1\n",
                                 report.mean, report.max, options.pixels_per_degree, report.rms);
  if (verb.flip_fail) {
    const char* const verdict = VerdictName(fails ? Verdict::kFail : Verdict::kEqual);
    json["fail"] = JsonNumber(*verb.flip_fail), json["verdict"] = verdict;
    text += fmt::format("{}: the mean may be {}{}\n", verdict, *verb.flip_fail,
                        losses.nan > 0 ? ", and every value must be a number" : "");
  }
  Print(globals.json ? JsonText(json) : text);
  return fails ? ExitCode::kDiffers : ExitCode::kOk;
}

}  // namespace scumble
