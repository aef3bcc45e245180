// How far a long computation is, and whether to go on.
#pragma once

#include <functional>

namespace scumble {

// Called with the finished share in [0, 1], from any thread but never from two at once. Returning false cancels the
// computation, which then returns kCancelled and leaves nothing behind. May be empty.
using Progress = std::function<bool(double share)>;

}  // namespace scumble
