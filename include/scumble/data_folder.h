// Where the bundled styles and the scripts for Blender are. Installing writes the folder's name in here; in the source
// tree it is empty, so a program built beside it names its own.
#pragma once

#define SCUMBLE_DATA_FOLDER ""

namespace scumble::internal {

// Names the folder to the library, whose part for EXR and JPEG is installed beside it. The headers call this before
// main, because the first call of a program may be one that reads a picture.
bool UseDataFolder(const char* folder);
[[maybe_unused]] inline const bool data_folder_is_known = sizeof(SCUMBLE_DATA_FOLDER) > 1 &&
                                                          UseDataFolder(SCUMBLE_DATA_FOLDER);

}  // namespace scumble::internal
