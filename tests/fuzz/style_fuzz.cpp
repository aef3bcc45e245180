// A style.toml beside a picture lit.png; behind its first NUL, one --set a line.
#include <glm/glm.hpp>

#include "io/picture_file.h"
#include "style/style_file.h"
#include "style/style_keyframes.h"
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

void Run(Bytes input) {
  static const bool has_picture = WritePicture(Folder() / "lit.png", Picture(4, 4)).ok();
  SCUMBLE_CHECK(has_picture);
  const std::string_view text = AsText(input);
  const std::size_t end = std::min(text.find('\0'), text.size());
  const auto path = InFile("style.toml", input.first(end));
  Expected<Style> style = LoadStyle(path, Lines(text.substr(std::min(end + 1, text.size()))));
  CheckRefusal(style, 40000);  // a value is quoted as it stands
  if (!style) return;
  CheckRefusal(LayersOverTime(*style));
  for (const std::int64_t frame : {-1000000000ll, 0ll, 7ll, 1000000000ll}) CheckRefusal(SetStyleFrame(*style, frame));
}

}  // namespace
SCUMBLE_FUZZ_TARGET(style, Run)
}  // namespace scumble::fuzz
