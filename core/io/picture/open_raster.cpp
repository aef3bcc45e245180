#include "core/io/open_raster.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

#include "core/image/check.h"
#include "core/io/file/zip_archive.h"
#include "core/io/picture_file.h"
#include "core/io/png/png_integrity.h"

namespace scumble {
namespace {

constexpr const char* kMimetype = "image/openraster";
constexpr const char* kMerged = "mergedimage.png";
constexpr const char* kSettingsEntry = "scumble/settings.txt";
constexpr std::size_t kMaxPngBytes = std::size_t(1) << 30;

std::vector<std::byte> Bytes(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::string Escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string LayerFile(std::size_t index) {
  return "data/layer" + std::string(index < 10 ? "0" : "") + std::to_string(index) + ".png";
}

std::string Stack(std::span<const RasterLayer> layers, const Picture& merged, int dpi) {
  // MyPaint's canvas has no end; without its frame it would save the whole painted area, in steps of 64 pixels.
  std::string xml =
      "<?xml version='1.0' encoding='UTF-8'?>\n"
      "<image xmlns:mypaint=\"http://mypaint.org/ns/openraster\" mypaint:frame-active=\"true\" version=\"0.0.5\" "
      "w=\"" +
      std::to_string(merged.width) + "\" h=\"" + std::to_string(merged.height) + "\"";
  if (dpi > 0) xml += " xres=\"" + std::to_string(dpi) + "\" yres=\"" + std::to_string(dpi) + "\"";
  xml += ">\n  <stack>\n";
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const RasterLayer& layer = layers[i];
    char opacity[16];
    std::snprintf(opacity, sizeof opacity, "%.2f", layer.opacity);
    xml += "    <layer name=\"" + Escaped(layer.name) + "\" src=\"" + LayerFile(i) + "\" x=\"0\" y=\"0\" opacity=\"" +
           opacity + "\" visibility=\"" + (layer.visible ? "visible" : "hidden") + "\" composite-op=\"" +
           (layer.atop ? "svg:src-atop" : "svg:src-over") + "\"" + (layer.locked ? " edit-locked=\"true\"" : "") +
           (layer.selected ? " selected=\"true\"" : "") + "/>\n";
  }
  return xml + "  </stack>\n</image>\n";
}

// At most 256 pixels a side, as the format requires: each pixel is the mean of those it covers.
Picture Thumbnail(const Picture& picture) {
  constexpr int kLargest = 256;
  const int larger = std::max(picture.width, picture.height);
  if (larger <= kLargest) return picture;
  const auto scaled = [&](int side) { return std::max(1, side * kLargest / larger); };
  Picture small(scaled(picture.width), scaled(picture.height));
  const auto first = [](int i, int from, int to) { return static_cast<int>(std::int64_t(i) * from / to); };
  for (int y = 0; y < small.height; ++y) {
    const int y0 = first(y, picture.height, small.height), y1 = first(y + 1, picture.height, small.height);
    for (int x = 0; x < small.width; ++x) {
      const int x0 = first(x, picture.width, small.width), x1 = first(x + 1, picture.width, small.width);
      std::uint64_t sums[4] = {};
      for (int v = y0; v < y1; ++v) {
        for (int u = x0; u < x1; ++u) {
          for (int c = 0; c < 4; ++c) sums[c] += picture.At(u, v)[c];
        }
      }
      const std::uint64_t count = std::uint64_t(x1 - x0) * (y1 - y0);
      for (int c = 0; c < 4; ++c) small.At(x, y)[c] = static_cast<std::uint16_t>((sums[c] + count / 2) / count);
    }
  }
  return small;
}

// The declared size of a PNG in an archive, before it is unpacked.
Expected<MergedHeader> InspectPng(const ZipReader& zip, const std::string& entry, const std::string& file) {
  SCUMBLE_ASSIGN(const auto start, zip.ReadStart(entry, internal::kPngHeaderBytes));
  const std::string name = file + ": " + entry;
  const auto header = internal::ReadPngHeader(start);
  if (!header) return InputError("cannot read " + name + ": it is no PNG; save the file again");
  constexpr std::uint32_t kLongest = 1u << 24;  // OpenImageIO's own limit is checked by the reader
  if (header->width == 0 || header->height == 0 || std::max(header->width, header->height) > kLongest) {
    return InputError("cannot read " + name + ": it says that it is " + std::to_string(header->width) + "×" +
                      std::to_string(header->height) + " pixels; save the file again");
  }
  return MergedHeader{int(header->width), int(header->height), header->bits};
}

// A PNG in an archive. Its name there proves nothing, and no other reader may open untrusted bytes.
Expected<Picture> ReadPng(const ZipReader& zip, const std::string& entry, const std::string& file) {
  SCUMBLE_ASSIGN(const MergedHeader header, InspectPng(zip, entry, file));
  // Uncompressed at 16 bits, with texts and colour profiles. A small archive can unpack to gigabytes.
  constexpr std::size_t kBeside = std::size_t(1) << 24;
  const std::size_t picture = std::size_t(header.width) * std::size_t(header.height) * 8;
  SCUMBLE_ASSIGN(const auto bytes, zip.Read(entry, std::min(kMaxPngBytes, picture + picture / 64 + kBeside)));
  return DecodePicture(bytes, file + ": " + entry);
}

Expected<ZipReader> OpenMerged(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(ZipReader zip, ZipReader::Open(path));
  if (zip.Has(kMerged)) return zip;
  return InputError(
      "cannot read " + path.string() + ": it is an archive without " + kMerged +
      ", the picture of all its layers: expected an .ora or .kra file of a painting program; export a PNG");
}

// `xml` without the resolutions that Stack may hold.
std::string WithoutDpi(std::string xml) {
  for (const std::string name : {" xres=\"", " yres=\""}) {
    const std::size_t at = xml.find(name), end = at == xml.npos ? at : xml.find('"', at + name.size());
    if (end != xml.npos) xml.erase(at, end + 1 - at);
  }
  return xml;
}

}  // namespace

Expected<std::vector<std::byte>> EncodeOpenRaster(std::span<const RasterLayer> layers, const Picture& merged, int dpi,
                                                  const std::string& name, const std::string& settings) {
  // The first entry, stored unpacked, so that the file's type is at a fixed place near its beginning.
  std::vector<ZipEntry> entries{{"mimetype", Bytes(kMimetype)}};
  entries.push_back({"stack.xml", Bytes(Stack(layers, merged, dpi)), true});
  for (std::size_t i = 0; i < layers.size(); ++i) entries.push_back({LayerFile(i), layers[i].png});
  SCUMBLE_ASSIGN(auto whole, EncodePng(merged));
  entries.push_back({kMerged, std::move(whole)});
  SCUMBLE_ASSIGN(auto thumbnail, EncodePng(Thumbnail(merged)));
  entries.push_back({"Thumbnails/thumbnail.png", std::move(thumbnail)});
  if (!settings.empty()) entries.push_back({kSettingsEntry, Bytes(settings)});
  return EncodeZip(entries, name);
}

Expected<std::string> ReadLayerSettings(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const ZipReader zip, OpenMerged(path));
  if (!zip.Has(kSettingsEntry)) return std::string();
  SCUMBLE_ASSIGN(const auto bytes, zip.Read(kSettingsEntry, std::size_t(1) << 20));
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

Expected<Picture> ReadMergedLayers(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const ZipReader zip, OpenMerged(path));
  return ReadPng(zip, kMerged, path.string());
}

