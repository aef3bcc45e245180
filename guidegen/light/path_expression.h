// Light-path expressions: they define which paths belong to a layer (Heckbert 1990). A path is written from its light
// to the eye, one letter an event: L the light, D a diffuse and S a specular reflection, E the eye. "LDE" is direct
// diffuse light, "LE" a light in direct view.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/image/status.h"

namespace scumble {

enum class PathEvent { kLight, kDiffuse, kSpecular, kEye };
inline constexpr int kPathEvents = 4;

// A compiled expression. Paths are traced from the eye, so it reads events in that order: from Start(), one Step an
// event, beginning with kEye. Immutable; free to use from any thread.
class PathExpression {
 public:
  using State = std::int16_t;
  static constexpr State kDead = -1;  // no continuation can match

  // A sequence of L, D, S, E, "." (any event) and sets like "[DS]", each with an optional "*", "+", "?", "{n}",
  // "{m,n}" or "{m,}". Fails with kUsage, quoting the text, on anything else and on more than 60 events.
  static Expected<PathExpression> Parse(std::string_view text);

  State Start() const { return start_; }
  State Step(State state, PathEvent event) const {
    return state == kDead ? kDead : nodes_[std::size_t(state)].next[int(event)];
  }
  // Whether the path is complete and matches.
  bool Accepts(State state) const { return state != kDead && nodes_[std::size_t(state)].accepts; }
  // Whether a light hit here completes a path that matches.
  bool EndsWithLight(State state) const { return Accepts(Step(state, PathEvent::kLight)); }

 private:
  struct Node {
    std::array<State, kPathEvents> next{kDead, kDead, kDead, kDead};
    bool accepts = false;
  };
  struct Item;
  void Compile(const std::vector<Item>& items);
  void DropHopeless();

  std::vector<Node> nodes_;
  State start_ = kDead;
};

}  // namespace scumble
