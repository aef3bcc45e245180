#include "core/style/sphere_template.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "core/image/check.h"
#include "core/image/color.h"
#include "core/image/direction.h"
#include "core/style/fiducials.h"

namespace scumble {
namespace {

constexpr std::uint16_t kWhite = 65535;

void Fill(Picture& picture, const TemplateMark& mark) {
  for (int y = std::max(0, mark.y0); y < std::min(picture.height, mark.y1); ++y) {
    for (int x = std::max(0, mark.x0); x < std::min(picture.width, mark.x1); ++x) {
      std::uint16_t* pixel = picture.At(x, y);
      pixel[0] = pixel[1] = pixel[2] = mark.grey, pixel[3] = 65535;
    }
  }
}

int Stroke(int size) { return std::max(1, size / 256); }

std::vector<TemplateMark> Ticks(int size) {
  const int stroke = Stroke(size), margin = TemplateMargin(size), far = margin + size, tick = margin / 4;
  constexpr std::uint16_t kGrey = 40000;
  std::vector<TemplateMark> marks;
  for (const int side : {margin, far - stroke}) {
    marks.insert(marks.end(), {{side, 0, side + stroke, tick, kGrey},
                               {side, far + margin - tick, side + stroke, far + margin, kGrey},
                               {0, side, tick, side + stroke, kGrey},
                               {far + margin - tick, side, far + margin, side + stroke, kGrey}});
  }
  return marks;
}

std::vector<TemplateMark> Crosses(int size) {
  const int stroke = Stroke(size), margin = TemplateMargin(size), arm = std::max(1, margin / 3), far = margin + size;
  std::vector<TemplateMark> marks;
  for (const int cy : {margin / 2, far + margin - margin / 2}) {
    for (const int cx : {margin / 2, far + margin - margin / 2}) {
      marks.push_back({cx - arm, cy - stroke / 2, cx + arm, cy - stroke / 2 + stroke, 0});
      marks.push_back({cx - stroke / 2, cy - arm, cx - stroke / 2 + stroke, cy + arm, 0});
    }
  }
  return marks;
}

// The size of the sphere whose template has so many pixels a side, or nothing. size + 2 · margin(size) grows with the
// size, so that one fits at most.
std::optional<int> SizeOfTemplate(int side) {
  int size = side * 4 / 5 - 8;
  while (size + 2 * TemplateMargin(size) < side) ++size;
  return size + 2 * TemplateMargin(size) == side && size > 0 ? std::optional(size) : std::nullopt;
}

bool ShowsCrosses(const Picture& picture, int size) {
  constexpr int kSmallestRecognised = 63;  // below it the crosses are specks
  if (size < kSmallestRecognised) return false;
  const int margin = TemplateMargin(size), arm = margin / 3;
  const auto brightness = [&](int x, int y) { return picture.At(x, y)[1]; };
  for (const int cy : {margin / 2, picture.height - margin / 2}) {
    for (const int cx : {margin / 2, picture.width - margin / 2}) {
      const bool cross = brightness(cx, cy) < 20000 && brightness(cx - arm / 2, cy) < 20000 &&
                         brightness(cx, cy - arm / 2) < 20000 && brightness(cx - arm / 2, cy - arm / 2) > 40000;
      if (!cross) return false;
    }
  }
  return true;
}

Picture SphereOnPaper(const KitLight& light) {
  Picture picture = DrawLitSphere(light);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    if (picture.rgba[i + 3] == 0) std::fill_n(&picture.rgba[i], 4, kWhite);
  }
  return picture;
}

}  // namespace

std::string AnglesInWords(const KitLight& light) {
  char angles[120];
  std::snprintf(angles, sizeof angles, "azimuth %g, elevation %g degrees", light.azimuth, light.elevation);
  return angles;
}

std::string PlaceInWords(const KitLight& light) {
  constexpr double kClearly = 0.2;  // of the direction's length
  const glm::dvec3 to_light = DirectionFromAngles(light.azimuth, light.elevation);
  const auto word = [](double along, const char* below, const char* above) {
    return std::string(along < -kClearly ? below : along > kClearly ? above : "");
  };
  const std::string height = word(to_light.y, "below", "above"), side = word(to_light.x, "left", "right");
  std::string place = height.empty() ? side : side.empty() ? height : (height == "above" ? "upper " : "lower ") + side;
  if (!side.empty()) place = "the " + place;
  if (to_light.z < -kClearly) place += place.empty() ? "behind" : ", behind the sphere";
  return place.empty() ? "the viewer" : place;
}

