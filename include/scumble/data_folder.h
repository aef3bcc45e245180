// Where the bundled styles and the scripts for Blender are. Installing writes the folder's name in here; in the source
// tree it is empty, so a program built beside it names its own.
#pragma once

#define SCUMBLE_DATA_FOLDER ""
