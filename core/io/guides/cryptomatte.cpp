#include "core/io/guides/cryptomatte.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdio>
#include <cstdlib>

namespace scumble {
namespace {

constexpr int kMaxLevels = 32;  // two ranks each; Blender offers 8

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::size_t SkipSpace(std::string_view text, std::size_t at) {
  while (at < text.size() && IsSpace(text[at])) ++at;
  return at;
}

void AppendUtf8(std::uint32_t code, std::string& text) {
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xc0 | code >> 6);
    text += static_cast<char>(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    text += static_cast<char>(0xe0 | code >> 12);
    text += static_cast<char>(0x80 | (code >> 6 & 0x3f));
    text += static_cast<char>(0x80 | (code & 0x3f));
  } else {
    text += static_cast<char>(0xf0 | code >> 18);
    text += static_cast<char>(0x80 | (code >> 12 & 0x3f));
    text += static_cast<char>(0x80 | (code >> 6 & 0x3f));
    text += static_cast<char>(0x80 | (code & 0x3f));
  }
}

std::optional<std::uint32_t> Hex(std::string_view digits) {
  std::uint32_t value = 0;
  for (const char c : digits) {
    if (!std::isxdigit(static_cast<unsigned char>(c))) return std::nullopt;
    value = value << 4 | static_cast<std::uint32_t>(c <= '9' ? c - '0' : (c | 32) - 'a' + 10);
  }
  return value;
}

// Resolves JSON's escapes. Empty if an escape is unknown to JSON.
std::optional<std::string> Unescape(std::string_view raw) {
  constexpr std::string_view kFrom = "\"\\/bfnrt", kTo = "\"\\/\b\f\n\r\t";
  std::string text;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (raw[i] != '\\') {
      text += raw[i];
      continue;
    }
    if (++i >= raw.size()) return std::nullopt;
    if (raw[i] != 'u') {
      const std::size_t place = kFrom.find(raw[i]);
      if (place == std::string_view::npos) return std::nullopt;
      text += kTo[place];
      continue;
    }
    const auto unit = [&](std::size_t at) {
      return at + 4 <= raw.size() ? Hex(raw.substr(at, 4)) : std::optional<std::uint32_t>();
    };
    auto code = unit(i + 1);
    if (!code) return std::nullopt;
    i += 4;
    if (*code >= 0xd800 && *code < 0xdc00) {  // the first half of a pair
      const auto low = raw.substr(i + 1, 2) == "\\u" ? unit(i + 3) : std::optional<std::uint32_t>();
      if (!low || *low < 0xdc00 || *low >= 0xe000) return std::nullopt;
      code = 0x10000 + ((*code - 0xd800) << 10) + (*low - 0xdc00);
      i += 6;
    }
    AppendUtf8(*code, text);
  }
  return text;
}

