// The Blender in PATH, for expectations that depend on its version.
#pragma once

#include <cstdio>
#include <string>

namespace scumble {

// "3.4.1"; empty where there is none.
inline std::string BlenderVersion() {
  std::string line;
  if (std::FILE* output = ::popen("blender --version 2> /dev/null", "r")) {
    char text[256];
    while (line.rfind("Blender ", 0) != 0 && std::fgets(text, sizeof text, output)) line = text;
    while (std::fgets(text, sizeof text, output)) {
    }
    ::pclose(output);
  }
  if (line.rfind("Blender ", 0) != 0) return "";
  return line.substr(8, line.find_first_of(" \n", 8) - 8);
}

inline bool IsBlender4() { return BlenderVersion().rfind("4.", 0) == 0; }

}  // namespace scumble
