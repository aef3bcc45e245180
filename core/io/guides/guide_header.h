// How ids, names and cameras are written into a guide file's header as text. Not for other folders.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"

namespace scumble::internal {

// "id name" a line; backslash and line feed in a name are escaped, so any name survives.
std::string NamesToText(const std::map<std::uint32_t, std::string>& names);
std::map<std::uint32_t, std::string> NamesFromText(const std::string& text);

// 16 numbers, column by column, with the 17 digits that keep a double exact.
std::string MatrixToText(const glm::dmat4& matrix);
std::optional<glm::dmat4> MatrixFromText(const std::string& text);

// "R, G, B": for people, so of very many channels the first ones.
std::string ListOfChannels(const std::vector<std::string>& names);

// What a header's texts that begin with "scumble:" say, names, camera and attributes, put into `guides`.
void TakeHeader(const std::map<std::string, std::string>& texts, GuideSet& guides);

}  // namespace scumble::internal
