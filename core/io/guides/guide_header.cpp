#include "core/io/guides/guide_header.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>

namespace scumble::internal {

std::string NamesToText(const std::map<std::uint32_t, std::string>& names) {
  std::string text;
  for (const auto& [id, name] : names) {
    text += std::to_string(id) + ' ';
    for (char c : name) {
      if (c == '\\')
        text += "\\\\";
      else if (c == '\n')
        text += "\\n";
      else
        text += c;
    }
    text += '\n';
  }
  return text;
}

std::map<std::uint32_t, std::string> NamesFromText(const std::string& text) {
  std::map<std::uint32_t, std::string> names;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.find(' ');
    if (space == std::string::npos) continue;
    const auto id = static_cast<std::uint32_t>(std::strtoul(line.c_str(), nullptr, 10));
    std::string name;
    for (std::size_t i = space + 1; i < line.size(); ++i) {
      if (line[i] == '\\' && i + 1 < line.size()) {
        ++i;
        name += line[i] == 'n' ? '\n' : line[i];
      } else {
        name += line[i];
      }
    }
    names[id] = std::move(name);
  }
  return names;
}

std::string MatrixToText(const glm::dmat4& matrix) {
  std::string text;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      char number[40];
      std::snprintf(number, sizeof number, "%s%.17g", text.empty() ? "" : " ", matrix[column][row]);
      text += number;
    }
  }
  return text;
}

std::optional<glm::dmat4> MatrixFromText(const std::string& text) {
  std::istringstream numbers(text);
  glm::dmat4 matrix;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!(numbers >> matrix[column][row])) return std::nullopt;
    }
  }
  return matrix;
}

std::string ListOfChannels(const std::vector<std::string>& names) {
  constexpr std::size_t kListed = 40;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kListed); ++i) list += (i ? ", " : "") + names[i];
  return names.size() > kListed ? list + ", …" : list;
}

void TakeHeader(const std::map<std::string, std::string>& texts, GuideSet& guides) {
  for (const auto& [name, value] : texts) {
    if (name.starts_with("scumble:")) guides.attributes[name] = value;
  }
  const auto take = [&](const char* name) {
    const auto found = guides.attributes.extract(name);
    return found.empty() ? std::string() : found.mapped();
  };
  guides.object_names = NamesFromText(take("scumble:objects"));
  guides.material_names = NamesFromText(take("scumble:materials"));
  guides.object_styles = NamesFromText(take("scumble:objectStyles"));
  guides.material_styles = NamesFromText(take("scumble:materialStyles"));
  const std::string camera = take("scumble:camera");
  const auto view = MatrixFromText(take("scumble:viewFromWorld"));
  const auto clip = MatrixFromText(take("scumble:clipFromView"));
  if (view && clip) guides.camera = GuideCamera{camera, *view, *clip};
}

}  // namespace scumble::internal
