#include "core/io/guides/cryptomatte_writer.h"

#include <bit>
#include <cstdio>
#include <set>

#include "core/io/guides/cryptomatte.h"

namespace scumble::internal {
namespace {

std::string HexOf(std::uint32_t value) {
  char text[9];
  std::snprintf(text, sizeof text, "%08x", static_cast<unsigned>(value));
  return text;
}

// A JSON string (RFC 8259, section 7).
std::string QuotedJson(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20) {
      quoted += "\\u" + HexOf(byte).substr(4);
      continue;
    }
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

void AddAttributes(const std::string& matte, const std::map<std::uint32_t, std::string>& names, ExrImage& image) {
  const std::string start = "cryptomatte/" + HexOf(MatteHash(matte)).substr(0, 7) + "/";
  image.texts[start + "name"] = matte;
  image.texts[start + "hash"] = "MurmurHash3_32";
  image.texts[start + "conversion"] = "uint32_to_float32";
  image.texts[start + "manifest"] = ManifestToText(names);
}

}  // namespace

std::string ManifestToText(const std::map<std::uint32_t, std::string>& names) {
  std::set<std::string> sorted;
  for (const auto& [id, name] : names) sorted.insert(name);
  std::string text = "{";
  for (const std::string& name : sorted) {
    text += (text.size() > 1 ? "," : "") + QuotedJson(name) + ":\"" + HexOf(MatteHash(name)) + '"';
  }
  return text + "}";
}

void MattePlanes::AddTo(const GuideSet& guides, ExrImage& image) {
  zero_.assign(guides.pixel_count(), 0.0f);
  const auto add = [&](Layer layer, const std::string& matte, const std::map<std::uint32_t, std::string>& names,
                       std::vector<float>& ids) {
    if (!guides.Has(layer)) return;
    std::map<std::uint32_t, float> hashed;
    for (const auto& [id, name] : names) hashed[id] = std::bit_cast<float>(MatteBits(MatteHash(name)));
    const auto plane = guides.Plane(layer);
    ids.assign(plane.size(), 0.0f);
    std::uint32_t last = 0;
    float value = 0.0f;
    for (std::size_t i = 0; i < plane.size(); ++i) {
      if (const std::uint32_t id = IdOf(plane[i]); id != last) {
        const auto found = hashed.find(id);
        last = id, value = found == hashed.end() ? 0.0f : found->second;
      }
      ids[i] = value;
    }
    const std::string start = matte + "00.";
    image.channels.push_back({start + "R", false, ids});
    image.channels.push_back({start + "G", false, guides.Plane(Layer::kCoverage)});
    image.channels.push_back({start + "B", false, zero_});
    image.channels.push_back({start + "A", false, zero_});
    AddAttributes(matte, names, image);
  };
  add(Layer::kObject, "CryptoObject", guides.object_names, objects_);
  add(Layer::kMaterial, "CryptoMaterial", guides.material_names, materials_);
}

}  // namespace scumble::internal
