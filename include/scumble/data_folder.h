// Where the bundled styles and the scripts for Blender are. Installing writes the folder's name in here.
#pragma once

#define SCUMBLE_DATA_FOLDER ""
