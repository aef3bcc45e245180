// Every channel by OpenImageIO. Part of the module of formats.
#include "core/io/channel_file.h"

#include <map>

#include "core/io/format_dispatch.h"
#include "core/io/oiio/oiio.h"

namespace scumble::formats {
namespace {

// More than any renderer writes; a damaged header may claim millions.
constexpr int kMaxChannels = 4096;

std::string SizeText(const OIIO::ImageSpec& spec) {
  return std::to_string(spec.width) + "×" + std::to_string(spec.height) + " at (" + std::to_string(spec.x) + ", " +
         std::to_string(spec.y) + ")";
}

Expected<std::vector<OIIO::ImageSpec>> ReadPartHeaders(OIIO::ImageInput& input, const std::string& name) {
  std::vector<OIIO::ImageSpec> parts;
  int channels = 0;
  for (int part = 0; input.seek_subimage(part, 0); ++part) {
    const OIIO::ImageSpec spec = input.spec();
    SCUMBLE_RETURN_IF_ERROR(internal::CheckSize(spec, name));
    channels += spec.nchannels;
    if (channels > kMaxChannels) {
      return InputError(name + " claims more than " + std::to_string(kMaxChannels) + " channels: it may be damaged");
    }
    if (part > 0 && (spec.width != parts[0].width || spec.height != parts[0].height || spec.x != parts[0].x ||
                     spec.y != parts[0].y)) {
      return InputError(name + ": part " + std::to_string(part) + " is " + SizeText(spec) + ", part 0 is " +
                        SizeText(parts[0]) + "; expected parts of one size, so write them as separate files");
    }
    parts.push_back(spec);
  }
  input.geterror();  // TIFF's reader keeps an error for the part that was not there
  return parts;
}

// Names that several parts share are ambiguous without the part's own name.
std::vector<std::string> UniqueNames(const std::vector<OIIO::ImageSpec>& parts) {
  std::map<std::string, int> uses;
  for (const auto& part : parts) {
    for (const std::string& name : part.channelnames) ++uses[name];
  }
  std::vector<std::string> names;
  std::map<std::string, int> taken;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::string prefix(parts[p].get_string_attribute("oiio:subimagename"));
    if (prefix.empty()) prefix = "part" + std::to_string(p);
    for (const std::string& channel : parts[p].channelnames) {
      std::string name = parts.size() > 1 && uses[channel] > 1 ? prefix + "." + channel : channel;
      const int earlier = taken[name]++;
      names.push_back(earlier == 0 ? name : name + "#" + std::to_string(earlier));
    }
  }
  return names;
}

}  // namespace

Expected<ChannelImage> ReadChannels(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(const auto input, internal::OpenInput(path));
  SCUMBLE_ASSIGN(const auto parts, ReadPartHeaders(*input, path.string()));
  ChannelImage image;
  image.name = path.string();
  image.x = parts[0].x;
  image.y = parts[0].y;
  image.width = parts[0].width;
  image.height = parts[0].height;
  image.names = UniqueNames(parts);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const std::size_t channels = static_cast<std::size_t>(parts[p].nchannels);
    std::vector<float> pixels(image.pixel_count() * channels);
    if (!input->read_image(static_cast<int>(p), 0, 0, parts[p].nchannels, OIIO::TypeDesc::FLOAT, pixels.data()) ||
        input->has_error()) {
      return internal::ReadFailure(*input, path.string());
    }
    for (std::size_t c = 0; c < channels; ++c) {
      auto& plane = image.planes.emplace_back(image.pixel_count());
      for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = pixels[i * channels + c];
    }
  }
  return image;
}

}  // namespace scumble::formats
