#include "io/whole_output.h"

#include <cctype>
#include <string>
#include <system_error>

#include "io/guide_file.h"
#include "io/oiio.h"
#include "io/picture_file.h"

namespace scumble {
namespace {

Status CheckNotEmpty(const std::filesystem::path& path) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) return InputError(path.string() + " is not there");
  if (std::filesystem::file_size(path, failed) == 0 || failed) return InputError(path.string() + " is empty");
  return Ok();
}

std::string Text(int width, int height) { return std::to_string(width) + "×" + std::to_string(height); }

Status CheckSide(const std::filesystem::path& path, int width, int height, int wanted_width, int wanted_height) {
  if ((wanted_width == 0 || width == wanted_width) && (wanted_height == 0 || height == wanted_height)) return Ok();
  return InputError(path.string() + " is " + Text(width, height) + ", not " + Text(wanted_width, wanted_height));
}

}  // namespace

int PictureChannels(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".jpg" || ending == ".jpeg" ? 3 : 4;
}

Status CheckWholePicture(const std::filesystem::path& path, const PictureShape& shape) {
  SCUMBLE_RETURN_IF_ERROR(CheckNotEmpty(path));
  {
    SCUMBLE_ASSIGN(const auto input, internal::OpenInput(path));
    const auto& spec = input->spec();
    SCUMBLE_RETURN_IF_ERROR(CheckSide(path, spec.full_width, spec.full_height, shape.width, shape.height));
    if (shape.channels != 0 && spec.nchannels != shape.channels) {
      return InputError(path.string() + " has " + std::to_string(spec.nchannels) + " channels, not " +
                        std::to_string(shape.channels));
    }
  }
  if (const auto read = ReadPicture(path); !read) return read.error();
  return Ok();
}

Status CheckWholeGuides(const std::filesystem::path& path, int width, int height, const LayerSet& layers) {
  SCUMBLE_RETURN_IF_ERROR(CheckNotEmpty(path));
  SCUMBLE_ASSIGN(const GuideFileInfo info, InspectGuides(path));
  SCUMBLE_RETURN_IF_ERROR(CheckSide(path, info.width, info.height, width, height));
  const auto found = info.layers.find("");
  const LayerSet held = found == info.layers.end() ? LayerSet() : found->second;
  if (held != layers) return InputError(path.string() + " holds " + held.ToString() + ", not " + layers.ToString());
  GuideReadOptions options;
  options.required = layers;
  if (const auto read = ReadGuides(path, options); !read) return read.error();
  return Ok();
}

}  // namespace scumble
