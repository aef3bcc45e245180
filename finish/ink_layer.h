// The ink of one pass as a layer over what lies below it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/image/finish_pass.h"
#include "scumble/picture.h"

namespace scumble::internal {

// Whether the pass lays ink on what is there. All others paint anew.
bool LaysInk(const FinishPass& pass);

// What a pass of ink has changed.
struct InkChange {
  const Picture& before;  // the pixels that differ in these two are the inked ones
  const Picture& after;
  const Picture& target;                   // what the layer over `below` is to show
  std::optional<Rgb16> ink;                // where the pass has one
  std::vector<std::uint16_t> shares = {};  // how dense the ink is at each pixel; empty: as `ink` needs it
};

struct InkLayer {
  Picture picture;
  bool atop = false;           // as FinishLayer has it
  bool reaches_target = true;  // to 1/255, colours as they show
};

// The layer that over or atop `below` shows `target`, and puts it there. Ink that raises no alpha, such as hatching
// along a silhouette, is laid atop. Where a density or a colour alone does not lead to the target, the other follows:
// what `below` has lost by rounding is made up for. Where alpha is partial below and raised, the target decides on the
// density. Then there may be no colour that leads to it, as pictures blend in linear light and layers do not. `most` is
// the largest value of a channel in the file, 255 or 65535: values of the layer are such steps. O(pixels), on the
// caller's arena of threads.
InkLayer InkBetween(const InkChange& change, int most, Picture& below);

}  // namespace scumble::internal
