#include "apps/studio/session/lane.h"

#include <algorithm>
#include <utility>

namespace scumble {

Lane::Lane(RunContext context)
    : workspace_([&] {
        context.is_cancelled = [this, outer = context.is_cancelled] {
          return stopped_ || outdated_ || (outer && outer());
        };
        return std::move(context);
      }()) {}

bool Lane::IsWanted(const std::string& key) const {
  return std::any_of(wanted_.begin(), wanted_.end(), [&](const auto& one) { return one.second == key; });
}

Expected<Lane::Painted> Lane::Paint(const PictureJob& job, const std::string& client) {
  {
    const std::lock_guard lock(mutex_);
    if (kept_ && kept_key_ == job.key) return kept_;
    if (state_ != job.state) state_ = job.state, wanted_.clear();
    wanted_[client] = job.key;
    LookForOutdated();
  }
  const std::lock_guard working(work_);
  {
    const std::lock_guard lock(mutex_);
    if (kept_ && kept_key_ == job.key) return kept_;
    if (stopped_ || !IsWanted(job.key)) return CancelledError();
    running_ = job.key;
    LookForOutdated();
  }
  Expected<PaintedFrame> painted = workspace_.Paint(job.scene, job.style, job.picture, job.budget);
  const std::lock_guard lock(mutex_);
  running_.clear();
  if (!painted) return painted.error();  // not kept: a file may be whole the next time
  kept_key_ = job.key;
  kept_ = std::make_shared<const PaintedFrame>(std::move(*painted));
  return kept_;
}

void Lane::CancelUnless(const std::string& state) {
  const std::lock_guard lock(mutex_);
  if (state_ == state) return;
  wanted_.clear();
  LookForOutdated();
}

Expected<SceneDescription> Lane::Describe(const SceneRequest& scene, std::optional<int> frame) {
  const std::lock_guard working(work_);
  {
    const std::lock_guard lock(mutex_);
    LookForOutdated();  // what was cancelled before does not cancel this
  }
  return workspace_.Describe(scene, frame);
}

std::vector<std::string> Lane::SceneFiles() {
  const std::lock_guard working(work_);
  return workspace_.SceneFiles();
}

void Lane::Stop() {
  stopped_ = true;
  workspace_.Cancel();
}

}  // namespace scumble
