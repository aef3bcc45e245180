// The flattened picture of a Photoshop file (PSD, and PSB for large ones), and nothing else of it.
#pragma once

#include <memory>
#include <string>

#include "core/image/status.h"
#include "core/io/oiio/oiio.h"

namespace scumble::internal {

// The file as it would be without its layers, thumbnail, profile and notes: header, palette, resolution, transparent
// colour, whether there is alpha, and the flattened picture, which is all that is read. OpenImageIO goes through the
// rest as it opens a file and takes memory for what it claims: 17 GB for the rows of one layer, in 124 bytes. Alpha is
// kept of grey and RGB of 8 bits; of other colours OpenImageIO 2.4 makes none, and what is transparent shows the white
// that it was flattened on. `file` must outlive what is returned. kInput where the file ends before the picture does,
// or its header's numbers are none that OpenImageIO takes safely.
Expected<std::unique_ptr<OIIO::Filesystem::IOProxy>> FlatPsd(OIIO::Filesystem::IOProxy& file, const std::string& name);

}  // namespace scumble::internal
