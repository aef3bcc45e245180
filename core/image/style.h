// Style: the content of an exemplar and its style.toml, as plain data. style/ reads it from files and transfer/ applies
// it. The two never include each other and meet here, as guidegen/ and transfer/ meet in GuideSet.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/guides.h"
#include "core/image/layers.h"
#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

enum class Method {
  kLitSphere,   // every pixel takes its own nearest neighbour (Sloan et al. 2001): the fast floor
  kStyleBlit,   // chunks from a hierarchy of seeds (Sýkora et al. 2019, parallel form)
  kBruteForce,  // chunks grown from one anchor after the other (Sýkora et al. 2019, algorithm 1): the oracle, slow
};

// How the nearest neighbour of a normal is found in an exemplar.
enum class NearestSearch {
  kAuto,      // the formula for a sphere, a table for an exemplar with guides of its own
  kAnalytic,  // the sphere's formula
  kTable,     // a look-up table over all directions that face the viewer
  kTree,      // a tree of boxes: exact, and slower, for more than seeds ask it
};

enum class ThresholdMetric {
  kL2,  // Euclidean distance of unit normals
  kL1,  // sum of absolute differences, the authors' own
};

// The cost of a lighting condition that is not the best one for a pixel. L are luminances of the pixel, of the exemplar
// that the seed chose, and of exemplar k.
enum class LuminanceError {
  kExcess,     // |L_p - L_e| - min_k |L_p - L_k|: nothing where e is the best there is
  kPublished,  // |L_p - L_e|
};

enum class EdgeMode {
  kExact,     // the silhouette is the guides' coverage
  kExemplar,  // the exemplar's own painted edge continues along it
};

enum class ShadowMode {
  kNone,   // shadow catchers stay transparent
  kPaint,  // the style's darkest paint, as strong as the shadow layer
};

enum class ColorizeMode {
  kMultiply,  // paint times the scene's base colour
  kOklab,     // lightness varies as the paint's does, hue and chroma are the scene's
};

// The weight of each guide layer in the distance by which paint is found and chunks end. Values are multiplied by the
// weight (0 or more, finite; not all 0) before distances are taken. transfer/exemplar/guide_space.h defines the values.
class GuideWeights {
 public:
  // Normals alone, with weight 1: the plain engine.
  GuideWeights() { (*this)[Layer::kNormal] = 1.0f; }
  float& operator[](Layer layer) { return of_[static_cast<std::size_t>(layer)]; }
  float operator[](Layer layer) const { return of_[static_cast<std::size_t>(layer)]; }
  bool operator==(const GuideWeights&) const = default;

  bool ArePlain() const { return *this == GuideWeights(); }
  LayerSet Layers() const;  // those above 0

  // Whether a layer can have a weight: normals, colours, radiance and shares can. Ids have no distance. A position in
  // the exemplar's scene means nothing in another scene.
  static bool CanWeigh(Layer layer);
  // Whether its values are light, which exposure scales first.
  static bool IsRadiance(Layer layer);

 private:
  std::array<float, kLayerCount> of_{};
};

// Lengths are pixels at `reference_height` and follow the output's height.
struct TransferSettings {
  Method method = Method::kStyleBlit;
  NearestSearch nearest = NearestSearch::kAuto;
  double nearest_error =
      0.0;  // 0 … 10: a source that a tree finds may be farther than the nearest by this share of its distance
  GuideWeights guide_weights;
  float threshold = 0.125f;  // largest guide distance inside a chunk, at least 0, infinity allowed; the test is strict
  ThresholdMetric threshold_metric = ThresholdMetric::kL2;
  int levels = 7;           // seed grids of 2^(levels-1) … 1 pixels, 1 … 16
  float jitter = 1.0f;      // 0 … 1, how far seeds leave their grid
  double jitter_fps = 0.0;  // renewals a second; 0 frozen, -1 every frame
  bool coherent = false;    // seeds live on the surface instead of the screen; for kStyleBlit
  int blend_radius = 1;     // voting window of (2r + 1)² pixels, 0 … 64
  bool edge_aware = true;   // votes do not cross object borders, depth steps and creases
  double crease = 60.0;     // 0 … 180 degrees between normals, from which on an edge is a crease; 180: none is
  // 0 … 1: how far depth may leave the surface's slope, as a share of the distance, or of an orthographic view's height
  double depth_tolerance = 0.002;
  float luminance_weight =
      0.3f;  // 0 or more: how much a pixel's own light counts inside a chunk; several exemplars only
  LuminanceError luminance_error = LuminanceError::kExcess;
  double colorize = 0.0;  // 0 … 1: how much of the scene's base colour the paint takes on
  ColorizeMode colorize_mode = ColorizeMode::kMultiply;
  double variety = 0.0;  // 0 … 90 degrees: how far from its own normal a seed on a flat surface may take its paint
  double hybrid = 0.0;   // 0 or more, infinity allowed: sigma, in pixels of the first exemplar's file, of the Gaussian
                         // that splits the base layer, laid as by the Lit Sphere, from the detail layer, copied in
                         // chunks; 0: no split
  int match_step = 1;    // 1 … kMaxMatchStep: one pixel of so many, by column and by row, is matched; the others take
                         // on the matches of the pixels around them
  double scale = 1.0;    // exemplar size, above 0
  double rim = 2.0;      // exemplar pixels at the painted edge that are never used
  EdgeMode edge = EdgeMode::kExact;
  ShadowMode shadow = ShadowMode::kNone;  // on the pixels that a style map marks as catchers
  int reference_height = 1080;            // 0: lengths are plain pixels
};