double PaleGrey(const std::uint16_t* lit) {
  constexpr double kDarkest = 0.18;
  return lit[3] == 0 ? 1.0 : 1.0 - kDarkest * (1.0 - lit[0] / 65535.0);
}

int TemplateMargin(int size) { return (size + 7) / 8; }

std::optional<int> SphereMargin(const GuideSet& guides) {
  const auto found = guides.attributes.find(kMarginAttribute);
  if (found == guides.attributes.end() || guides.width() != guides.height()) return std::nullopt;
  const std::string& text = found->second;
  int margin = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), margin);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) return std::nullopt;
  const int limit = guides.width() > 0 ? guides.width() : kMaxImageSide;  // a header alone has no size
  if (margin < 0 || margin > limit) return std::nullopt;
  return margin;
}

std::vector<TemplateMark> PlainMarks(int size) {
  std::vector<TemplateMark> marks = Ticks(size);
  if (FiducialsFit(size)) return marks;
  const std::vector<TemplateMark> crosses = Crosses(size);
  marks.insert(marks.end(), crosses.begin(), crosses.end());
  return marks;
}

Picture DrawLitSphere(const KitLight& light) {
  const GuideSet& guides = light.guides;
  SCUMBLE_CHECK_EQ(guides.width(), guides.height());
  const glm::vec3 to_light(DirectionFromAngles(light.azimuth, light.elevation));
  const int size = guides.width(), margin = TemplateMargin(size);
  Picture picture(size + 2 * margin, size + 2 * margin);
  const auto coverage = guides.Plane(Layer::kCoverage), luminance = guides.Plane(Layer::kLuminance);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (!(coverage[i] > 0.0f)) continue;
      // A little reflected light from the far side keeps the form readable in the shade, as in a studio.
      const glm::vec3 normal = guides.Vec3(Layer::kNormal, i);
      const float away = std::max(0.0f, -glm::dot(normal, to_light));
      const float lit = 0.03f + 0.12f * away + 0.05f * normal.z + 0.80f * luminance[i];
      const float blended = lit * coverage[i] + (1.0f - coverage[i]);
      std::uint16_t* pixel = picture.At(x + margin, y + margin);
      pixel[0] = pixel[1] = pixel[2] = Srgb16FromLinear(blended);
      pixel[3] = 65535;
    }
  }
  return picture;
}

Picture DrawMarks(int size) {
  const int margin = TemplateMargin(size);
  Picture picture(size + 2 * margin, size + 2 * margin);
  for (const TemplateMark& mark : PlainMarks(size)) Fill(picture, mark);
  if (FiducialsFit(size)) DrawFiducials(picture, size, margin);
  return picture;
}

Picture DrawTemplate(const KitLight& light) {
  Picture picture = SphereOnPaper(light);
  const int size = light.guides.width();
  for (const TemplateMark& mark : PlainMarks(size)) Fill(picture, mark);
  if (FiducialsFit(size)) DrawFiducials(picture, size, TemplateMargin(size));
  return picture;
}

Picture DrawTemplateWithCrosses(const KitLight& light) {
  Picture picture = SphereOnPaper(light);
  const int size = light.guides.width();
  for (const TemplateMark& mark : Crosses(size)) Fill(picture, mark);
  for (const TemplateMark& mark : Ticks(size)) Fill(picture, mark);
  return picture;
}

bool LooksLikeTemplate(const Picture& picture) {
  if (picture.width != picture.height) return false;
  constexpr int kEnough = kFiducialCount / 2;  // paint may cover some; noise draws none
  if (FiducialsInProportion(picture) >= kEnough) return true;
  const std::optional<int> size = SizeOfTemplate(picture.width);
  if (!size) return false;
  return FiducialsInPlace(picture, *size, TemplateMargin(*size)) >= kEnough || ShowsCrosses(picture, *size);
}

}  // namespace scumble
