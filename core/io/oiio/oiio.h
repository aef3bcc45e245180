// The code that the files of core/io share for OpenImageIO. Private to core/io: OpenImageIO's headers stay in here.
#pragma once

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"

namespace scumble::internal {

// Opens a picture file with straight alpha left as it is stored. The message carries the library's reason. Of a PSD
// only the flattened picture is available.
Expected<std::shared_ptr<OIIO::ImageInput>> OpenInput(const std::filesystem::path& path);

// OpenInput from memory; `proxy` must outlive the input.
Expected<std::shared_ptr<OIIO::ImageInput>> OpenInput(OIIO::Filesystem::IOMemReader& proxy, const std::string& name);

// Calls a reader of the library, which may throw. The error is kInput; std::bad_alloc passes to the caller.
template <class Call>
Status WithoutExceptions(const std::string& name, const Call& call) {
  try {
    call();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& failure) {
    return InputError("cannot read " + name + ": its reader fails at what is in it (" + failure.what() +
                      "); it may be damaged: save it again, or as a PNG");
  }
  return Ok();
}

// The library's reason why pixels could not be read. Some readers report success and leave an error behind, as for a
// truncated TIFF: check has_error() as well.
Error ReadFailure(OIIO::ImageInput& input, const std::string& name);

// Encodes with `write_pixels` into memory, in the format of the name's ending. The library's failures become errors
// that name the file.
Expected<std::vector<std::byte>> Encode(const std::string& name, const OIIO::ImageSpec& spec,
                                        const std::function<bool(OIIO::ImageOutput&)>& write_pixels);

// Refuses sizes that no real picture has, before anything of that size is allocated.
Status CheckSize(const OIIO::ImageSpec& spec, const std::string& name);

}  // namespace scumble::internal
