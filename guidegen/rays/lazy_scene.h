// An EmbreeScene that is built when a cast first needs it, and kept for the casts that follow.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "guidegen/rays/embree_scene.h"

namespace scumble {

class LazyScene {
 public:
  // `place` makes the list of objects anew for each build; it must always return equal lists.
  explicit LazyScene(std::function<std::vector<PlacedObject>()> place) : place_(std::move(place)) {}

  struct Lease {
    std::shared_ptr<const EmbreeScene> scene;  // stays valid after later builds
    bool built = false;                        // by this call
  };
  // A scene of this instruction set that meets the needs; errors as EmbreeScene::Build's. It is built if there is none
  // yet, if the last one had another instruction set or another `robust`, or if the needs have grown. A scene that
  // meets more needs gives equal hits. Safe to call from several threads: they wait for the one that builds. After an
  // error the next call builds again.
  Expected<Lease> Get(const std::string& isa, const EmbreeScene::Needs& needs, const Progress& progress);

 private:
  bool Suits(const std::string& isa, const EmbreeScene::Needs& needs) const;

  const std::function<std::vector<PlacedObject>()> place_;
  std::mutex mutex_;
  std::shared_ptr<const EmbreeScene> scene_;
  std::string asked_isa_;
  EmbreeScene::Needs needs_;
};

}  // namespace scumble
