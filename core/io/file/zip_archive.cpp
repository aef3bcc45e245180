#include "core/io/file/zip_archive.h"

#include <zip.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>

#include "core/io/readable_file.h"

namespace scumble {
namespace internal {

struct DiscardArchive {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};

}  // namespace internal

namespace {

using internal::DiscardArchive;

struct CloseSource {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};
struct CloseEntry {
  void operator()(zip_file_t* entry) const { zip_fclose(entry); }
};

// 1 January 1980, midnight, in MS-DOS's bits: year - 1980, month, day. The other function that sets a date depends on
// time zones.
constexpr std::uint16_t kFirstDay = 0 << 9 | 1 << 5 | 1, kMidnight = 0;

// libzip adds the reason of the system or of zlib after a colon.
Error WriteFailure(const std::string& name, zip_error_t* error) {
  return OutputError("cannot write " + name + ": " + zip_error_strerror(error));
}

Status AddEntry(zip_t* archive, const ZipEntry& entry, const std::string& name) {
  zip_source_t* data = zip_source_buffer(archive, entry.bytes.data(), entry.bytes.size(), 0);
  const auto index = data ? zip_file_add(archive, entry.name.c_str(), data, ZIP_FL_ENC_UTF_8) : -1;
  if (index < 0) {
    zip_source_free(data);  // the archive has not taken it over
    return WriteFailure(name, zip_get_error(archive));
  }
  const auto at = static_cast<zip_uint64_t>(index);
  const bool done = zip_set_file_compression(archive, at, entry.deflate ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0) == 0 &&
                    zip_file_set_dostime(archive, at, kMidnight, kFirstDay, 0) == 0;
  return done ? Ok() : WriteFailure(name, zip_get_error(archive));
}

Expected<std::vector<std::byte>> BytesOf(zip_source_t* source, const std::string& name) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  std::vector<std::byte> bytes;
  if (zip_source_stat(source, &stat) == 0 && zip_source_open(source) == 0) {
    bytes.resize(stat.size);
    const auto read = zip_source_read(source, bytes.data(), bytes.size());
    zip_source_close(source);
    if (read == static_cast<zip_int64_t>(bytes.size())) return bytes;
  }
  return WriteFailure(name, zip_source_error(source));
}

}  // namespace

Expected<std::vector<std::byte>> EncodeZip(std::span<const ZipEntry> entries, const std::string& name) {
  zip_error_t error;
  zip_error_init(&error);
  const std::unique_ptr<zip_source_t, CloseSource> buffer(zip_source_buffer_create(nullptr, 0, 0, &error));
  if (!buffer) return WriteFailure(name, &error);
  std::unique_ptr<zip_t, DiscardArchive> archive(zip_open_from_source(buffer.get(), ZIP_TRUNCATE, &error));
  if (!archive) return WriteFailure(name, &error);
  zip_source_keep(buffer.get());  // closing the archive would free it, and the bytes are in it
  for (const ZipEntry& entry : entries) SCUMBLE_RETURN_IF_ERROR(AddEntry(archive.get(), entry, name));
  if (zip_close(archive.get()) != 0) return WriteFailure(name, zip_get_error(archive.get()));
  static_cast<void>(archive.release());  // closed already
  return BytesOf(buffer.get(), name);
}

bool IsZip(const std::filesystem::path& path) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) return false;
  char start[4] = {};
  std::ifstream(path, std::ios::binary).read(start, sizeof start);
  return std::memcmp(start, "PK\3\4", sizeof start) == 0;
}

struct ZipReader::Archive {
  std::unique_ptr<zip_t, internal::DiscardArchive> handle;
};

ZipReader::ZipReader(std::unique_ptr<Archive> archive, std::string file, std::vector<std::string> names)
    : archive_(std::move(archive)), file_(std::move(file)), names_(std::move(names)) {}
ZipReader::~ZipReader() = default;
ZipReader::ZipReader(ZipReader&&) noexcept = default;
ZipReader& ZipReader::operator=(ZipReader&&) noexcept = default;

Expected<ZipReader> ZipReader::Open(const std::filesystem::path& path) {
  SCUMBLE_RETURN_IF_ERROR(internal::CheckReadable(path));
  int code = 0;
  auto archive = std::make_unique<Archive>();
  archive->handle.reset(zip_open(path.c_str(), ZIP_RDONLY, &code));
  if (!archive->handle) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string reason = zip_error_strerror(&error);
    zip_error_fini(&error);
    return InputError("cannot read " + path.string() + ": " + reason + "; copy or save it again");
  }
  std::vector<std::string> names;
  const zip_int64_t count = zip_get_num_entries(archive->handle.get(), 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name = zip_get_name(archive->handle.get(), static_cast<zip_uint64_t>(i), 0);
    names.emplace_back(name ? name : "");
  }
  return ZipReader(std::move(archive), path.string(), std::move(names));
}

bool ZipReader::Has(const std::string& name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

Expected<std::vector<std::byte>> ZipReader::ReadStart(const std::string& name, std::size_t count) const {
  return ReadAtMost(name, count, false);
}

Expected<std::vector<std::byte>> ZipReader::Read(const std::string& name, std::size_t limit) const {
  return ReadAtMost(name, limit, true);
}

Expected<std::vector<std::byte>> ZipReader::ReadAtMost(const std::string& name, std::size_t limit, bool whole) const {
  const std::string what = "cannot read " + name + " in " + file_ + ": ";
  zip_t* archive = archive_->handle.get();
  const std::unique_ptr<zip_file_t, CloseEntry> entry(zip_fopen(archive, name.c_str(), 0));
  if (!entry) return InputError(what + zip_strerror(archive) + "; save it again");
  constexpr std::size_t kStep = std::size_t(1) << 20;
  std::vector<std::byte> bytes;
  for (std::size_t filled = 0;;) {
    bytes.resize(std::min(filled + kStep, limit + 1));
    const zip_int64_t read = zip_fread(entry.get(), bytes.data() + filled, bytes.size() - filled);
    if (read < 0)
      return InputError(what + zip_error_strerror(zip_file_get_error(entry.get())) + "; copy or save it again");
    filled += static_cast<std::size_t>(read);
    if (filled > limit && !whole) {
      bytes.resize(limit);
      return bytes;
    }
    if (filled > limit) {
      return InputError(what + "it unpacks to more than " + std::to_string(limit) + " bytes, the most that is read");
    }
    if (read == 0) {
      bytes.resize(filled);
      return bytes;
    }
  }
}

}  // namespace scumble
