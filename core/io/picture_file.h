// Pictures from and to files: PNG by libpng, EXR written by OpenEXR, TIFF by libtiff, everything else by OpenImageIO;
// layered OpenRaster files by core/io/open_raster.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

// What becomes of an ICC profile in a file. Textures of scenes ignore it, as glTF 2.0 demands and Blender does.
enum class Profiles { kApply, kIgnore };

// What a picture of 0 to 1 cannot hold of a file of floats, and what an ICC profile changes. An excess of up to 0.002
// of the light that the pixel shows is the rounding of half floats, and is not counted.
struct PictureLosses {
  std::size_t clamped = 0;  // values of colour below 0 or above 1, infinities included
  std::size_t nan = 0;      // values of colour and alpha that are no numbers
  int profile_change = 0;   // the largest of a colour's code, of 65535
};

// Reads any picture as 16-bit sRGB-encoded RGBA with straight alpha. 8-bit values v become v · 257, 16-bit values are
// kept; float files (EXR, HDR) are taken as linear and associated, unpremultiplied, clamped to [0, 1] and encoded.
// Grey is spread over the three colours; a missing alpha is opaque, a NaN one transparent. A photograph is
// turned upright by its Exif orientation; RGB and grey with an ICC profile become sRGB. A file that ends early is
// an error, JPEG included. Of a file of layers (.ora, Krita's .kra) the picture of all that are visible is read, of an
// EXR of several parts the one that holds R, G and B, and of a render of several view layers that of `view_layer`.
// `losses`, if given, is set. Thread-safe.
Expected<Picture> ReadPicture(const std::filesystem::path& path, const std::string& view_layer = {},
                              Profiles profiles = Profiles::kApply, PictureLosses* losses = nullptr);

// The header of a file, without its pixels. Of a file of layers, that of the merged picture. Thread-safe.
struct PictureHeader {
  int width = 0;  // as stored, before a photograph is turned upright
  int height = 0;
  int bits = 8;    // per channel
  double dpi = 0;  // 0: none, or a camera's or screen's 72 or 96, which are no true resolution
};
Expected<PictureHeader> InspectPicture(const std::filesystem::path& path);

// Whether the numbers of a PNG mean other colours than sRGB's, by a code of 8 bits or more. Where the profile is
// sRGB's, or there is none, no pixel is read; otherwise the picture is read once. Thread-safe.
Expected<bool> HasOtherColors(const std::filesystem::path& png);

// The number of pixels that ReadPicture would make, from as little of the file as possible. Call it before memory is
// taken. An error where ReadPicture would fail, as far as the header shows. Thread-safe.
Expected<std::uint64_t> CountPixels(const std::filesystem::path& path);
Expected<std::uint64_t> CountPixels(std::span<const std::byte> bytes, const std::string& name);

// Whether ReadPicture loads OpenImageIO for the file, which takes memory for the rest of the process. Where the file is
// not there, that of a file with its ending. Thread-safe.
bool NeedsOpenImageIo(const std::filesystem::path& path);

// ReadPicture from memory, for pictures inside .glb files, which have no orientation. `name` stands for the picture in
// messages.
Expected<Picture> DecodePicture(std::span<const std::byte> bytes, const std::string& name,
                                Profiles profiles = Profiles::kApply);

struct PictureWriteOptions {
  int bits = 8;       // 8 or 16 per channel; JPEG takes 8 alone; EXR takes 8, 16 and 32: half floats, or floats at 32
  int png_level = 6;  // 0 … 9, zlib's compression level
  int jpeg_quality = 92;
  int dpi = 0;                // pixels an inch on paper, noted in PNG, TIFF and JPEG; 0: none is noted
  bool grey = false;          // PNG and TIFF: the red channel alone, for pictures that are grey and opaque
  bool fast = false;          // EXR: kFastCompression of guide_file.h instead of zip, the same pixels
  std::string settings = {};  // the picture's settings, free text; kept in PNG and EXR as scumble:settings
};

// Bits a channel that WritePicture stores under that name: 16 for EXR means half floats.
int PictureBits(const std::filesystem::path& path, const PictureWriteOptions& options);

// Whether WritePicture supports the ending and the bits. Call it before long work.
Status CheckPictureTarget(const std::filesystem::path& path, const PictureWriteOptions& options = {});

// Format by the file's ending. PNG and TIFF get straight alpha (not associated), JPEG is composited on white, EXR is
// linear with associated alpha. The file appears whole under its name or not at all.
Status WritePicture(const std::filesystem::path& path, const Picture& picture, const PictureWriteOptions& options = {});

// The bytes of an 8-bit PNG; `dpi` as in PictureWriteOptions.
Expected<std::vector<std::byte>> EncodePng(const Picture& picture, int dpi = 0);

// The values that 8-bit files hold, 4 · width · height.
std::vector<std::uint8_t> In8Bits(const Picture& picture);

}  // namespace scumble
