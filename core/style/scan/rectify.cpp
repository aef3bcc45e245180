#include "core/style/rectify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/image/check.h"
#include "core/image/color.h"
#include "core/style/scan/homography.h"
#include "core/style/scan/marker_detection.h"
#include "core/style/scan/paper_light.h"
#include "core/style/scan/resample_scan.h"
#include "core/style/scan/template_fit.h"
#include "core/style/sphere_kit.h"

namespace scumble {
namespace {

std::string Number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}
std::string Percent(double share) { return Number(share < 0.0995 ? "%.2f%%" : "%.0f%%", 100 * share); }
std::string Pixels(int width, int height) { return std::to_string(width) + "×" + std::to_string(height) + " pixels"; }

void LayOnWhite(Picture& picture) {
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    std::uint16_t* pixel = &picture.rgba[i];
    if (pixel[3] == 65535) continue;
    const float alpha = float(pixel[3]) / 65535.0f;
    for (int c = 0; c < 3; ++c) pixel[c] = Srgb16FromLinear(Srgb16ToLinear(pixel[c]) * alpha + 1.0f - alpha);
    pixel[3] = 65535;
  }
}

void SplitIds(const std::vector<FoundMark>& marks, std::vector<int>& found, std::vector<int>& missing) {
  for (int id = 0; id < kFiducialCount; ++id) {
    const bool there = std::any_of(marks.begin(), marks.end(), [&](const FoundMark& mark) { return mark.id == id; });
    (there ? found : missing).push_back(id);
  }
}

// The required fineness of a new scan, in words: in dpi if the file gives its own.
std::string FinerScan(double factor, double dpi) {
  constexpr double kStep = 50;
  if (dpi > 0) return "scan it at " + Number("%.0f", std::ceil(dpi * factor / kStep) * kStep) + " dpi or more";
  return "scan it " + Number("%.1f", std::ceil(factor * 10) / 10) +
         " times as fine (300 dpi do for a sphere of 90 mm), or go closer with the camera";
}

Picture Mirrored(const Picture& picture) {
  Picture mirrored(picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) std::copy_n(picture.At(x, y), 4, mirrored.At(picture.width - 1 - x, y));
  }
  return mirrored;
}

// Explains why no map fits the marks.
Error NoTemplate(const Picture& scan, const std::string& name, const std::vector<FoundMark>& marks,
                 const RectifyOptions& options) {
  std::vector<int> found, missing;
  SplitIds(marks, found, missing);
  const std::string size = name + " (" + Pixels(scan.width, scan.height) + ")";
  if (FitTemplate(FindMarks(Mirrored(scan)), scan.width, scan.height)) {
    return InputError(name +
                      " shows the template mirrored: flip it left to right, or switch off mirroring in the camera or "
                      "scanner program");
  }
  if (found.size() >= 4) {
    return InputError(size + " shows " + std::to_string(found.size()) + " of the template's marks (" +
                      FiducialPlaces(found) +
                      "), but not where they lie on one sheet: expected one flat template; is it folded, or cut "
                      "and pasted?");
  }
  if (!found.empty()) {
    return InputError(size + " shows " + std::to_string(found.size()) + " of the template's " +
                      std::to_string(kFiducialCount) + " marks (" + FiducialPlaces(found) +
                      "); at least 4 are needed, and these are missing: " + FiducialPlaces(missing) +
                      ". Take the whole sheet into the picture, sharp and without shadows on the marks");
  }
  if (std::min(scan.width, scan.height) < kMinScanSphere) {
    const double factor = 1.25 * 2 * kMinScanSphere / std::min(scan.width, scan.height);
    return InputError(size + " is too small to read the template's marks: " + FinerScan(factor, options.dpi));
  }
  return InputError(
      size + " shows none of the template's " + std::to_string(kFiducialCount) +
      " printed marks: expected a scan or photograph of a whole sheet from `scumble sphere`, sharp, evenly lit, "
      "the marks not covered. Marks of other programs will not do; templates whose corners have plain crosses are "
      "older, or too small to have marks");
}

Error SeveralTemplates(const std::string& name, std::size_t marks) {
  return InputError(name + " shows several templates, " + std::to_string(marks) + " marks of them: expected the " +
                    std::to_string(kFiducialCount) + " of one; cut the picture to one of them");
}

