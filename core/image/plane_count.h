// How much memory planes took, for tests and reports.
#pragma once

#include <cstddef>

namespace scumble {

// Bytes that AllocatePlane has handed out since the process began, in all threads. Freed planes stay in the count.
std::size_t PlaneBytesHandedOut();

}  // namespace scumble
