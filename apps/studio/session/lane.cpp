#include "apps/studio/session/lane.h"

#include <utility>

namespace scumble {

Lane::Lane(RunContext context)
    : workspace_([&] {
        context.is_cancelled = [this, outer = context.is_cancelled] { return IsOutdated() || (outer && outer()); };
        return std::move(context);
      }()) {}

Expected<Lane::Painted> Lane::Paint(const PictureJob& job) {
  std::uint64_t ticket = 0;
  {
    const std::lock_guard lock(mutex_);
    if (kept_ && kept_key_ == job.key) return kept_;
    if (wanted_ != job.key) wanted_ = job.key, ++newest_;
    ticket = newest_;
  }
  const std::lock_guard working(work_);
  {
    const std::lock_guard lock(mutex_);
    if (kept_ && kept_key_ == job.key) return kept_;
    if (stopped_ || ticket != newest_) return CancelledError();
    running_ = ticket;
  }
  Expected<PaintedFrame> painted = workspace_.Paint(job.scene, job.style, job.picture, job.budget);
  const std::lock_guard lock(mutex_);
  if (!painted && painted.error().kind == ErrorKind::kCancelled) {
    if (wanted_ == job.key) wanted_.clear();
    return painted.error();
  }
  if (!painted) return painted.error();  // not kept: a file may be whole the next time
  kept_key_ = job.key;
  kept_ = std::make_shared<const PaintedFrame>(std::move(*painted));
  return kept_;
}

void Lane::CancelUnless(const std::string& key) {
  const std::lock_guard lock(mutex_);
  if (wanted_ == key) return;
  wanted_.clear();
  ++newest_;
}

Expected<SceneDescription> Lane::Describe(const SceneRequest& scene, std::optional<int> frame) {
  const std::lock_guard working(work_);
  running_ = newest_.load();  // what was wanted before does not cancel this
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
