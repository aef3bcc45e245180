// The files that a scene consists of, as its loader comes to them.
#pragma once

#include <filesystem>
#include <functional>

namespace scumble {

// Called with the scene's file, and with each file that it names and that is looked for, before it is: also where it is
// missing, and where it is a texture, which is decoded later or not at all. Some are told of twice.
using FileListener = std::function<void(const std::filesystem::path&)>;

}  // namespace scumble
