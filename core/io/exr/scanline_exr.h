// The plain EXR files that Scumble itself writes, by OpenEXR alone: one part of scan lines, flat, whose data fills its
// window. This code works without OpenImageIO's libraries, which take a fifth of a second to load. Other kinds of EXR
// are read by the module of core/io/format_dispatch.h. Private to core/io.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"

namespace scumble::internal {

// A channel to write: width · height values in rows, stored as floats or, if `half`, rounded by ToHalf. The caller owns
// the values.
struct ExrChannel {
  std::string name;
  bool half = false;
  std::span<const float> values;
};

// An attribute of a type that OpenEXR does not know; programs that do not know it either pass it over.
struct ExrBlob {
  std::string type;
  std::vector<std::byte> bytes;
};

struct ExrImage {
  int width = 0, height = 0;
  std::vector<ExrChannel> channels;            // with different names, in any order
  std::string compression = "zip";             // a name that IsLossless accepts
  std::map<std::string, std::string> texts;    // attributes
  std::map<std::string, glm::dmat4> matrices;  // attributes, rounded to float; for row vectors, as OpenEXR has them
  std::map<std::string, ExrBlob> blobs;        // attributes
};

// The bytes of the file, the same for any number of threads. The library's failures become errors that name the file.
Expected<std::vector<std::byte>> EncodeExr(const std::string& name, const ExrImage& image);

// The header of a plain file.
struct ExrHeader {
  int width = 0, height = 0;
  std::map<std::string, bool> channels;      // by name, in the file's order: whether it is stored in half floats
  std::map<std::string, std::string> texts;  // attributes
  std::map<std::string, ExrBlob> blobs;      // attributes of types that OpenEXR does not know
};

// Returns a plane of width · height floats for a channel; empty: the channel is not read.
using PlaneFor = std::function<std::span<float>(const std::string& channel)>;

// Reads the header and passes it to `look`. If `look` returns planes, reads the pixels into them. Empty if the file is
// not plain, is damaged or is no EXR, or if `look` returns nothing: then the module reads the file or reports what is
// wrong.
std::optional<ExrHeader> ReadPlainExr(const std::filesystem::path& path,
                                      const std::function<std::optional<PlaneFor>(const ExrHeader&)>& look);

}  // namespace scumble::internal