// Blender's and other renderers' names: "CryptoObject", "crypto_object", "CRYPTO_MATERIAL".
std::optional<Layer> LayerOfMatte(std::string_view kind) {
  std::string letters;
  for (const char c : kind) {
    if (c != '_') letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  if (letters == "cryptoobject") return Layer::kObject;
  if (letters == "cryptomaterial") return Layer::kMaterial;
  return std::nullopt;
}

struct Entry {
  std::string name;
  std::uint32_t hash = 0;
  std::size_t end = 0;  // after the hash's closing quotation mark
};

// The hash after a quotation mark that may close a name: `" : "1a2b3c4d"` and a comma or the closing brace.
std::optional<Entry> HashAt(std::string_view text, std::size_t quote) {
  std::size_t at = SkipSpace(text, quote + 1);
  if (at >= text.size() || text[at] != ':') return std::nullopt;
  at = SkipSpace(text, at + 1);
  if (at + 10 > text.size() || text[at] != '"' || text[at + 9] != '"') return std::nullopt;
  const auto hash = Hex(text.substr(at + 1, 8));
  const std::size_t behind = SkipSpace(text, at + 10);
  if (!hash || behind >= text.size() || (text[behind] != ',' && text[behind] != '}')) return std::nullopt;
  return Entry{"", *hash, at + 10};
}

// The entry whose name begins at `start`. Names may hold unescaped quotation marks, so every mark is tried. Where no
// reading gives the hash (another hash, or a damaged name), the first reading counts.
std::optional<Entry> NextEntry(std::string_view text, std::size_t start) {
  constexpr std::size_t kLongestName = 256;  // Blender's names have 63 bytes; bounds the search in hostile text
  std::optional<Entry> first;
  for (std::size_t quote = start; (quote = text.find('"', quote)) != std::string_view::npos; ++quote) {
    if (first && quote - start > kLongestName) break;
    auto entry = HashAt(text, quote);
    if (!entry) continue;
    const std::string_view raw = text.substr(start, quote - start);
    entry->name = raw;
    if (MatteHash(raw) == entry->hash) return entry;
    const auto unescaped = raw.find('\\') == std::string_view::npos ? std::nullopt : Unescape(raw);
    if (unescaped) entry->name = *unescaped;
    if (unescaped && MatteHash(*unescaped) == entry->hash) return entry;
    if (!first) first = std::move(entry);
  }
  return first;
}

// The rank with the largest coverage. Ranks should be sorted, but not every program sorts them.
std::uint32_t LargestId(std::span<const std::vector<float>> ranks, std::size_t i) {
  std::uint32_t id = 0;
  float most = 0.0f;
  for (std::size_t r = 0; r + 1 < ranks.size() && r < 4; r += 2) {
    if (ranks[r].empty() || ranks[r + 1].empty() || !(ranks[r + 1][i] > most)) continue;
    most = ranks[r + 1][i];
    id = std::bit_cast<std::uint32_t>(ranks[r][i]);
  }
  return id;
}

}  // namespace

std::optional<MatteChannel> ParseMatteChannel(std::string_view name) {
  constexpr std::string_view kComponents = "rgba";
  if (name.size() < 5 || name[name.size() - 2] != '.') return std::nullopt;
  const char last = static_cast<char>(std::tolower(static_cast<unsigned char>(name.back())));
  const std::size_t component = kComponents.find(last);
  const std::string_view digits = name.substr(name.size() - 4, 2), matte = name.substr(0, name.size() - 4);
  if (component == std::string_view::npos || !std::isdigit(static_cast<unsigned char>(digits[0])) ||
      !std::isdigit(static_cast<unsigned char>(digits[1]))) {
    return std::nullopt;
  }
  const int level = (digits[0] - '0') * 10 + (digits[1] - '0');
  if (level >= kMaxLevels) return std::nullopt;
  const std::size_t dot = matte.rfind('.');
  const std::string_view kind = dot == std::string_view::npos ? matte : matte.substr(dot + 1);
  const std::optional<Layer> layer = LayerOfMatte(kind);
  if (!layer) return std::nullopt;
  return MatteChannel{std::string(matte), std::string(dot == std::string_view::npos ? "" : matte.substr(0, dot)),
                      *layer, 4 * level + static_cast<int>(component)};
}

std::uint32_t MatteHash(std::string_view name) {
  constexpr std::uint32_t c1 = 0xcc9e2d51, c2 = 0x1b873593;
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(name[i])); };
  std::uint32_t h = 0;
  std::size_t i = 0;
  for (; i + 4 <= name.size(); i += 4) {
    const std::uint32_t k = byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24;
    h ^= std::rotl(k * c1, 15) * c2;
    h = std::rotl(h, 13) * 5 + 0xe6546b64;
  }
  std::uint32_t tail = 0;
  for (std::size_t j = name.size(); j > i; --j) tail = tail << 8 | byte(j - 1);
  if (i < name.size()) h ^= std::rotl(tail * c1, 15) * c2;
  h ^= static_cast<std::uint32_t>(name.size());
  h = (h ^ h >> 16) * 0x85ebca6b;
  h = (h ^ h >> 13) * 0xc2b2ae35;
  return h ^ h >> 16;
}

std::uint32_t MatteBits(std::uint32_t hash) {
  const std::uint32_t exponent = std::clamp<std::uint32_t>(hash >> 23 & 255, 1, 254);
  return (hash & 0x807fffff) | exponent << 23;
}

