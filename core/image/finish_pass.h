// The finishing effects of a picture, as plain data: the tables [[finish]] of style.toml and of presets. finish/
// applies them; core/style/finish_keys.h names their keys.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/image/layers.h"
#include "scumble/picture.h"

namespace scumble {

using Rgb16 = std::array<std::uint16_t, 3>;  // 16-bit sRGB

// The classes of line. A border between two pixels has the first that fits.
enum class LineClass {
  kSilhouette,  // against nothing
  kObject,      // between two objects
  kOcclusion,   // a step in depth within one object
  kCrease,      // an angle between surfaces
  kMaterial,    // between two materials
  kShadow,      // the contour of half shadow
  kTexture,     // a step in the base colour
  kSuggestive,  // a valley of the surface that would be a silhouette from a little aside
};
inline constexpr int kLineClasses = 8;

// Lines along borders of the guides. Lengths are pixels at the style's reference height.
struct OutlinePass {
  enum class Color { kInk, kPaint, kComplement };  // a fixed ink; the paint beside the line, darker; its opposite hue
  enum class Side { kCentre, kInside, kOutside };  // of the nearer surface
  enum class Form { kStrokes, kField };            // traced and stroked; or inked by the distance to the border alone
  double width = 2.5;                              // 0 … 64
  double min_width = 0.7;                          // 0 … 64: no line gets thinner by depth or light
  std::array<double, kLineClasses> of_class = {1.0, 1.0, 1.0, 0.6,
                                               0.0, 0.0, 0.0, 0.0};  // factors of the width, 0 … 4; 0: none
  double crease_angle = 40.0;                                        // degrees between normals, 0 … 180
  double texture_step = 0.1;                                         // Oklab distance between base colours, 0 … 2
  double suggestive_reach = 8.0;                                     // 1 … 64: across a valley, to either side
  double suggestive_depth = 0.03;  // 0 … 1: what the cosine to the viewer must rise by over that reach
  double thin = 0.0;               // 0 … 2: the width is multiplied by (thin_at / depth)^thin
  bool thin_is_given = false;      // by --set: then a view without perspective is an error, else `thin` is left out
  double thin_at = 0.0;            // metres; 0: the middle depth of the first picture
  double light = 0.0;              // -2 … 2: the width is multiplied by 1 + light · (1/2 - luminance)
  double taper = 0.0;              // 0 … 512: ends grow thin over this length
  double wobble = 0.0;             // 0 … 16: how far lines stray
  double wobble_length = 24.0;     // 1 … 512: of the waves of that
  double jitter_fps = 0.0;         // new waves and gaps a second, up to 1000; 0: none; -1: in each frame
  double gaps = 0.0;               // 0 … 1: share of the line that is left out, here and there
  double gap_length = 16.0;        // 1 … 512: of the largest of them, about
  bool stick = false;              // waves and gaps stick to surfaces; false: to the picture
  Form form = Form::kStrokes;
  Color color = Color::kInk;
  Rgb16 ink = {0x1c1c, 0x1a1a, 0x1919};
  Side side = Side::kCentre;
};

// Colours by tone and detail, for shading = ramp of ToonPass.
struct ColorRamp {
  int columns = 0, rows = 0;  // columns from dark to light, rows from near or facing to far or turned away
  std::vector<Rgb16> colors;  // row by row
};

// Flat bands of light instead of the paint.
struct ToonPass {
  enum class Color { kAlbedo, kPaint };       // of the brightest band: the scene's base colour, or the paint's own
  enum class Light { kLuminance, kWrapped };  // direct light; or the cosine to the key light, wrapped around the form
  enum class Shading { kPlain, kGooch, kRamp };  // one darker tone; from cool to warm; colours of `ramp`
  // Of a ramp: by depth, by how far surfaces turn from the viewer, or by highlights (layer lpe.LSE).
  enum class Rows { kDepth, kFacing, kHighlight };
  int bands = 3;                   // 1 … 64; 1: flat
  std::vector<double> thresholds;  // bands - 1 growing tones between 0 and 1; empty: evenly apart
  double softness = 0.75;          // 0 … 16 pixels at the reference height: half the width of a band's border
  double shade = 0.45;             // 0 … 1: the darkest band's lightness, as a share of the brightest's
  double tint = 0.3;               // 0 … 1: how much of the hue of `color` the darkest band takes on
  Rgb16 color = {0x3838, 0x4444, 0x8080};
  Color base = Color::kAlbedo;
  Light light = Light::kLuminance;
  int wrap_power = 1;  // 1 … 2: wrapped light is ((1 + cosine) / 2)^wrap_power
  double cast = 1.0;   // 0 … 1: how much cast shadow takes of wrapped light
  Shading shading = Shading::kPlain;
  Rgb16 warm = {0x4d4d, 0x4d4d, 0x0000}, cool = {0x0000, 0x0000, 0x8c8c};
  double warm_base = 0.5, cool_base = 0.25;  // 0 … 1: how much of the base colour is added to them
  std::string ramp;                          // colours, "#202040 #fff4d0 / #405060 #c0d0e0"; or a picture's file
  Rows ramp_rows = Rows::kDepth;
  std::shared_ptr<const ColorRamp> ramp_colors;  // of `ramp`, once it is read
};

// The light of the scene itself (layer lpe.full) instead of the paint, by an extended Reinhard curve.
struct RenderPass {
  double exposure = 0.0;  // -16 … 16 stops; at 0 the brightest tenth of the first picture is at 0.8
  double white = 4.0;     // 1 … 100: the linear value that becomes white
};

// Lightness in steps (Winnemöller, Olsen, Gooch 2006, made to keep black, white and the middle of every step).
struct TonesPass {
  enum class Tone { kPaint, kLight };  // whose lightness is cut; of the light, the paint keeps its detail
  Tone tone = Tone::kPaint;
  int bins = 8;            // 2 … 64
  double sharpness = 4.0;  // 0 … 64: 0 changes nothing, 4 rounds the steps, 64 is hard
};

// What is in shade is painted otherwise.
struct ShadowsPass {
  enum class Mode { kBlack, kDarker, kColor, kComplement, kChiaroscuro, kImpression, kNegative };
  enum class Source { kCast, kForm, kBoth };  // the layer `shadow`; faces turned from the light; the larger of them
  Mode mode = Mode::kDarker;
  Source source = Source::kBoth;
  double soften = 0.0;  // 0 … 64 pixels at the reference height: sigma by which the shade's contour is evened out
  // Luminances, as shares of the picture's brightest tenth: form shade is full up to `full`, none from `none` on.
  double full = 0.1, none = 0.4;  // 0 … 4
  Rgb16 color = {0x2a2a, 0x3434, 0x6262};
  double tint = 0.0;  // 0 … 1: kComplement turns grey paint to the hue of `color` so far
};

// What distance does to colours. u = clamp(|depth - focus| / (far - near), 0, 1)^gamma.
struct DepthPass {
  enum class Metric { kLinear, kInverse };  // depths, or their reciprocals
  double near = 0.0, far = 0.0;             // metres; 0: the 2nd and 98th percentile of the first picture's depth
  double focus = 0.0;                       // metres; 0: near
  double gamma = 1.0;                       // 0.1 … 10
  int layers = 0;                           // 0 smooth, 2 … 64: u and the air take so many values
  Metric metric = Metric::kLinear;
  double desaturate = 0.6;  // 0 … 1: chroma is multiplied by 1 - desaturate · u
  double tint = 0.0;        // 0 … 1: hue and chroma go towards `color` by tint · u
  double air = 0.0;         // 0 … 1: share of `color` at `far`, by Beer and Lambert's law
  Rgb16 color = {0xb4b4, 0xc6c6, 0xdcdc};
  double blur = 0.0;     // 0 … 64 pixels at the reference height: sigma of a Gaussian where u is 1
  std::string focus_on;  // a pattern of object names: the focus is their middle depth; empty: `focus` is
};

// Detail below a contrast is evened out; edges stay. finish/smooth/smooth_filters.h has the filters' papers.
struct SmoothPass {
  // By rows, then by columns; patches along the edges, as brushes leave them; box means, whatever the radius; wavelets
  // that stop at normals and depths, too.
  enum class Filter { kBilateral, kKuwahara, kGuided, kWavelets };
  double radius = 4.0;  // 0.5 … 32 pixels at the reference height: sigma in space; of kKuwahara and kGuided the reach
  double range = 0.08;  // 0.001 … 1: the Oklab distance whose share is halved; kKuwahara has none
  int passes = 2;       // 1 … 8
  bool borders = true;  // each object by itself; a pixel at a border keeps its neighbour's share, half at most
  Filter filter = Filter::kBilateral;
};

// Lines where the tone changes: the extended difference of Gaussians (Winnemöller, Kyprianidis, Olsen 2012).
struct EdgesPass {
  enum class Tone { kPaint, kLight, kAlbedo };  // lightness of the paint, of the light, of base colours
  enum class Draw { kInk, kPaint };             // ink on the paint, or the paint on `paper`
  double width = 2.0;                           // 0.5 … 32 pixels at the reference height, of a line along a step
  double sharpness = 20.0;                      // 0 … 200: how faint a step still makes a line
  double threshold = 0.7;                       // 0 … 1: the tone below which ink begins
  double slope = 10.0;                          // 0.1 … 100: how fast ink gets dense below it
  double fill = 0.0;                            // 0 … 1: 1 fills what is dark, 0 draws lines alone
  bool borders = false;                         // no tone is mixed between objects: their border makes no line
  double flow = 0.0;  // 0 … 16 pixels: sigma along the edge, over which lines are evened out
  Tone tone = Tone::kLight;
  Draw draw = Draw::kInk;
  OutlinePass::Color color = OutlinePass::Color::kInk;  // of draw = kInk
  Rgb16 ink = {0x1c1c, 0x1a1a, 0x1919};
  Rgb16 paper = {0xf4f4, 0xefef, 0xe6e6};
};

// A threshold texture at several sizes: a pixel is ink where its number, 0 … 1, lies below the share of ink wanted. Of
// each size all numbers are equally frequent, so that the share of ink is the one wanted.
struct HatchTexture {
  struct Level {
    int size = 0;                   // of a square that repeats
    std::vector<float> thresholds;  // size × size, row by row
  };
  std::vector<Level> levels;  // each half as large as the one before
};

// The word for even lines.
inline constexpr const char* kPlainStrokes = "lines";

// Strokes of ink, denser where it is darker, in patches that follow the surfaces.
struct HatchPass {
  enum class Tone { kLight, kPaint };  // what is looked at
  // In the direction in which the surface bends most; across that; `angle`; from light to shade; away from the viewer.
  enum class Along { kAround, kAlong, kFixed, kLight, kDepth };
  double spacing = 7.0;     // 2 … 128 pixels at the reference height, from stroke to stroke
  double patch = 64.0;      // 8 … 1024 pixels: size of a patch of one direction
  double angle = 45.0;      // -180 … 180 degrees, 0 along a row: where the surface has no direction, and of kFixed
  double cross = 60.0;      // 0 … 90 degrees from one layer of strokes to the next
  int layers = 2;           // 1 … 4
  double fullest = 0.6;     // 0.05 … 1: share of ink at which a layer is full, and the next begins
  double bare = 1.0;        // 0 … 1: tone from which on nothing is hatched
  double shade = 1.0;       // 0 … 4: up to 1 the share of missing light that is hatched, above 1 a power of the tone
  double wobble = 0.6;      // 0 … 16 pixels: how far strokes stray
  double jitter_fps = 0.0;  // new strokes a second, up to 1000; 0: none; -1: in each frame
  bool stick = false;       // strokes stick to surfaces; false: to the picture
  Tone tone = Tone::kLight;
  Along along = Along::kAround;
  Rgb16 ink = {0x1c1c, 0x1a1a, 0x1919};
  std::string strokes = kPlainStrokes;          // or a tool, "pencil"; or the file of a threshold texture
  std::shared_ptr<const HatchTexture> texture;  // of `strokes`, once it is read; null: even lines
};

struct GradePass {
  double saturation = 1.0;  // 0 … 4, of chroma
  double contrast = 1.0;    // 0 … 4, around the middle of lightness
  double lift = 0.0;        // -1 … 1, added to lightness
};

// Where colours lie in Oklab: their mean (L, a, b), and their covariance as LL, La, Lb, aa, ab, bb.
struct ColorSpread {
  std::array<double, 3> mean{};
  std::array<double, 6> covariance{};
};

// The word for a style's own painting.
inline constexpr const char* kPaintingPalette = "painting";

// Begins a `from` that has the nine numbers of a ColorSpread after it, as a run prints what it has measured.
inline constexpr std::string_view kMeasuredPalette = "measured ";

// Whether `like` or `from` names a picture's file.
inline bool IsPaletteFile(const std::string& source) {
  return !source.empty() && source != kPaintingPalette && source[0] != '#' && source.rfind(kMeasuredPalette, 0) != 0;
}

// The palette of an example: colours are moved so that their mean and covariance become those of other colours.
struct PalettePass {
  std::string like = kPaintingPalette;  // the style's painting; or a picture's file; or colours, "#203050 #f0e0c0"
  // Whose colours become those of `like`: a picture's file; or what was measured; empty: the first picture's own.
  std::string from;
  double gain = 3.0;  // 1 … 16: how much the spread of colours may grow in any direction
  bool keep_lightness = false;
  std::optional<ColorSpread> target, source;  // of `like` and of `from`, once they are read
};

// Watercolour: how much pigment lies where.
struct PigmentPass {
  double edge = 0.7;              // 0 … 4: more of it inside the border of an object
  double edge_width = 8.0;        // 0.5 … 128 pixels at the reference height: it is darkest at half that distance
  double turbulence = 0.5;        // 0 … 2: more and less of it in clouds
  double turbulence_size = 90.0;  // 2 … 2048 pixels: of the largest clouds
  double granulation = 0.3;       // 0 … 2: grains of it in the paper's hollows
  double grain_size = 2.5;        // 0.5 … 64 pixels
  double thin = 0.25;             // 0 … 1: less of it where the picture is light
  double tremor = 1.5;            // 0 … 32 pixels: how far shapes stray
  double tremor_size = 24.0;      // 2 … 512 pixels: of the waves of that
  double jitter_fps = 0.0;        // new clouds, grains and waves a second, up to 1000; 0: none; -1: in each frame
  bool stick = false;             // clouds stick to surfaces; false: to the picture
};

// One colour in place of the paint.
struct FillPass {
  Rgb16 color = {0xf4f4, 0xefef, 0xe6e6};
};

// Instead of a picture's name: 0 in the middle, 1 from the ellipse on that touches the picture's edges.
inline constexpr const char* kRadialMask = "radial";

// The share of an effect at each pixel is the product of these, or with `invert` what that leaves of 1.
struct FinishMask {
  double near = 0.0, far = 0.0;  // metres: depths between these; 0: that end is open
  double soft = 0.0;             // metres that both ends take to go from 0 to 1, half of them outside
  std::string shape;             // "", kRadialMask, or the name of a picture as it was given
  bool invert = false;

