// One workspace for requests of which only the newest counts: while the page moves on, what it asked for before is
// cancelled.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/budget_choice.h"
#include "pipeline/requests.h"
#include "pipeline/workspace.h"

namespace scumble {

// All that a picture depends on.
struct PictureJob {
  std::string state;  // the settings and the generation of the files as text
  std::string key;    // equal keys, equal pictures: the state, and what is shown of it
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
  // it is painted. What this lane was painting ends as kCancelled if it is of another state, or if the same client
  // asked for it; another client's picture of this state comes first. From any thread.
  Expected<Painted> Paint(const PictureJob& job, const std::string& client = "");

  // Cancels what runs or waits, unless it is of this state.
  void CancelUnless(const std::string& state);

  // What Workspace::Describe says, once nothing is painted. A newer picture, which needs the scene too, waits for it.
  Expected<SceneDescription> Describe(const SceneRequest& scene, std::optional<int> frame);

  // What Workspace::SceneFiles says.
  std::vector<std::string> SceneFiles();

  void Stop();  // cancels, now and from now on

 private:
  bool IsWanted(const std::string& key) const;
  void LookForOutdated() { outdated_ = !running_.empty() && !IsWanted(running_); }

  std::atomic<bool> stopped_ = false;
  std::atomic<bool> outdated_ = false;         // nobody wants what runs any more
  std::mutex mutex_;                           // of what follows
  std::string state_;                          // of the newest request
  std::map<std::string, std::string> wanted_;  // by client the key of its newest request, all of that state
  std::string running_;                        // the key of what is painted now; empty: nothing
  std::string kept_key_;
  Painted kept_;
  std::mutex work_;  // of the workspace
  Workspace workspace_;
};

}  // namespace scumble
