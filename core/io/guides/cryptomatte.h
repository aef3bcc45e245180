// Cryptomatte as Blender and other renderers write it: ids with coverage in ranks, and in the header a manifest with
// their names. Friedman and Jones, "Fully automatic ID mattes with support for motion blur and transparency", SIGGRAPH
// 2015 posters; the file's form is Psyop's specification 1.2.0.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"

namespace scumble {

// The meaning of a channel like "ViewLayer.CryptoObject00.r". A channel file holds two ranks: r and b are ids, g and a
// their coverage.
struct MatteChannel {
  std::string matte;   // "ViewLayer.CryptoObject", as cryptomatte/KEY/name has it
  std::string prefix;  // "ViewLayer": the view layer, or empty
  Layer layer;         // kObject or kMaterial
  int index;           // 2 · rank, and one more where it is coverage
};

// The ids of kObject and kMaterial once more, beside Cryptomatte, under names that every compositor shows: Blender 3
// shows no channel called "ID", but this one as the pass "object_id". A second channel of the pass "object" would make
// a colour of it in Blender 4, which shows "object.ID" too.
inline constexpr const char* kShownObjectIds = "object_id.X";
inline constexpr const char* kShownMaterialIds = "material_id.X";

// "CryptoObject" and "CryptoMaterial" in upper or lower case, with or without underscores. Nothing for any other name,
// CryptoAsset included.
std::optional<MatteChannel> ParseMatteChannel(std::string_view name);

// The 32-bit MurmurHash3 with seed 0, which makes ids of names.
std::uint32_t MatteHash(std::string_view name);

// The bits of the float that stands for a hash in the file: exponents of denormal, infinite and NaN numbers are avoided
// ("uint32_to_float32").
std::uint32_t MatteBits(std::uint32_t hash);

// The manifest of a file in OpenEXR's compression pxr24, which rounds each float to 24 bits: names by what is left of
// their ids. Two names with equal rests are an error. `name` stands for the file.
Expected<std::map<std::uint32_t, std::string>> RoundedAsPxr24(const std::map<std::uint32_t, std::string>& manifest,
                                                              const std::string& name);

// Names by the bits of their ids. Reads {"name":"8 hex digits", …}, with JSON's escapes or, as Blender 3.4 writes them,
// with unescaped quotation marks and backslashes. Of all readings of an entry, the one that gives its hash counts.
// Empty manifests ("", "}" and "{}") give no names; other text is an error. `name` stands for the file.
Expected<std::map<std::uint32_t, std::string>> ReadManifest(std::string_view text, const std::string& name);

// Gives each pixel the id of the name with the largest coverage, and keeps the names that occur. `ranks` are the planes
// of MatteChannel::index 0 … 3; planes that the file lacks are empty. An id that the manifest lacks is named "unnamed
// 1a2b3c4d" by its hash's bits. Uncovered pixels get 0. More than 100,000 such ids are noise: an error. `name` stands
// for the file.
Status NameMattes(std::span<const std::vector<float>> ranks, const std::map<std::uint32_t, std::string>& manifest,
                  const std::string& name, std::span<float> ids, std::map<std::uint32_t, std::string>& names);

// The total coverage of each pixel, in [0, 1], from the planes of all ranks. 1 where the last rank is in use: the file
// may lack room for further ones.
void MatteCoverage(std::span<const std::vector<float>> ranks, std::span<float> coverage);

}  // namespace scumble