// The marks beside those of the fit, if a sheet of their own fits them; else none.
std::vector<FoundMark> MarksOfAnotherFit(const std::vector<FoundMark>& marks, const TemplateFit& fit, int width,
                                         int height) {
  std::vector<FoundMark> rest;
  for (const FoundMark& mark : marks) {
    const bool used = std::any_of(fit.marks.begin(), fit.marks.end(), [&](const FoundMark& other) {
      return glm::length(other.corners[0] - mark.corners[0]) < other.module_pixels;
    });
    if (!used) rest.push_back(mark);
  }
  return FitTemplate(rest, width, height) ? rest : std::vector<FoundMark>();
}

// A sheet has each mark once.
bool HaveACommonId(const std::vector<FoundMark>& some, const std::vector<FoundMark>& others) {
  return std::any_of(some.begin(), some.end(), [&](const FoundMark& mark) {
    return std::any_of(others.begin(), others.end(), [&](const FoundMark& other) { return other.id == mark.id; });
  });
}

// The sheet's pose: from the map's slopes in the template's middle, and from how they change across it.
void MeasurePose(const TemplateMap& map, RectifyReport& report) {
  const double degrees = 180.0 / std::acos(-1.0);
  report.rotation = map.Turn();
  // Cameras see the picture's longer side at about 67 degrees: the focal length is 0.75 of it.
  const double focal = 0.75 * 2 * std::max(map.middle.x, map.middle.y);
  const glm::dmat3 camera(focal, 0, 0, 0, focal, 0, map.middle.x, map.middle.y, 1);
  const glm::dmat3 axes = glm::inverse(camera) * map.perspective;
  const glm::dvec3 normal = glm::normalize(glm::cross(axes[0], axes[1]));
  report.tilt = std::acos(std::min(1.0, std::abs(normal.z))) * degrees;
  report.lens = map.bend;
}

// The largest number of scan pixels per output pixel, in any direction, at a few places.
double Shrink(const TemplateMap& map, int size) {
  double most = 0;
  const double step = 1.0 / size;
  for (int i = 0; i < 25; ++i) {
    const glm::dvec2 at = glm::dvec2(i % 5, i / 5) * 0.3125 - 0.125;
    const glm::dvec2 here = map.ToPicture(at);
    for (const glm::dvec2 way : {glm::dvec2(step, 0), glm::dvec2(0, step)}) {
      most = std::max(most, glm::length(map.ToPicture(at + way) - here));
    }
  }
  return most;
}

void NoteLight(const PaperLight& light, RectifyReport& report) {
  const glm::dvec3 white = light.White({0.5, 0.5});
  report.paper_light = std::max({white.r, white.g, white.b});
  for (int c = 0; c < 3; ++c) report.paper[c] = white[c] / report.paper_light;
  report.unevenness = light.Unevenness();
  report.black = (light.black[0] + light.black[1] + light.black[2]) / 3;
  report.bare_margin = light.bare_share;
  report.clipped = light.clipped_share;
}

// Bare paper is as light as the fit of the paper's light in all channels.
void MeasurePaint(const LinearPicture& pixels, const PaperLight& light,
                  const std::function<glm::dvec2(glm::dvec2)>& on_template, RectifyReport& report) {
  constexpr double kAsPaper = 0.9, kRim = 0.98;
  double disc = 0, painted = 0, rim = 0, painted_rim = 0;
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = 0; x < pixels.width; ++x) {
      const glm::dvec2 at = on_template({x + 0.5, y + 0.5});
      const double radius = 2 * glm::length(at - 0.5);
      if (radius >= 1) continue;
      const glm::dvec3 white = light.White(at);
      const float* rgb = &pixels.rgb[3 * (std::size_t(y) * pixels.width + x)];
      const bool bare = rgb[0] > kAsPaper * white.r && rgb[1] > kAsPaper * white.g && rgb[2] > kAsPaper * white.b;
      disc += 1, painted += !bare;
      if (radius > kRim) rim += 1, painted_rim += !bare;
    }
  }
  report.painted = disc > 0 ? painted / disc : 0;
  report.painted_rim = rim > 0 ? painted_rim / rim : 0;
}