// Where an exemplar's picture was cut out of its file, because the sphere does not fill that. Pixels of the file.
struct SphereCut {
  int left = 0, top = 0;  // of the cut; below 0 where it reaches beyond the file
  int file_width = 0, file_height = 0;
  double x = 0, y = 0, radius = 0;  // of the sphere
};

// Why the paint of a picture shows no clear sphere, as far as it can be told.
enum class SphereDoubt {
  kNone,          // there is no doubt
  kNoCircle,      // its outline is no circle
  kShadow,        // it would be one but for darker ground below it
  kUnevenGround,  // the ground has no one colour
  kSmall,         // the paint is less than 30 pixels across
};

// A painted sphere, which fills a square picture exactly; or any painted scene with its guides.
struct Exemplar {
  std::string name;  // for messages
  Picture picture;
  std::optional<double> luminance;      // of the light it is painted for, 0 or more; none: the mean of the guides'
                                        // luminance layer, without one that of the paint
  std::optional<GuideSet> guides = {};  // of what is painted, the picture's size; A and normal at least
  bool is_sphere = true;                // the geometry is the sphere that fills the picture, whatever the guides say;
                                        // if false, guides are required
  std::filesystem::path guides_file = {};  // the file that guides are or would be read from; empty: none
  int margin = 0;                          // pixels of the template that were cut off the file on every side
  std::optional<SphereCut> cut = {};       // of a sphere that does not fill its file
  bool fills = false;                      // the style says that the sphere fills the picture: none is looked for

  // The place of the picture's corner in the file.
  glm::ivec2 Origin() const { return cut ? glm::ivec2(cut->left, cut->top) : glm::ivec2(margin); }
};

inline constexpr int kMaxExemplars = 4;
inline constexpr int kMaxMatchStep = 8;

// The background of the stylised objects.
struct Paper {
  std::optional<std::array<std::uint16_t, 3>> color;  // 16-bit sRGB
  std::optional<Picture> picture;                     // tiled
  std::filesystem::path file = {};                    // of the picture
};

// A key of style.toml that changes over time, as core/style/style_keyframes.h defines it. Without tracks a style is the
// same in every frame.
struct StyleTrack {
  // A plain value as TOML has it, a colour, or a list of names.
  using Value = std::variant<bool, std::int64_t, double, std::string, Rgb16, std::vector<std::string>>;
  struct Key {
    std::int64_t frame = 0;
    Value value;
    bool operator==(const Key&) const = default;
  };
  std::string name;              // "transfer.threshold"
  std::vector<Key> keys;         // by rising frame, never empty
  bool straight = false;         // on a straight line between keys; otherwise each holds until the next
  std::filesystem::path folder;  // the folder of files that values name
  Value current;                 // the value in the style now
};

// Reads the picture of a file.
using PictureReader = std::function<Expected<Picture>(const std::filesystem::path& file)>;

struct Style {
  std::string name;
  std::string licence;
  TransferSettings transfer;
  std::vector<Exemplar> exemplars;  // one, or up to kMaxExemplars lighting conditions of the same style
  Paper paper;                      // neither set: transparent
  std::vector<FinishPass> finish;   // in order
  // Of the methods "toon" and "render": the finishing effect that makes the picture. It is one of `finish`, and
  // the exemplar is a plain grey sphere. Empty: paint makes it.
  std::string unpainted;
  std::vector<StyleTrack> tracks;
  PictureReader read_picture;  // of files that keys name; null: ReadPicture
};

// The layers that a transfer with this style reads, without its finish.
LayerSet TransferLayers(const Style& style);

// TransferLayers, and what the style's finish reads: `guidegen` makes these and no more.
LayerSet RequiredLayers(const Style& style);

// Whether the exposure of the scene's light matters: in styles of several exemplars, and in those that weigh radiance.
bool LooksAtLight(const Style& style);

// Whether the style needs a guide of light or shadow, which may take samples.
bool AsksForLight(const Style& style);

}  // namespace scumble
