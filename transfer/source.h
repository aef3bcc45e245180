// A position in an exemplar.
#pragma once

namespace scumble {

// A pixel of the exemplar.
struct Source {
  int x = 0;
  int y = 0;
  bool operator==(const Source&) const = default;
};

}  // namespace scumble
