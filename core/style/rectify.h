// Turns a scan or photograph of the painted template back into the template's own pixels: the exemplar.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/style/fiducials.h"
#include "core/style/scan/template_fit.h"
#include "scumble/picture.h"

namespace scumble {

struct RectifyOptions {
  int size = 1024;            // pixels across the sphere's square, 16 … 8192
  bool with_margin = true;    // with the template's margin around it, as the style of a kit takes it
  bool white_balance = true;  // paper becomes white, printed black becomes black, light becomes even
  double dpi = 0;             // the file's resolution, for messages; 0: unknown
};

struct RectifyReport {
  std::vector<int> found;  // ids of the marks that the map rests on, and of the missing ones
  std::vector<int> missing;
  // Registration error as shares of the sphere's diameter. `error` is the larger of two numbers: the distance of marks
  // from where the others expect them, and the uncertainty that this leaves on the sphere. The second field is the
  // fit's residual at the marks.
  double error = 0;
  double error_at_marks = 0;
  double sphere_pixels = 0;  // the sphere's diameter in the scan
  double rotation = 0;       // degrees clockwise that the template is turned in the picture, -180 … 180
  double tilt = 0;           // degrees between the paper and the picture plane, for a lens of the usual angle
  double lens = 0;           // radial distortion at the picture's corner, a share; 0 where none was fitted
  double blur = 0;           // standard deviation, pixels of the scan
  // The light that was found, also where it was not removed.
  double paper[3] = {1, 1, 1};  // colour of the paper amid the template: linear, the largest 1
  double paper_light = 1;       // its brightest channel, linear, 1 the brightest that the file can hold
  double unevenness = 0;        // share of the light that its darkest place lacks
  double black = 0;             // what the printed black reflects, a share of the paper
  double bare_margin = 1;       // share of the margin that was taken for bare paper
  double clipped = 0;           // share of the bare paper at the file's limit
  // Of the disc: what is not as light as paper, and the same of its outermost fiftieth.
  double painted = 0;
  double painted_rim = 0;
  std::vector<std::string> warnings;  // sentences: defects that the exemplar may have, and their remedies
};

struct Rectified {
  Picture picture;  // opaque; size² or (size + 2 · TemplateMargin(size))²
  TemplateMap map;  // where the template lies in the scan
  RectifyReport report;
};

// The largest accepted registration error, a share of the sphere's diameter: at 1024 pixels 10 pixels.
inline constexpr double kMaxRegistrationError = 0.01;
// A larger error gives a warning.
inline constexpr double kGoodRegistrationError = 0.003;
// The most pixels of a scan: an A4 page at 1200 dpi. While it is read, a pixel takes 8 bytes, up to 8 more, and the
// share of the file's own reader: some gigabytes in all.
inline constexpr double kMaxScanPixels = 150e6;
// White paper becomes this value, in linear light. Room is left above for white paint, which is often lighter than
// paper.
inline constexpr double kPaperWhite = 0.96;

// Whether a scan of that size is worth reading; `name` and `dpi` (0: unknown) are for the message.
Status CheckScanSize(int width, int height, double dpi, const std::string& name);

// Alpha is laid on white first. `name` stands for the scan in messages. Errors (kInput) give the defect and the remedy:
// no marks, marks of other programs, fewer than four, a mirrored picture, two templates, marks that no plane holds, too
// few pixels. Deterministic and single-threaded. Memory: the scan, its grey and smaller copies for the marks, and three
// floats for each pixel of the output.
Expected<Rectified> RectifyScan(Picture scan, const std::string& name, const RectifyOptions& options = {});

// Where the template lies in a picture: in any place, size and turn, if a coarse search finds four of its marks there.
// Nothing for a mirrored one. Alpha is laid on white.
std::optional<TemplateFit> FindTemplate(Picture picture);

}  // namespace scumble