void Warn(const RectifyOptions& options, const TemplateFit& fit, RectifyReport& report) {
  std::vector<std::string>& say = report.warnings;
  if (report.error > kGoodRegistrationError) {
    say.push_back("the painting may be shifted on the sphere by " + Percent(report.error) +
                  " of its diameter, which shows at silhouettes; the mark farthest from its place is at the " +
                  FiducialPlace(fit.worst_id) + " (" + Percent(fit.worst) +
                  "): lay the sheet flatter, under glass, or scan it");
  }
  if (report.sphere_pixels < 0.75 * options.size) {
    say.push_back("the sphere is " + Number("%.0f", report.sphere_pixels) + " pixels across and was enlarged to " +
                  std::to_string(options.size) + ": " + FinerScan(options.size / report.sphere_pixels, options.dpi) +
                  ", or take a smaller --size");
  }
  if (report.unevenness > 0.5) {
    say.push_back("the light falls off by " + Percent(report.unevenness) +
                  " across the sheet: what the shade of it hides cannot be brought back");
  }
  if (report.clipped > 0.2) {
    say.push_back(Percent(report.clipped) +
                  " of the paper is overexposed, as bright as the file can hold: colours come out too light, by a "
                  "little where a scanner clips its paper, by much in a photograph that is too bright; take it darker");
  }
  if (report.bare_margin < 0.8) {
    say.push_back("only " + Percent(report.bare_margin) +
                  " of the margin looks like bare paper in even light: colours may be off where a "
                  "shadow lies on the sheet, or much of the margin is painted");
  }
  if (report.black > 0.3) {
    say.push_back("the printed black is " + Percent(report.black) +
                  " as light as the paper: is there glare on the sheet?");
  }
  if (report.painted_rim < 0.9) {
    say.push_back(Percent(1 - report.painted_rim) +
                  " of the sphere's edge is bare paper, which will show at silhouettes: let "
                  "strokes run over the edge");
  }
  if (report.painted < 0.9) say.push_back(Percent(1 - report.painted) + " of the sphere is bare paper");
}

// Converts the pixels to white paper in even white light.
Picture Finish(const LinearPicture& pixels, const PaperLight& light,
               const std::function<glm::dvec2(glm::dvec2)>& on_template, bool balance) {
  Picture picture(pixels.width, pixels.height);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const glm::dvec3 white = balance ? light.White(on_template({x + 0.5, y + 0.5})) : glm::dvec3(1.0);
      const float* rgb = &pixels.rgb[3 * (std::size_t(y) * picture.width + x)];
      std::uint16_t* out = picture.At(x, y);
      for (int c = 0; c < 3; ++c) {
        const double black = light.black[std::size_t(c)];
        const double share = balance ? kPaperWhite * (rgb[c] / white[c] - black) / (1 - black) : rgb[c];
        out[c] = Srgb16FromLinear(float(share));
      }
      out[3] = 65535;
    }
  }
  return picture;
}

constexpr const char* kCurled =
    "the paper is curled or folded, or the lens bends straight lines: lay the sheet flat under glass, scan it, or take "
    "it from farther away";

// The first reason in the marks to refuse.
Status CheckFit(const TemplateFit& fit, const std::string& name, const RectifyOptions& options) {
  const double sphere = fit.map.SpherePixels();
  if (!(sphere >= kMinScanSphere)) {
    return InputError("in " + name + " the sphere is " + Number("%.0f", sphere) + " pixels across; at least " +
                      std::to_string(kMinScanSphere) + " are needed, as many as --size are good: " +
                      FinerScan(std::max<double>(kMinScanSphere, std::min(options.size, 1024)) / sphere, options.dpi));
  }
  if (!(fit.held_out <= kMaxRegistrationError)) {
    double blur = 0;
    for (const FoundMark& mark : fit.marks) blur = std::max(blur, mark.blur_pixels / mark.module_pixels);
    const std::string why = blur > 0.35 ? "the picture is too blurred: keep the camera still and in focus" : kCurled;
    return InputError("the marks in " + name + " do not lie as on a flat sheet: " + Percent(fit.held_out) +
                      " of the sphere's diameter apart, at most " + Percent(kMaxRegistrationError) +
                      " is let through; worst at the " + FiducialPlace(fit.worst_id) + " (" + Percent(fit.worst) +
                      "). Most likely " + why);
  }
  if (!(fit.on_sphere <= kMaxRegistrationError)) {
    std::vector<int> found, missing;
    SplitIds(fit.marks, found, missing);
    return InputError("the marks that " + name + " shows (" + FiducialPlaces(found) +
                      ") leave open where the sphere is, by " + Percent(fit.on_sphere) + " of its diameter; at most " +
                      Percent(kMaxRegistrationError) + " is let through: expected marks on all sides of it");
  }
  return Ok();
}

