// A style.toml beside a picture lit.png, guides of a template and guides of a scene; behind its first NUL, one --set a
// line.
#include <algorithm>
#include <glm/glm.hpp>

#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/style/sphere_template.h"
#include "core/style/style_file.h"
#include "core/style/style_keyframes.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {
namespace {

std::vector<std::string> Lines(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty() && lines.size() < 8) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// A picture of 4 × 4, guides of a scene of its size, and of a sphere of 2 × 2 whose template has it.
bool WriteFiles() {
  const auto guides_of = [](int size) {
    GuideSet guides(size, size);
    for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kLuminance, Layer::kLpeLDE}) guides.Add(layer);
    return guides;
  };
  GuideSet sphere = guides_of(2);
  sphere.attributes[kMarginAttribute] = "1";
  Picture white(4, 4);
  std::fill(white.rgba.begin(), white.rgba.end(), std::uint16_t{65535});
  return WritePicture(Folder() / "lit.png", white) && WriteGuides(Folder() / "scene.exr", guides_of(4)) &&
         WriteGuides(Folder() / "sphere.exr", sphere);
}

void FuzzStyle(Bytes input) {
  static const bool has_files = WriteFiles();
  SCUMBLE_CHECK(has_files);
  const std::string_view text = AsText(input);
  const std::size_t end = std::min(text.find('\0'), text.size());
  const auto path = InFile("style.toml", input.first(end));
  const auto sets = ParseStyleOverrides(Lines(text.substr(std::min(end + 1, text.size()))));
  CheckRefusal(sets, 1000 + text.size());
  if (!sets) return;
  Expected<Style> style = LoadStyle(path, *sets);
  CheckRefusal(style, 40000);  // a value is quoted as it stands
  if (!style) return;
  CheckRefusal(LayersOverTime(*style));
  for (const std::int64_t frame : {-1000000000ll, 0ll, 7ll, 1000000000ll}) CheckRefusal(SetStyleFrame(*style, frame));
}

}  // namespace
SCUMBLE_FUZZ_TARGET(style, FuzzStyle)
}  // namespace scumble::fuzz
