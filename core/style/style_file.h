// Styles from files: a folder with a style.toml, the style.toml itself, or just a picture of a painted sphere.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/image/style.h"
#include "core/style/style_keys.h"
#include "core/style/style_override.h"

namespace scumble {

// A style.toml that is larger is refused.
inline constexpr std::size_t kMaxStyleBytes = 1 << 20;

// Called before that many more bytes are taken for a picture of an exemplar or its guides. If it refuses, the picture
// is not read. Null: there is no limit.
using StyleRoom = std::function<Status(std::uint64_t bytes)>;

// How files of styles are read.
struct StyleReading {
  StyleRoom room;
  PictureReader read_picture;  // null: ReadPicture
};

// Reads a style and its pictures. The names "toon" and "render", where no file has them, are styles of these methods.
// `overrides` are all of this style, and win over the file. Of [[exemplar]] the luminance and fills can be overridden,
// by number from 1: exemplar.2.luminance. Every key is applied, or refused by name: unknown ones with the list of
// known ones, missing features as kUnavailable.
//
// A key of [transfer] may also have one value for each of several frames: threshold = [[1, 0.1], [24, 0.3]]; see
// style_keyframes.h. The style that is returned is that of frame 0.
//
// A picture beside a style.toml that names it stands for that style.
//
// An [[exemplar]] picture is a square that the sphere fills. With `guides` naming the guides.exr that `scumble sphere`
// wrote, the picture may also be the whole painted template: its margin is cut off. Any other guides with A and normal,
// of the picture's size, make it an exemplar of that scene, of any shape. A picture that is wholly transparent is
// refused.
Expected<Style> LoadStyle(const std::filesystem::path& path, const std::vector<StyleOverride>& overrides = {},
                          const StyleReading& reading = {});

// The value of every key of StyleKeys() in the style's file, or the default; of key frames that of frame 0. Only its
// TOML is read. Numbers of kNumber are doubles. Errors are those of LoadStyle, but values are not checked.
Expected<std::map<std::string, KeyValue>> StyleValues(const std::filesystem::path& path);

// The folders under `root` that hold a style.toml, sorted by name.
std::vector<std::filesystem::path> FindStyles(const std::filesystem::path& root);

}  // namespace scumble
