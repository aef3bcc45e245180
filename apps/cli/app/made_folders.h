// Folders for a report, which an interrupted run leaves no trace of.
#pragma once

#include <filesystem>
#include <system_error>
#include <vector>

namespace scumble {

// Folders that a run makes, with those above them; those that stay empty are removed.
class MadeFolders {
 public:
  explicit MadeFolders(const fs::path& deepest) {
    std::error_code failed;
    for (fs::path folder = fs::absolute(deepest, failed).lexically_normal();
         !folder.empty() && !fs::exists(folder, failed); folder = folder.parent_path()) {
      made_.push_back(folder);
    }
    fs::create_directories(deepest, error_);
  }
  ~MadeFolders() {
    std::error_code ignored;
    for (const fs::path& folder : made_)
      fs::remove(folder, ignored);  // the deepest first; fails where something is in it
  }
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  const std::error_code& error() const { return error_; }  // of the last one that could not be made

 private:
  std::error_code error_;
  std::vector<fs::path> made_;
};

}  // namespace scumble
