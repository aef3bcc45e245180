#include "core/style/place_sphere.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/painting/find_sphere.h"
#include "core/style/rectify.h"
#include "core/style/sphere_kit.h"
#include "core/style/sphere_template.h"

namespace scumble {
namespace {

using Kind = FoundSphere::Kind;

std::string Rounded(double value) { return std::to_string(std::lround(value)); }

std::string SizeText(const Picture& picture) {
  return std::to_string(picture.width) + "×" + std::to_string(picture.height);
}

std::string PlaceText(const Circle& circle) { return "x=" + Rounded(circle.x) + ", y=" + Rounded(circle.y); }

void CutTo(const Circle& circle, Exemplar& exemplar) {
  const Picture& file = exemplar.picture;
  const int side = std::max(1, static_cast<int>(std::lround(2.0 * circle.radius)));
  const int left = static_cast<int>(std::lround(circle.x - 0.5 * side));
  const int top = static_cast<int>(std::lround(circle.y - 0.5 * side));
  Picture cut(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const int u = std::clamp(left + x, 0, file.width - 1), v = std::clamp(top + y, 0, file.height - 1);
      std::copy_n(file.At(u, v), 4, cut.At(x, y));
    }
  }
  exemplar.cut = SphereCut{left, top, file.width, file.height, circle.x, circle.y, circle.radius};
  exemplar.picture = std::move(cut);
}

// What a picture shows instead of a sphere, and what to do.
std::string WhyNone(const FoundSphere& found, bool is_square) {
  // Paper may be what a painter left for the lights.
  const std::string fills = is_square ? "; if the sphere fills the square all the same, write fills = true under its "
                                        "[[exemplar]] in style.toml, or --set exemplar.1.fills=true"
                                      : "";
  switch (found.doubt) {
    case SphereDoubt::kShadow:
      return "around " + PlaceText(found.circle) +
             " it shows a sphere that is no clear circle, because the ground below it is darker than elsewhere, as in "
             "a shadow: cut the shadow away, so that the ground has one colour, or crop the picture to the square "
             "around the sphere" +
             fills;
    case SphereDoubt::kUnevenGround:
      return "its ground has several colours, as paper that is lit unevenly: cut the sphere out onto transparency, or "
             "crop the picture to the square around it; or give the guides of the scene that it shows" +
             fills;
    case SphereDoubt::kSmall:
      return "its paint is less than 30 pixels across, too small to find a sphere in: paint it larger, or crop the "
             "picture to the square around the sphere";
    case SphereDoubt::kNone:
    case SphereDoubt::kNoCircle:
      break;
  }
  return (found.kind == Kind::kNoGround
              ? "its corners are neither transparent nor paper of one colour to find a sphere on: "
              : "its paint shows no clear sphere on its ground: ") +
         std::string(
             "an exemplar is a square that its sphere fills; crop it to the sphere, or give the guides of the "
             "scene that it shows") +
         fills;
}

// Marks and margin would become part of the paint. Guides of the kit say where the margin ends.
Error WholeTemplate(const std::string& name) {
  const auto guides = GuidesOfPainting(name);
  return InputError(name + " is a whole template, margin and marks included: " +
                    (guides ? "write guides = \"" + guides->filename().string() +
                                  "\" under its [[exemplar]] in style.toml, or crop the picture to the sphere"
                            : "crop the picture to the sphere, or write the guides of its template under its "
                              "[[exemplar]] in style.toml"));
}

Error MovedTemplate(const std::string& name) {
  return InputError(name +
                    " is a whole template, scanned, moved or turned, margin and marks included: bring the sphere "
                    "into its place with `scumble sphere --rectify \"" +
                    name + "\"`, or crop the picture to the sphere");
}

// Whether the corners, outside the ellipse that fills the picture, are mostly light and partly black, as marks on paper
// are: a hint that spares most paintings the search for marks.
bool MayShowMarks(const Picture& picture) {
  constexpr double kLeastLight = 0.5, kLeastDark = 0.03;
  constexpr int kDark = 20000, kLight = 45000;
  std::size_t all = 0, light = 0, dark = 0;
  for (int y = 0; y < picture.height; ++y) {
    const double v = 2.0 * (y + 0.5) / picture.height - 1.0;
    const int width = static_cast<int>(0.5 * picture.width * (1.0 - std::sqrt(1.0 - v * v)));
    for (int x = 0; x < width; ++x) {
      for (const int at : {x, picture.width - 1 - x}) {
        const std::uint16_t* pixel = picture.At(at, y);
        ++all, light += pixel[1] > kLight || pixel[3] < kDark, dark += pixel[1] < kDark && pixel[3] > kLight;
      }
    }
  }
  return double(light) >= kLeastLight * double(all) && double(dark) >= kLeastDark * double(all);
}

}  // namespace

Status PlaceSphere(Exemplar& exemplar) {
  const Picture& picture = exemplar.picture;
  if (exemplar.fills || !exemplar.is_sphere || !exemplar.guides_file.empty() || exemplar.guides || picture.empty())
    return Ok();
  if (LooksLikeTemplate(picture)) return WholeTemplate(exemplar.name);
  const FoundSphere found = FindSphere(picture);
  const bool is_square = picture.width == picture.height;
  const bool is_usable =
      found.kind == Kind::kInside || (is_square && (found.kind == Kind::kFills || found.kind == Kind::kNoGround));
  if ((!is_usable || MayShowMarks(picture)) && FindTemplate(picture)) return MovedTemplate(exemplar.name);
  if (is_usable && found.kind != Kind::kInside) return Ok();
  switch (found.kind) {
    case Kind::kInside:
      CutTo(found.circle, exemplar);
      return Ok();
    case Kind::kEllipse:
      return InputError(exemplar.name + " shows an ellipse, " + Rounded(found.longer) + " pixels long and " +
                        Rounded(found.shorter) +
                        " wide: an exemplar shows a sphere; scale the picture in one direction until it is round");
    case Kind::kSeveral:
      return InputError(exemplar.name + " shows more than one sphere, around " + PlaceText(found.circle) + " and " +
                        PlaceText(found.second) + ": an exemplar shows one; crop the picture to it");
    case Kind::kFills:
    case Kind::kNoGround:
    case Kind::kUnclear:
      break;
  }
  return InputError(exemplar.name + " is " + SizeText(picture) + ", and " + WhyNone(found, is_square));
}

std::string DescribeCut(const SphereCut& cut) {
  return "its sphere does not fill the picture of " + std::to_string(cut.file_width) + "×" +
         std::to_string(cut.file_height) + "; it is taken as it lies, around " + PlaceText({cut.x, cut.y, cut.radius}) +
         ", with a radius of " + Rounded(cut.radius) + " pixels";
}

}  // namespace scumble