// The sphere must be in the picture.
Status CheckSphereIsWhole(const TemplateMap& map, const Picture& scan, const std::string& name) {
  constexpr double kSpare = 0.01;  // of a diameter may be cut off
  const double spare = kSpare * map.SpherePixels();
  double outside = 0;
  std::string side;
  for (int k = 0; k < 64; ++k) {
    const double angle = k * std::acos(-1.0) / 32;
    const glm::dvec2 p = map.ToPicture(glm::dvec2(0.5) + 0.5 * glm::dvec2(std::cos(angle), std::sin(angle)));
    const std::array<std::pair<double, const char*>, 4> beyond{
        {{-p.x, "left"}, {p.x - scan.width, "right"}, {-p.y, "top"}, {p.y - scan.height, "bottom"}}};
    for (const auto& [pixels, which] : beyond) {
      if (pixels > outside) outside = pixels, side = which;
    }
  }
  if (outside <= spare) return Ok();
  return InputError(name + " shows a part of the sphere only: " + Percent(outside / map.SpherePixels()) +
                    " of it lies beyond the " + side + " border: take the whole sheet into the picture");
}

}  // namespace

Status CheckScanSize(int width, int height, double dpi, const std::string& name) {
  const double pixels = double(width) * height;
  if (pixels <= kMaxScanPixels) return Ok();
  std::string remedy = "scale it down, or scan it at 300 to 600 dpi";
  if (dpi > 0) {
    const double most = std::floor(dpi * std::sqrt(kMaxScanPixels / pixels) / 50) * 50;
    remedy = "the file says " + Number("%.0f", dpi) + " dpi: scan it at " +
             Number("%.0f", std::max(50.0, std::min(most, 600.0))) + " dpi, or cut it to the sheet";
  }
  return InputError(name + " is " + Pixels(width, height) + ", more than the " + Number("%.0f", kMaxScanPixels / 1e6) +
                    " million that are read at most: " + remedy);
}

std::optional<TemplateFit> FindTemplate(Picture picture) {
  // Smaller templates have no marks, and the search is not made for a few pixels.
  if (!FiducialsFit(std::min(picture.width, picture.height))) return std::nullopt;
  LayOnWhite(picture);
  return FitTemplate(FindMarks(picture, kCoarsestSearch), picture.width, picture.height);
}

Expected<Rectified> RectifyScan(Picture scan, const std::string& name, const RectifyOptions& options) {
  SCUMBLE_CHECK(options.size >= 16 && options.size <= 8192);
  SCUMBLE_RETURN_IF_ERROR(CheckScanSize(scan.width, scan.height, options.dpi, name));
  LayOnWhite(scan);
  const std::vector<FoundMark> marks = FindMarks(scan);
  if (marks.size() > kMostMarks) return SeveralTemplates(name, marks.size());
  const auto fit = FitTemplate(marks, scan.width, scan.height);
  if (!fit) return NoTemplate(scan, name, marks, options);
  const std::vector<FoundMark> rest = MarksOfAnotherFit(marks, *fit, scan.width, scan.height);
  if (HaveACommonId(rest, fit->marks)) {
    return InputError(name + " shows two templates: cut the picture to one of them");
  }
  SCUMBLE_RETURN_IF_ERROR(CheckSphereIsWhole(fit->map, scan, name));
  SCUMBLE_RETURN_IF_ERROR(CheckFit(*fit, name, options));
  if (!rest.empty()) {
    return InputError("the marks in " + name + " do not lie as on a flat sheet: " + std::to_string(fit->marks.size()) +
                      " of them lie on one plane and " + std::to_string(rest.size()) + " on another. Most likely " +
                      kCurled);
  }

  Rectified result;
  result.map = fit->map;
  RectifyReport& report = result.report;
  SplitIds(fit->marks, report.found, report.missing);
  report.error = std::max(fit->held_out, fit->on_sphere), report.error_at_marks = fit->at_marks;
  report.sphere_pixels = fit->map.SpherePixels();
  for (const FoundMark& mark : fit->marks) report.blur += mark.blur_pixels / double(fit->marks.size());
  MeasurePose(fit->map, report);
  const PaperLight light = MeasurePaperLight(scan, *fit);
  NoteLight(light, report);

  const int margin = options.with_margin ? TemplateMargin(options.size) : 0, side = options.size + 2 * margin;
  const auto on_template = [&](glm::dvec2 p) { return (p - double(margin)) / double(options.size); };
  const LinearPicture pixels = ResampleScan(scan, side, side, Shrink(fit->map, options.size),
                                            [&](glm::dvec2 p) { return fit->map.ToPicture(on_template(p)); });
  MeasurePaint(pixels, light, on_template, report);
  Warn(options, *fit, report);
  result.picture = Finish(pixels, light, on_template, options.white_balance);
  return result;
}

}  // namespace scumble
