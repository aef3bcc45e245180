#include "core/style/fiducials.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

#include "core/image/check.h"
#include "core/image/color.h"

namespace scumble {
namespace {

constexpr double At(int modules) { return modules * kFiducialModule; }
// The distance of a marker at a side's low end from that end, and the place of the one at its high end. There the
// sphere is 1/17 of its diameter away from the square's side.
constexpr int kLow = 11, kHigh = 64 - kLow - kFiducialModules;
constexpr int kBefore = -1 - kFiducialModules, kBehind = 64 + 1;

// A side of the square a line.
// clang-format off
constexpr std::array<Fiducial, kFiducialCount> kFiducials{{
    {0, At(kBefore), At(kBefore)}, {1, At(kLow), At(kBefore)}, {2, At(kHigh), At(kBefore)},
    {3, At(kBehind), At(kBefore)}, {4, At(kBehind), At(kLow)}, {5, At(kBehind), At(kHigh)},
    {6, At(kBehind), At(kBehind)}, {7, At(kHigh), At(kBehind)}, {8, At(kLow), At(kBehind)},
    {9, At(kBefore), At(kBehind)}, {10, At(kBefore), At(kHigh)}, {11, At(kBefore), At(kLow)},
}};
// clang-format on

constexpr std::array<const char*, kFiducialCount> kPlaces{
    "upper left corner", "top side, left",    "top side, right",    "upper right corner",
    "right side, upper", "right side, lower", "lower right corner", "bottom side, right",
    "bottom side, left", "lower left corner", "left side, lower",   "left side, upper"};

// A marker's 16 bits, rows from the top, the highest bit first; 1 is white.
using Bits = std::array<std::uint16_t, kFiducialCount>;

// Reads the library's codes, whose bits are ordered in quarter turns.
Bits ReadFamily() {
  const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family(tag16h5_create(), tag16h5_destroy);
  Bits bits{};
  for (std::size_t id = 0; id < bits.size(); ++id) {
    for (unsigned i = 0; i < family->nbits; ++i) {
      const auto bit = family->codes[id] >> (family->nbits - 1 - i) & 1;
      bits[id] =
          static_cast<std::uint16_t>(bits[id] | bit << (15 - 4 * (family->bit_y[i] - 1) - (family->bit_x[i] - 1)));
    }
  }
  return bits;
}

// The share of the pixel [i, i + 1) between `from` and `to`.
double Covered(int i, double from, double to) {
  return std::clamp(std::min<double>(i + 1, to) - std::max<double>(i, from), 0.0, 1.0);
}

// The share of pixel (x, y) that is black; (left, top) is the marker's corner, in pixels like `module`.
double BlackShare(int id, int x, int y, double left, double top, double module) {
  const auto touched = [&](int pixel, double start) {
    const int first = std::max(0, int(std::floor((pixel - start) / module)));
    const int last = std::min(kFiducialModules - 1, int(std::floor((pixel + 1 - start) / module)));
    return std::pair(first, last);
  };
  const auto [x0, x1] = touched(x, left);
  const auto [y0, y1] = touched(y, top);
  double share = 0;
  for (int row = y0; row <= y1; ++row) {
    for (int column = x0; column <= x1; ++column) {
      if (!FiducialIsBlack(id, column, row)) continue;
      share += Covered(x, left + column * module, left + (column + 1) * module) *
               Covered(y, top + row * module, top + (row + 1) * module);
    }
  }
  return share;
}

// Lays white of `zone` opacity, `black` of it black, over a pixel.
void Mix(std::uint16_t* pixel, double zone, double black) {
  const double below = pixel[3] / 65535.0 * (1.0 - zone), opacity = below + zone;
  if (!(opacity > 0.0)) return;
  for (int c = 0; c < 3; ++c) {
    pixel[c] = Srgb16FromLinear(float((Srgb16ToLinear(pixel[c]) * below + (zone - black)) / opacity));
  }
  pixel[3] = static_cast<std::uint16_t>(std::lround(opacity * 65535.0));
}

}  // namespace

const std::array<Fiducial, kFiducialCount>& Fiducials() { return kFiducials; }

const char* FiducialPlace(int id) { return kPlaces.at(std::size_t(id)); }

bool FiducialIsBlack(int id, int column, int row) {
  const auto border = [](int i) { return i == 0 || i == kFiducialModules - 1; };
  if (border(column) || border(row)) return true;
  static const Bits bits = ReadFamily();
  return (bits.at(std::size_t(id)) >> (15 - 4 * (row - 1) - (column - 1)) & 1) == 0;
}

std::string FiducialPlaces(const std::vector<int>& ids) {
  std::string text;
  for (const int id : ids) text += (text.empty() ? "" : ", ") + std::string(FiducialPlace(id));
  return text;
}

bool FiducialsFit(int size) { return size * kFiducialModule >= 2.0; }

void DrawFiducials(Picture& picture, int size, int margin) {
  SCUMBLE_CHECK(FiducialsFit(size) && margin >= kFiducialMargin * size);
  SCUMBLE_CHECK_EQ(picture.width, size + 2 * margin);
  SCUMBLE_CHECK_EQ(picture.height, size + 2 * margin);
  const double module = kFiducialModule * size, quiet = kFiducialQuiet * size, side = kFiducialSide * size;
  for (const Fiducial& mark : kFiducials) {
    const double left = margin + mark.left * size, top = margin + mark.top * size;
    const double x0 = left - quiet, y0 = top - quiet, x1 = left + side + quiet, y1 = top + side + quiet;
    for (int y = int(std::floor(y0)); y < int(std::ceil(y1)); ++y) {
      for (int x = int(std::floor(x0)); x < int(std::ceil(x1)); ++x) {
        Mix(picture.At(x, y), Covered(x, x0, x1) * Covered(y, y0, y1), BlackShare(mark.id, x, y, left, top, module));
      }
    }
  }
}

// `size` and `margin` need not be whole; all marks lie within the picture.
static int CountFiducials(const Picture& picture, double size, double margin, bool mirrored = false) {
  constexpr int kDark = 20000, kLight = 45000;  // of 65535: JPEG's noise stays on the right side
  int found = 0;
  for (const Fiducial& mark : kFiducials) {
    bool right = true;
    // One module farther than the marker: the quiet zone is part of it.
    for (int row = -1; row <= kFiducialModules && right; ++row) {
      for (int column = -1; column <= kFiducialModules && right; ++column) {
        const bool inside = std::min(row, column) >= 0 && std::max(row, column) < kFiducialModules;
        const bool black = inside && FiducialIsBlack(mark.id, column, row);
        const int x = int(margin + (mark.left + (column + 0.5) * kFiducialModule) * size);
        const int y = int(margin + (mark.top + (row + 0.5) * kFiducialModule) * size);
        const std::uint16_t green = picture.At(mirrored ? picture.width - 1 - x : x, y)[1];
        right = black ? green < kDark : green > kLight;
      }
    }
    found += right;
  }
  return found;
}

int FiducialsInPlace(const Picture& picture, int size, int margin) {
  const int side = size + 2 * margin;
  if (!FiducialsFit(size) || margin < kFiducialMargin * size || picture.width != side || picture.height != side)
    return 0;
  return CountFiducials(picture, size, margin);
}

int FiducialsInProportion(const Picture& picture) {
  const double size = 0.8 * picture.width;
  if (picture.width != picture.height || !FiducialsFit(int(size))) return 0;
  const double margin = 0.5 * (picture.width - size);
  return std::max(CountFiducials(picture, size, margin), CountFiducials(picture, size, margin, true));
}

}  // namespace scumble
