// The files that a scene consists of, as its loader comes to them.
#pragma once

#include <filesystem>
#include <functional>

namespace scumble {

// Called with the scene's file, and with each file that it names, before that is looked for. The file may be missing,
// or a texture, which is decoded later or not at all. Some are told of twice.
using FileListener = std::function<void(const std::filesystem::path&)>;

}  // namespace scumble
