#include "core/filter/more_workers.h"

#include <tbb/global_control.h>
#include <tbb/info.h>

#include <cstddef>
#include <memory>
#include <mutex>
#include <set>
#include <utility>

namespace scumble {
namespace {

struct Limit {
  std::mutex mutex;
  std::multiset<int> asked;
  int allowed = 0;  // 0: what oneTBB has of itself
  std::unique_ptr<tbb::global_control> control;

  void Update() {
    const int most = asked.empty() ? 0 : *asked.rbegin();
    const int wanted = most > tbb::info::default_concurrency() ? most : 0;
    if (wanted == allowed) return;
    allowed = wanted;
    auto next = wanted == 0 ? nullptr
                            : std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                                    std::size_t(wanted));
    control = std::move(next);
  }
};

// Never destroyed: another object's destructor may end a MoreWorkers at the program's end.
Limit& TheLimit() {
  static Limit& limit = *new Limit;
  return limit;
}

}  // namespace

MoreWorkers::MoreWorkers(int threads) : threads_(threads) {
  if (threads_ <= 0) return;
  Limit& limit = TheLimit();
  const std::lock_guard lock(limit.mutex);
  limit.asked.insert(threads_);
  limit.Update();
}

MoreWorkers::~MoreWorkers() {
  if (threads_ <= 0) return;
  Limit& limit = TheLimit();
  const std::lock_guard lock(limit.mutex);
  limit.asked.erase(limit.asked.find(threads_));
  limit.Update();
}

}  // namespace scumble
