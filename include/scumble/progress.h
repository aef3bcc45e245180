// How a long computation talks to its caller: libraries never print.
#pragma once

#include <functional>

namespace scumble {

// Called with the finished share in [0, 1], from any thread but never from two at once. Returning false asks the
// computation to stop; it then returns a kCancelled error and leaves nothing behind. An empty function is allowed.
using Progress = std::function<bool(double share)>;

}  // namespace scumble
