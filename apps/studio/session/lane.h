// One workspace for requests of which only the newest counts: while the page moves on, what it asked for before is
// cancelled.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/quality/budget_choice.h"
#include "pipeline/requests.h"
#include "pipeline/workspace.h"

namespace scumble {

// All that a picture depends on.
struct PictureJob {
  std::string key;  // equal keys, equal pictures: the settings and the generation of the files as text
  SceneRequest scene;
  StyleRequest style;
  PictureRequest picture;
  BudgetRequest budget;
};

class Lane {
 public:
  using Painted = std::shared_ptr<const PaintedFrame>;

  explicit Lane(RunContext context);

  // The picture of the job: the kept one where its key is the same, the one that is being painted likewise; otherwise
  // it is painted, and whatever this lane was painting ends as kCancelled. From any thread.
  Expected<Painted> Paint(const PictureJob& job);

  // Cancels what runs or waits, unless it has this key.
  void CancelUnless(const std::string& key);

  // What Workspace::Describe says, once nothing is painted.
  Expected<SceneDescription> Describe(const SceneRequest& scene, std::optional<int> frame);

  // What Workspace::SceneFiles says.
  std::vector<std::string> SceneFiles();

  void Stop();  // cancels, now and from now on

 private:
  bool IsOutdated() const { return stopped_ || running_ != newest_; }

  std::atomic<bool> stopped_ = false;
  std::atomic<std::uint64_t> newest_ = 0, running_ = 0;  // tickets
  std::mutex mutex_;                                     // of what follows
  std::string wanted_;                                   // the key of the newest ticket; empty: of none
  std::string kept_key_;
  Painted kept_;
  std::mutex work_;  // of the workspace
  Workspace workspace_;
};

}  // namespace scumble