Expected<MergedHeader> InspectMergedLayers(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const ZipReader zip, OpenMerged(path));
  return InspectPng(zip, kMerged, path.string());
}

void PutOver(Picture& below, const Picture& above) {
  for (std::size_t i = 0; i < below.rgba.size(); i += 4) {
    const std::uint64_t a = above.rgba[i + 3], whole = 65535;
    if (a == 0) continue;
    const std::uint64_t rest = std::uint64_t(below.rgba[i + 3]) * (whole - a), sum = a * whole + rest;
    for (std::size_t c = 0; c < 3; ++c) {
      below.rgba[i + c] =
          static_cast<std::uint16_t>((above.rgba[i + c] * a * whole + below.rgba[i + c] * rest + sum / 2) / sum);
    }
    below.rgba[i + 3] = static_cast<std::uint16_t>((sum + whole / 2) / whole);
  }
}

Expected<std::vector<std::byte>> WithStrokes(const std::filesystem::path& path, const std::string& layer,
                                             const Picture& strokes) {
  constexpr const char* kStrokes = "data/scumble.png";
  constexpr std::size_t kMostStackBytes = std::size_t(16) << 20;
  SCUMBLE_ASSIGN(const ZipReader zip, OpenMerged(path));
  SCUMBLE_ASSIGN(Picture merged, ReadPng(zip, kMerged, path.string()));
  if (merged.width != strokes.width || merged.height != strokes.height) {
    return UsageError("the strokes are not of the size of " + path.string());
  }
  PutOver(merged, strokes);
  Picture painted = strokes;
  const bool is_there = zip.Has(kStrokes);
  if (is_there) {
    SCUMBLE_ASSIGN(Picture before, ReadPng(zip, kStrokes, path.string()));
    if (before.width == strokes.width && before.height == strokes.height) {
      PutOver(before, strokes);
      painted = std::move(before);
    }
  }
  SCUMBLE_ASSIGN(const auto stack, zip.Read("stack.xml", kMostStackBytes));
  std::string xml(reinterpret_cast<const char*>(stack.data()), stack.size());
  if (!is_there) {
    const std::size_t tag = xml.find("<stack"), end = tag == xml.npos ? tag : xml.find('>', tag);
    if (end == xml.npos || xml[end - 1] == '/') {
      return InputError("cannot add a layer to " + path.string() + ": its stack.xml has no layers");
    }
    xml.insert(end + 1, "\n    <layer name=\"" + Escaped(layer) + "\" src=\"" + kStrokes +
                            "\" x=\"0\" y=\"0\" opacity=\"1.0\" visibility=\"visible\" "
                            "composite-op=\"svg:src-over\"/>");
  }
  std::vector<ZipEntry> entries{{"mimetype", Bytes(kMimetype)}, {"stack.xml", Bytes(xml), true}};
  for (const auto& [name, picture] : {std::pair{kStrokes, &painted}, {kMerged, &merged}}) {
    SCUMBLE_ASSIGN(auto png, EncodePng(*picture));
    entries.push_back({name, std::move(png)});
  }
  SCUMBLE_ASSIGN(auto thumbnail, EncodePng(Thumbnail(merged)));
  entries.push_back({"Thumbnails/thumbnail.png", std::move(thumbnail)});
  for (const std::string& name : zip.names()) {
    const bool is_written =
        std::any_of(entries.begin(), entries.end(), [&](auto& entry) { return entry.name == name; });
    if (is_written || name.ends_with('/')) continue;
    SCUMBLE_ASSIGN(auto bytes, zip.Read(name, kMaxPngBytes));
    entries.push_back({name, std::move(bytes)});
  }
  return EncodeZip(entries, path.string());
}

bool SameLayers(const std::filesystem::path& path, std::span<const RasterLayer> layers, const Picture& merged) {
  const auto zip = ZipReader::Open(path);
  constexpr std::size_t kOthers = 4;  // mimetype, stack.xml, mergedimage.png, the thumbnail
  if (!zip || zip->names().size() != layers.size() + kOthers) return false;
  const std::string stack = Stack(layers, merged, 0);
  // Names, order and visibility belong to the artist too.
  constexpr std::size_t kNoted = 200;
  const auto held_stack = zip->Read("stack.xml", stack.size() + kNoted);
  if (!held_stack || WithoutDpi({reinterpret_cast<const char*>(held_stack->data()), held_stack->size()}) != stack) {
    return false;
  }
  const auto same = [&](const std::string& entry, const Picture& drawn) {
    const auto held = ReadPng(*zip, entry, path.string());
    return held && held->width == drawn.width && held->height == drawn.height && In8Bits(*held) == In8Bits(drawn);
  };
  if (!same(kMerged, merged)) return false;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const auto drawn = DecodePicture(layers[i].png, layers[i].name + ".png");
    if (!drawn || !same(LayerFile(i), *drawn)) return false;
  }
  return true;
}

}  // namespace scumble
