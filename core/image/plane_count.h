// How much memory planes took, for tests and reports.
#pragma once

#include <cstddef>

namespace scumble {

// Bytes that AllocatePlane has handed out since the process began, all threads together; what was given back counts on.
std::size_t PlaneBytesHandedOut();

}  // namespace scumble
