#include "pipeline/finish_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <locale>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <system_error>
#include <tuple>
#include <utility>

#include "core/io/picture_file.h"
#include "core/style/color_ramp.h"
#include "core/style/finish_keys.h"
#include "finish/finish.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

// "#203050 #f0e0c0" as a row of pixels.
Expected<Picture> Swatches(const std::string& text) {
  std::vector<Rgb16> colors;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const auto color = ParseColor(word);
    if (!color) return InputError(fmt::format("{} is no colour: {}, with blanks between several", word, kColorForm));
    colors.push_back(*color);
  }
  Picture row(static_cast<int>(colors.size()), 1);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    std::copy_n(colors[i].begin(), 3, row.rgba.begin() + std::ptrdiff_t(4 * i));
    row.rgba[4 * i + 3] = 65535;
  }
  return row;
}

// "measured 0.5 0 0 0.01 0 0 0.01 0 0.01"
Expected<ColorSpread> MeasuredBefore(const std::string& text) {
  std::istringstream words(text.substr(kMeasuredPalette.size()));
  words.imbue(std::locale::classic());
  std::vector<double> numbers;
  for (double number; words >> number;) numbers.push_back(number);
  ColorSpread colors;
  if (!words.eof() || numbers.size() != colors.mean.size() + colors.covariance.size()) {
    return InputError(
        fmt::format("expected nine numbers after \"measured\", as a run prints them, found \"{}\"", text));
  }
  std::copy_n(numbers.begin(), colors.mean.size(), colors.mean.begin());
  std::copy(numbers.begin() + std::ptrdiff_t(colors.mean.size()), numbers.end(), colors.covariance.begin());
  return colors;
}

ColorSpread ColorsOfPainting(const Exemplar& exemplar) {
  const Picture& picture = exemplar.picture;
  if (!exemplar.is_sphere) return MeasureColors(picture);
  std::vector<std::uint8_t> sphere(picture.rgba.size() / 4);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double u = (x + 0.5) * 2.0 / picture.width - 1.0, v = (y + 0.5) * 2.0 / picture.height - 1.0;
      sphere[std::size_t(y) * std::size_t(picture.width) + std::size_t(x)] = u * u + v * v < 1.0;
    }
  }
  return MeasureColors(picture, sphere);
}

Expected<std::optional<ColorSpread>> ColorsOf(const std::string& source, const Style* style) {
  if (source.empty()) return std::optional<ColorSpread>();
  if (source == kPaintingPalette) {
    if (!style || !style->unpainted.empty() || style->exemplars.empty()) return std::optional<ColorSpread>();
    return std::optional(ColorsOfPainting(style->exemplars.front()));
  }
  if (source.rfind(kMeasuredPalette, 0) == 0) {
    SCUMBLE_ASSIGN(const ColorSpread colors, MeasuredBefore(source));
    return std::optional(colors);
  }
  SCUMBLE_ASSIGN(const Picture picture, IsPaletteFile(source) ? ReadPicture(source) : Swatches(source));
  return std::optional(MeasureColors(picture));
}

// The bundled textures of hatching, by name.
std::map<std::string, fs::path> HatchFiles(const RunContext& context) {
  std::map<std::string, fs::path> files;
  std::error_code failed;
  for (const fs::path& folder : context.DataFolders("finish/hatching")) {
    for (const auto& entry : fs::directory_iterator(folder, failed)) {
      if (entry.path().extension() == ".png") files.emplace(entry.path().stem().string(), entry.path());
    }
  }
  return files;
}

Expected<ColorRamp> RampOf(const std::string& source) {
  SCUMBLE_ASSIGN(const Picture picture, ReadPicture(source));
  Expected<ColorRamp> ramp = ColorRampOf(picture);
  if (!ramp) return InputError(source + ": " + ramp.error().message);
  return ramp;
}

Expected<HatchTexture> StrokesOf(const std::string& name, const RunContext& context) {
  const auto files = HatchFiles(context);
  const auto found = files.find(name);
  std::error_code failed;
  if (found == files.end() && !fs::is_regular_file(name, failed)) {
    std::vector<std::string> names{kPlainStrokes};
    for (const auto& [one, file] : files) names.push_back(one);
    return InputError(fmt::format("there are no strokes '{}'; there are {}, or name the file of a threshold texture",
                                  name, fmt::join(names, ", ")));
  }
  const fs::path file = found == files.end() ? fs::path(name) : found->second;
  SCUMBLE_ASSIGN(const Picture picture, ReadPicture(file));
  Expected<HatchTexture> texture = MakeHatchTexture(picture);
  if (!texture) return InputError(file.string() + ": " + texture.error().message);
  return texture;
}

}  // namespace

Status ReadFinishFiles(const Style* style, const RunContext& context, std::vector<FinishPass>& passes) {
  for (FinishPass& pass : passes) {
    const auto of_key = [&](const char* key, const Error& error) {
      return InputError(fmt::format("finish {}: {}: {}", pass.name, key, error.message));
    };
    if (auto* const palette = std::get_if<PalettePass>(&pass.effect)) {
      for (const auto& [key, source, colors] :
           {std::tuple("like", &palette->like, &palette->target), {"from", &palette->from, &palette->source}}) {
        auto found = ColorsOf(*source, style);
        if (!found) return of_key(key, found.error());
        *colors = *std::move(found);
      }
    }
    if (auto* const toon = std::get_if<ToonPass>(&pass.effect)) {
      if (!toon->ramp.empty() && !IsRampText(toon->ramp)) {  // a pass may come to show it at a later frame
        Expected<ColorRamp> ramp = RampOf(toon->ramp);
        if (!ramp) return of_key("ramp", ramp.error());
        toon->ramp_colors = std::make_shared<const ColorRamp>(*std::move(ramp));
      }
      SCUMBLE_RETURN_IF_ERROR(CheckRamp(pass));
    }
    if (auto* const hatch = std::get_if<HatchPass>(&pass.effect); hatch && hatch->strokes != kPlainStrokes) {
      Expected<HatchTexture> texture = StrokesOf(hatch->strokes, context);
      if (!texture) return of_key("strokes", texture.error());
      hatch->texture = std::make_shared<const HatchTexture>(*std::move(texture));
    }
  }
  return Ok();
}

std::vector<std::string> MaskFilesOf(const std::vector<FinishPass>& passes) {
  std::vector<std::string> files;
  for (const FinishPass& pass : passes) {
    if (!pass.mask.file.empty()) files.push_back(pass.mask.file.string());
  }
  return files;
}

std::vector<std::string> FilesOf(const std::vector<FinishPass>& passes) {
  std::vector<std::string> files;
  for (const FinishPass& pass : passes) {
    const auto* palette = std::get_if<PalettePass>(&pass.effect);
    for (const std::string& source : palette ? std::vector{palette->like, palette->from} : std::vector<std::string>()) {
      if (IsPaletteFile(source)) files.push_back(source);
    }
    const auto* toon = std::get_if<ToonPass>(&pass.effect);
    const bool has_ramp = toon && !toon->ramp.empty();
    if (has_ramp && !IsRampText(toon->ramp)) files.push_back(toon->ramp);
    const auto* hatch = std::get_if<HatchPass>(&pass.effect);
    if (std::error_code failed; hatch && fs::is_regular_file(hatch->strokes, failed)) files.push_back(hatch->strokes);
  }
  return files;
}

}  // namespace scumble
