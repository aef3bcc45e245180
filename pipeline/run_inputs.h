// What a run reads and what it writes: no output may take the place of an input, and every output must be writable,
// which is looked at before hours of work.
#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/image/status.h"
#include "guidegen/file_listener.h"
#include "pipeline/style_set.h"

namespace scumble {

class RunInputs {
 public:
  // A file that the run reads; `what` is for the message: "the guides". Empty names and files that are not there
  // are passed over; reading them is an error later.
  void Reads(const std::string& what, const std::string& path);
  // A scene's file. What else the scene consists of is known when it is loaded: the listener, for
  // SceneRequest::on_file, adds that. It refers to this.
  [[nodiscard]] FileListener ReadsScene(const std::string& scene);
  // Style files, exemplars, their guides, paper: of every style in the set.
  void ReadsStyles(const StyleSet& styles);
  // Whether outputs were checked against all that is read; not where a scene has named files or asked for styles since.
  bool IsChecked(const StyleSet* styles) const {
    return checked_ == inputs_.size() && (!styles || styles_ == styles->opened.size());
  }
  // Paths of the files that are there, each file once, in alphabetical order.
  std::vector<std::string> Inputs() const;

  // kUsage where an output is one of these files, under whatever name or link; kOutput where it cannot be written, its
  // folder is missing, or it is a folder. The outputs of a range are in one folder. Nothing is left behind.
  // `option` is for the message. With `resumes`, outputs that are there pass: they may be kept.
  Status CheckOutputs(std::span<const std::string> outputs, const std::string& option = "-o", bool resumes = false);
  Status CheckOutput(const std::string& output) { return CheckOutputs(std::span(&output, 1)); }

 private:
  // Files that a text names in quotes, from a folder.
  void ReadsQuoted(const std::string& what, const std::string& file, const std::string& folder);

  static constexpr std::size_t kNever = static_cast<std::size_t>(-1);
  struct Input {
    std::string what, path;
  };
  std::map<std::pair<unsigned long, unsigned long>, Input> inputs_;  // by device and file number
  std::size_t styles_ = 0;                                           // opened when they were read
  std::size_t checked_ = 0;                                          // inputs when outputs passed, or kNever
};

}  // namespace scumble
