#include "guidegen/rays/lazy_scene.h"

#include <chrono>
#include <thread>
#include <utility>

#include "guidegen/rays/progress_gate.h"

namespace scumble {

bool LazyScene::Suits(const std::string& isa, const EmbreeScene::Needs& needs) const {
  return scene_ && (isa == asked_isa_ || isa == scene_->isa()) && needs.robust == needs_.robust &&
         (needs_.light_rays || !needs.light_rays) && (needs_.emitters || !needs.emitters);
}

Expected<LazyScene::Lease> LazyScene::Get(const std::string& isa, const EmbreeScene::Needs& needs,
                                          const Progress& progress) {
  // Another thread may build for seconds: this thread can still be cancelled.
  std::unique_lock lock(mutex_, std::try_to_lock);
  for (ProgressGate gate(progress, 1, 0.0, 0.0); !lock.owns_lock();) {
    if (!gate.Continue()) return CancelledError();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    (void)lock.try_lock();
  }
  if (Suits(isa, needs)) return Lease{scene_, false};
  // Needs only grow, so that alternating casts do not build each time.
  EmbreeScene::Needs all = needs;
  all.light_rays = needs.light_rays || (scene_ && needs_.light_rays);
  all.emitters = needs.emitters || (scene_ && needs_.emitters);
  scene_.reset();  // before the next one takes its memory
  SCUMBLE_ASSIGN(EmbreeScene built, EmbreeScene::Build(place_(), isa, all, progress));
  scene_ = std::make_shared<const EmbreeScene>(std::move(built));
  asked_isa_ = isa;
  needs_ = all;
  return Lease{scene_, true};
}

}  // namespace scumble
