// Helpers shared by the files of the cross-check. Private to measure/crosscheck.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "scumble/picture.h"

namespace scumble::internal {

// Pixels whose whole neighbourhood, `reach` to each side, is covered in both sets and shows one object in each.
std::vector<std::size_t> ErodedMask(const GuideSet& a, const GuideSet& b, int reach);

// An opaque pixel of that linear colour.
void PutColor(Picture& picture, std::size_t i, glm::vec3 linear);

// "1 sample", "64 samples".
std::string Counted(int count, const char* what);

}  // namespace scumble::internal
