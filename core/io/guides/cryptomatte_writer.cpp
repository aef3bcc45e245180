#include "core/io/guides/cryptomatte_writer.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <functional>
#include <set>

#include "core/image/fragments.h"
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

namespace {

// An id of the guides with its share of a pixel.
struct Share {
  std::uint32_t id;
  float coverage;
};

// The shares of fragment `first` and those that follow it in its pixel, and of the surface at the pixel's centre: those
// of one id together, the largest first. `after` becomes the first fragment of another pixel.
std::vector<Share> SharesOf(const GuideSet& guides, Layer layer, std::size_t first, std::size_t& after) {
  const Fragments& fragments = *guides.fragments;
  const std::uint32_t pixel = fragments.pixel[first];
  std::vector<Share> shares = {{IdOf(guides.Plane(layer)[pixel]), guides.Plane(Layer::kCoverage)[pixel]}};
  for (after = first; after < fragments.count() && fragments.pixel[after] == pixel; ++after) {
    const Share one{IdOf(fragments.values.Plane(layer)[after]), fragments.values.Plane(Layer::kCoverage)[after]};
    shares[0].coverage -= one.coverage;
    const auto same = std::ranges::find(shares, one.id, &Share::id);
    if (same == shares.end()) {
      shares.push_back(one);
    } else {
      same->coverage += one.coverage;
    }
  }
  shares[0].coverage = std::max(0.0f, shares[0].coverage);  // a sum of floats
  std::ranges::stable_sort(shares, std::greater(), &Share::coverage);
  return shares;
}

}  // namespace

void MattePlanes::AddTo(const GuideSet& guides, ExrImage& image) {
  const auto add = [&](Layer layer, const std::string& matte, const char* shown,
                       const std::map<std::uint32_t, std::string>& names, Planes& planes) {
    if (!guides.Has(layer)) return;
    std::map<std::uint32_t, float> hashed;
    for (const auto& [id, name] : names) hashed[id] = std::bit_cast<float>(MatteBits(MatteHash(name)));
    const auto hash_of = [&](std::uint32_t id) {
      const auto found = hashed.find(id);
      return found == hashed.end() ? 0.0f : found->second;
    };
    const auto ids = guides.Plane(layer), coverage = guides.Plane(Layer::kCoverage);
    for (std::vector<float>& plane : planes) plane.assign(guides.pixel_count(), 0.0f);
    std::ranges::copy(coverage, planes[1].begin());
    std::uint32_t last = 0;
    float value = 0.0f;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (const std::uint32_t id = IdOf(ids[i]); id != last) last = id, value = hash_of(id);
      planes[0][i] = value;
    }
    for (std::size_t f = 0, after = 0; guides.fragments && f < guides.fragments->count(); f = after) {
      const std::size_t i = guides.fragments->pixel[f];
      const std::vector<Share> shares = SharesOf(guides, layer, f, after);
      for (std::size_t rank = 0; rank < std::min<std::size_t>(2, shares.size()); ++rank) {
        planes[2 * rank][i] = hash_of(shares[rank].id), planes[2 * rank + 1][i] = shares[rank].coverage;
      }
    }
    for (std::size_t c = 0; c < planes.size(); ++c) {
      image.channels.push_back({matte + "00." + "RGBA"[c], false, planes[c]});
    }
    image.channels.push_back({shown, false, ids});
    AddAttributes(matte, names, image);
  };
  add(Layer::kObject, "CryptoObject", kShownObjectIds, guides.object_names, objects_);
  add(Layer::kMaterial, "CryptoMaterial", kShownMaterialIds, guides.material_names, materials_);
}

}  // namespace scumble::internal
