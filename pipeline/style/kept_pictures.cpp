#include "pipeline/style/kept_pictures.h"

#include <utility>

#include "core/io/picture_file.h"
#include "pipeline/file_stamp.h"

namespace scumble {
namespace {

std::size_t BytesOf(const Picture& picture) { return picture.rgba.size() * sizeof picture.rgba.front(); }

}  // namespace

Expected<Picture> KeptPictures::Read(const std::filesystem::path& file) {
  std::string stamp = StampOf(file.string());  // before it is read: what is written meanwhile is read again
  const auto known = kept_.find(file.string());
  if (known != kept_.end()) {
    if (known->second.stamp == stamp) {
      known->second.is_read = true;
      return known->second.picture;
    }
    bytes_ -= BytesOf(known->second.picture);
    kept_.erase(known);
  }
  SCUMBLE_ASSIGN(Picture picture, ReadPicture(file));
  ++decoded_;
  if (bytes_ + BytesOf(picture) > kMostBytes) return picture;
  bytes_ += BytesOf(picture);
  kept_[file.string()] = {std::move(stamp), picture};
  return picture;
}

void KeptPictures::ForgetUnread() {
  for (auto it = kept_.begin(); it != kept_.end();) {
    if (std::exchange(it->second.is_read, false)) {
      ++it;
      continue;
    }
    bytes_ -= BytesOf(it->second.picture);
    it = kept_.erase(it);
  }
}

}  // namespace scumble
