#include "core/io/existing_output.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>
#include <string>
#include <system_error>

#include "core/io/atomic_file.h"
#include "core/io/format_dispatch.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/io/png/png_integrity.h"
#include "core/io/png/png_reader.h"

namespace scumble {
namespace {

Status CheckNotEmpty(const std::filesystem::path& path) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) return InputError(path.string() + " is not there");
  if (std::filesystem::file_size(path, failed) == 0 || failed) return InputError(path.string() + " is empty");
  return Ok();
}

std::string Text(int width, int height) { return std::to_string(width) + "×" + std::to_string(height); }

Status CheckSide(const std::filesystem::path& path, int width, int height, int wanted_width, int wanted_height) {
  if ((wanted_width == 0 || width == wanted_width) && (wanted_height == 0 || height == wanted_height)) return Ok();
  return InputError(path.string() + " is " + Text(width, height) + ", not " + Text(wanted_width, wanted_height));
}

// Splits "seed 0; show chunks" into parts, by their first words.
std::map<std::string, std::string> Parts(const std::string& settings) {
  std::map<std::string, std::string> parts;
  std::istringstream stream(settings);
  for (std::string part; std::getline(stream, part, ';');) {
    part.erase(0, part.find_first_not_of(' '));
    const std::size_t space = part.find(' ');
    if (space != std::string::npos) parts[part.substr(0, space)] = part.substr(space + 1);
  }
  return parts;
}

// Values of settings that older versions did not record; kAnySetting where the value is unknown.
const std::map<std::string, std::string>& UnrecordedSettings() {
  static const std::map<std::string, std::string> kValues = {{"upsample", "1"},
                                                             {"fps", kAnySetting},
                                                             {"measured", kAnySetting},
                                                             {"samples", kAnySetting},
                                                             {"finish_measures", kAnySetting},
                                                             {"finish_measured", kAnySetting}};
  return kValues;
}

}  // namespace

Status CheckSameSettings(const std::filesystem::path& path, const std::string& found, const std::string& wanted) {
  if (found.empty() || wanted.empty()) return Ok();
  const auto there = Parts(found), here = Parts(wanted);
  const auto value_of = [](const std::map<std::string, std::string>& parts, const std::string& name) {
    if (const auto part = parts.find(name); part != parts.end()) return part->second;
    const auto usual = UnrecordedSettings().find(name);
    return usual == UnrecordedSettings().end() ? std::string("untold") : usual->second;
  };
  auto all = here;
  all.insert(there.begin(), there.end());
  for (const auto& [name, any] : all) {
    const std::string other = value_of(there, name), value = value_of(here, name);
    if (value == other || value == kAnySetting || other == kAnySetting) continue;
    return InputError(path.string() + " was made with other settings (" + name + " " + other + ", not " + value + ")");
  }
  return Ok();
}

namespace {

// A plain PNG needs no module.
Expected<StoredPicture> Inspect(const std::filesystem::path& path) {
  if (internal::IsPngFile(path)) {
    SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path));
    SCUMBLE_RETURN_IF_ERROR(internal::CheckPngIntegrity(bytes, path.string()));
    if (auto stored = internal::InspectPlainPng(bytes)) return *std::move(stored);
  }
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormatsToRead(path));
  return formats->inspect_stored(path);
}

}  // namespace

int PictureChannels(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".jpg" || ending == ".jpeg" ? 3 : 4;
}

Status CheckWholePicture(const std::filesystem::path& path, const PictureShape& shape) {
  SCUMBLE_RETURN_IF_ERROR(CheckNotEmpty(path));
  SCUMBLE_ASSIGN(const StoredPicture stored, Inspect(path));
  SCUMBLE_RETURN_IF_ERROR(CheckSide(path, stored.width, stored.height, shape.width, shape.height));
  if (shape.channels != 0 && stored.channels != shape.channels) {
    return InputError(path.string() + " has " + std::to_string(stored.channels) + " channels, not " +
                      std::to_string(shape.channels));
  }
  if (shape.bits != 0 && stored.bits != shape.bits) {
    return InputError(path.string() + " has " + std::to_string(stored.bits) + " bits a channel, not " +
                      std::to_string(shape.bits));
  }
  SCUMBLE_RETURN_IF_ERROR(CheckSameSettings(path, stored.settings, shape.settings));
  if (const auto read = ReadPicture(path); !read) return read.error();
  return Ok();
}

Status CheckWholeGuides(const std::filesystem::path& path, const GuideShape& shape) {
  SCUMBLE_RETURN_IF_ERROR(CheckNotEmpty(path));
  SCUMBLE_ASSIGN(const GuideFileInfo info, InspectGuides(path));
  SCUMBLE_RETURN_IF_ERROR(CheckSide(path, info.width, info.height, shape.width, shape.height));
  const auto found = info.layers.find("");
  const LayerSet held = found == info.layers.end() ? LayerSet() : found->second;
  if (held != shape.layers) {
    return InputError(path.string() + " holds " + held.ToString() + ", not " + shape.layers.ToString());
  }
  if (info.has_cryptomatte != shape.cryptomatte) {
    return InputError(path.string() + (shape.cryptomatte ? " has no Cryptomatte" : " has a Cryptomatte"));
  }
  const bool has_color = std::any_of(AllLayers().begin(), AllLayers().end(),
                                     [&](const LayerInfo& layer) { return layer.is_color && held.Has(layer.layer); });
  if (has_color && info.has_half != shape.half) {
    return InputError(path.string() + " has its colours in " + (info.has_half ? "half floats" : "floats") + ", not " +
                      (shape.half ? "half floats" : "floats"));
  }
  const auto settings = info.header.attributes.find(kSettingsKey);
  if (settings != info.header.attributes.end()) {
    SCUMBLE_RETURN_IF_ERROR(CheckSameSettings(path, settings->second, shape.settings));
  }
  GuideReadOptions options;
  options.required = shape.layers;
  if (const auto read = ReadGuides(path, options); !read) return read.error();
  return Ok();
}

}  // namespace scumble
