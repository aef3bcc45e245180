// Ids, names and cameras as text in a guide file's header. Private to core/io.
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

// "R, G, B": for people, so only the first of very many channels.
std::string ListOfChannels(const std::vector<std::string>& names);

// Puts the header's texts that begin with "scumble:" (names, camera and attributes) into `guides`.
void TakeHeader(const std::map<std::string, std::string>& texts, GuideSet& guides);

}  // namespace scumble::internal