Expected<std::map<std::uint32_t, std::string>> RoundedAsPxr24(const std::map<std::uint32_t, std::string>& manifest,
                                                              const std::string& name) {
  std::map<std::uint32_t, std::string> rounded;
  for (const auto& [bits, text] : manifest) {
    // To the nearest, unless that were infinite.
    const std::uint32_t size = bits & 0x7fffffff, nearest = (size + (size & 0x80)) & 0xffffff00;
    const std::uint32_t rest = nearest < 0x7f800000 ? nearest : size & 0xffffff00;
    const auto [other, is_new] = rounded.emplace((bits & 0x80000000) | rest, text);
    if (is_new) continue;
    return InputError(name + ": its compression pxr24 is lossy and leaves one Cryptomatte id for '" + other->second +
                      "' and '" + text + "'; render it again with the codec ZIP");
  }
  return rounded;
}

Expected<std::map<std::uint32_t, std::string>> ReadManifest(std::string_view text, const std::string& name) {
  std::map<std::uint32_t, std::string> names;
  std::size_t at = SkipSpace(text, 0);
  if (at == text.size() || text.substr(at) == "}") return names;  // Cycles writes "}" for a scene without objects
  const auto damaged = [&](std::size_t where) {
    return InputError(name + ": its Cryptomatte manifest is damaged at byte " + std::to_string(where) +
                      ": expected {\"name\":\"8 hex digits\", …}; render it again, or without the Cryptomatte passes");
  };
  if (text[at] != '{') return damaged(at);
  at = SkipSpace(text, at + 1);
  if (at < text.size() && text[at] == '}') return names;
  while (true) {
    if (at >= text.size() || text[at] != '"') return damaged(at);
    const auto entry = NextEntry(text, at + 1);
    if (!entry) return damaged(at);
    names.emplace(MatteBits(entry->hash), entry->name);
    at = SkipSpace(text, entry->end);
    if (text[at] == '}') return names;
    at = SkipSpace(text, at + 1);  // the comma
  }
}

Status NameMattes(std::span<const std::vector<float>> ranks, const std::map<std::uint32_t, std::string>& manifest,
                  const std::string& name, std::span<float> ids, std::map<std::uint32_t, std::string>& names) {
  constexpr std::size_t kMostUnnamed = 100000;
  std::vector<std::uint32_t> seen(ids.size());
  std::map<std::uint32_t, std::string> all = manifest;
  std::uint32_t last = 0, last_id = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    seen[i] = LargestId(ranks, i);
    if (seen[i] == 0 || seen[i] == last || all.count(last = seen[i])) continue;
    char text[24];
    std::snprintf(text, sizeof text, "unnamed %08x", static_cast<unsigned>(seen[i]));
    all[seen[i]] = text;
    if (all.size() > manifest.size() + kMostUnnamed) {
      return InputError(name + ": over " + std::to_string(kMostUnnamed) +
                        " different Cryptomatte ids that its manifest lacks: they are no ids; expected the passes as "
                        "Blender wrote them, in 32-bit float");
    }
  }
  std::vector<std::string> texts;
  for (const auto& [bits, text] : all) texts.push_back(text);
  const std::vector<std::uint32_t> house = IdsForNames(texts);
  std::map<std::uint32_t, std::uint32_t> house_by_bits;
  std::size_t n = 0;
  for (const auto& [bits, text] : all) house_by_bits[bits] = house[n++];
  last = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (seen[i] != last) {
      last = seen[i];
      last_id = last == 0 ? 0 : house_by_bits[last];
      if (last != 0) names[last_id] = all[last];
    }
    ids[i] = static_cast<float>(last_id);
  }
  return Ok();
}

void MatteCoverage(std::span<const std::vector<float>> ranks, std::span<float> coverage) {
  constexpr float kWhole = 0.9999f;  // sums of a thousand samples' shares are not exact
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    float sum = 0.0f, last = 0.0f;
    for (std::size_t r = 1; r < ranks.size(); r += 2) {
      if (ranks[r].empty()) continue;
      last = ranks[r][i];
      if (last > 0.0f) sum += last;
    }
    coverage[i] = sum >= kWhole || last > 0.0f ? 1.0f : sum;
  }
}

}  // namespace scumble
