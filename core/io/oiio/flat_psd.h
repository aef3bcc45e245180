// Reads only the flattened picture of a Photoshop file (PSD, and PSB for large ones).
#pragma once

#include <memory>
#include <string>

#include "core/image/status.h"
#include "core/io/oiio/oiio.h"

namespace scumble::internal {

// The file as it would be without its layers, thumbnail, profile and notes. It has header, palette, resolution,
// transparent colour, whether there is alpha, and the flattened picture, which alone is read. OpenImageIO parses
// everything else on opening and allocates the sizes it claims: 17 GB for the rows of one layer, in 124 bytes. Alpha is
// kept for grey and RGB of 8 bits. For other colours OpenImageIO 2.4 makes none, and transparent pixels show the white
// that they were flattened on. `file` must outlive the result. kInput where the file ends before the picture does, or
// its header's numbers are unsafe for OpenImageIO.
Expected<std::unique_ptr<OIIO::Filesystem::IOProxy>> FlatPsd(OIIO::Filesystem::IOProxy& file, const std::string& name);

}  // namespace scumble::internal