  std::filesystem::path file;              // of the picture
  std::shared_ptr<const Picture> picture;  // its share in the red channel

  bool HasDepth() const { return near > 0.0 || far > 0.0; }
  // Whether it leaves the effect as it is everywhere.
  bool empty() const { return !HasDepth() && shape.empty() && !invert; }
};

struct FinishPass {
  // Before the paint is matched, on a guide; before the paper is put behind; after.
  enum class Stage { kGuides, kPaint, kSheet };
  enum class Guide { kAlbedo, kLuminance };  // that a pass of kGuides changes
  using Effect = std::variant<OutlinePass, SmoothPass, EdgesPass, HatchPass, ToonPass, RenderPass, TonesPass,
                              ShadowsPass, DepthPass, PalettePass, GradePass, PigmentPass, FillPass>;
  std::string name;  // for --set finish.NAME.KEY; the effect's if the user gives none
  Effect effect;
  Stage at = Stage::kPaint;
  double strength = 1.0;                        // 0 … 1; 0 changes no byte
  std::vector<std::string> objects, materials;  // patterns of names; both empty: the whole picture
  FinishMask mask = {};                         // besides these
  Guide guide = Guide::kAlbedo;                 // of kGuides
};

// The layer that a pass of the stage kGuides changes.
Layer ChangedLayer(FinishPass::Guide guide);

// The layers that the pass reads.
LayerSet RequiredLayers(const FinishPass& pass);

}  // namespace scumble
