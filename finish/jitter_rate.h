// How often passes redraw what they leave to chance.
#pragma once

#include <variant>

#include "core/image/finish_pass.h"

namespace scumble {

// The pass's jitter_fps; 0 of effects that leave nothing to chance.
inline double JitterFpsOf(const FinishPass& pass) {
  return std::visit(
      [](const auto& effect) {
        if constexpr (requires { effect.jitter_fps; }) {
          return effect.jitter_fps;
        } else {
          return 0.0;
        }
      },
      pass.effect);
}

}  // namespace scumble
