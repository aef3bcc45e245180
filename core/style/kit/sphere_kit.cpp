#include "core/style/sphere_kit.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/image/check.h"
#include "core/image/style.h"
#include "core/io/atomic_file.h"
#include "core/io/guide_file.h"
#include "core/io/open_raster.h"
#include "core/io/picture_file.h"
#include "core/io/readable_file.h"
#include "core/style/fiducials.h"
#include "core/style/kit/kit_layers.h"
#include "core/style/kit/template_pdf.h"
#include "core/style/style_file.h"
#include "core/style/style_keys.h"
#include "core/style/toml_values.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

using internal::Exists;

std::string Numbered(const std::string& stem, const std::string& ending, std::size_t index) {
  return index == 0 ? stem + ending : stem + "-" + std::to_string(index + 1) + ending;
}

std::string PaintingName(const KitLight& light, std::size_t index, const std::string& ending = ".png") {
  return light.name.empty() ? Numbered("lit", ending, index) : light.name + ending;
}
std::string TemplateName(const KitLight& light, std::size_t index, const std::string& ending = ".png") {
  return light.name.empty() ? Numbered("template", ending, index) : light.name + "-template" + ending;
}
std::string GuidesName(const KitLight& light, std::size_t index) {
  return light.name.empty() ? Numbered("guides", ".exr", index) : light.name + "-guides.exr";
}

// The suffix that Numbered has added to `stem`: "" or "-2" and so on. Empty optional if `text` was not made by it.
std::optional<std::string> NumberBehind(const std::string& stem, const std::string& text) {
  if (text.rfind(stem, 0) != 0) return std::nullopt;
  const std::string rest = text.substr(stem.size());
  const bool number = rest.size() > 1 && rest[0] == '-' &&
                      std::all_of(rest.begin() + 1, rest.end(), [](unsigned char c) { return std::isdigit(c); });
  return rest.empty() || number ? std::optional(rest) : std::nullopt;
}

// The file names of a painting that style.toml may contain.
std::vector<std::string> PaintingNames(const KitLight& light, std::size_t index) {
  return {PaintingName(light, index), PaintingName(light, index, ".ora"), TemplateName(light, index, ".ora"),
          TemplateName(light, index)};
}

// For a command line. Names of paintings hold no quotes.
std::string Quoted(const std::string& name) { return name.find(' ') == std::string::npos ? name : "'" + name + "'"; }

// `mark` begins each line: empty, or the comment sign.
std::string ExemplarEntry(const KitLight& light, std::size_t index, const std::string& mark) {
  return "\n" + mark + "[[exemplar]]          # light from " + AnglesInWords(light) + "\n" + mark + "image = \"" +
         PaintingName(light, index) + "\"\n" + mark + "guides = \"" + GuidesName(light, index) +
         "\"  # knows the template's margin, and how bright this light is\n";
}

std::string StarterStyle(const std::vector<KitLight>& lights) {
  std::string text = "# A style: paint over " + TemplateName(lights[0], 0) + ", save as " + PaintingName(lights[0], 0) +
                     " beside this file.\n"
                     "# All keys and their defaults: scumble styles --keys\n"
                     "name = \"my style\"\n"
                     "licence = \"\"\n\n"
                     "[transfer]\n"
                     "threshold = 0.125     # smaller: shape is followed closer; larger: bigger chunks of your paint\n"
                     "blend_radius = 1      # how far neighbouring chunks blend, pixels\n"
                     "scale = 1.0           # smaller: finer strokes in the picture\n"
                     "paper = \"\"            # a colour like \"#f4efe6\" or a picture behind; empty: transparent\n";
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (i == std::size_t(kMaxExemplars)) text += "\n# A style takes up to four lights.";
    text += ExemplarEntry(lights[i], i, i < std::size_t(kMaxExemplars) ? "" : "# ");
  }
  return text;
}

// Replacements for "$PAINTING" and the like in a text; no name of a light holds a "$".
using Words = std::vector<std::pair<std::string_view, std::string>>;
std::string Filled(std::string text, const Words& words) {
  for (const auto& [word, meaning] : words) {
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += meaning.size()) {
      text.replace(at, word.size(), meaning);
    }
  }
  return text;
}

constexpr const char* kHowtoHead = R"(PAINT YOUR OWN STYLE

The sphere's light comes from $PLACE ($ANGLES:
azimuth to the right of the viewer, elevation above the horizon).
)";
constexpr const char* kHowtoPng = R"(
$TEMPLATE.png is for any painting program
  1. Paint over the sphere. Do not move, scale or crop the picture.
  2. Export it at the same size as $PAINTING into this folder.
)";
constexpr const char* kHowtoOra = R"(
$TEMPLATE.ora is for Krita, GIMP and MyPaint, in layers
  1. Paint on the layer "paint here", or on as many of your own as you like, under the marks. The layers called
     "guide" can be switched on: the sphere's edge; light, with the highlight red, equal light orange, and blue where
     light turns into shade; contours to lay strokes along; five tones; normals. Switch them off before you save.
  2. Export it as $PAINTING into this folder; or save it as it is, and write image = "$TEMPLATE.ora" into style.toml.
)";
constexpr const char* kHowtoPdf = R"(
$TEMPLATE.pdf is for paint on paper
  1. Print it at 100%, on paper that you like to paint on. Leave the black marks and the white around them free.
  2. Scan the whole page at $DPI dpi or more, all marks in sight, or photograph it in even light.
  3. In this folder:   scumble sphere --rectify scan.jpg -o $QUOTED
)";
constexpr const char* kHowtoSmallPdf = R"(
$TEMPLATE.pdf is for looking at: a sphere of fewer than 128 pixels has no room for the marks that --rectify reads. To
paint on paper make a kit of --size 512 or more.
)";
constexpr const char* kHowtoEnd = R"(
Then
  scumble styles check THIS_FOLDER
  scumble stylize scene.glb --style THIS_FOLDER -o picture.png
and tune style.toml: threshold, scale, blend_radius, paper.

Let strokes run over the sphere's edge; what lies outside it is never shown. What helps: the whole range from
highlight to reflected light; strokes with a direction; irregular, lively texture. What hurts: a regular pattern (it
tears where chunks meet), bare template showing through.
)";
constexpr const char* kHowtoOtherLight = R"(
$TEMPLATE is the same sphere in another light: $ANGLES, from $PLACE.
Paint it too, for $PAINTING, or take its [[exemplar]] out of style.toml.
)";
constexpr const char* kHowtoLater = R"(
Another light later:   scumble sphere --size $SIZE --light AZ,EL --name shade -o THIS_FOLDER
)";

std::string Howto(const std::vector<KitLight>& lights, const KitOptions& options) {
  const auto words = [&](std::size_t i) {
    return Words{{"$PLACE", PlaceInWords(lights[i])},
                 {"$ANGLES", AnglesInWords(lights[i])},
                 {"$DPI", std::to_string(ScanDpi(lights[i].guides.width(), options.dpi))},
                 {"$SIZE", std::to_string(lights[i].guides.width())},
                 {"$TEMPLATE", TemplateName(lights[i], i, "")},
                 {"$QUOTED", Quoted(PaintingName(lights[i], i))},
                 {"$PAINTING", PaintingName(lights[i], i)}};
  };
  std::string text = kHowtoHead;
  if (options.png) text += kHowtoPng;
  if (options.ora) text += kHowtoOra;
  if (options.pdf) text += FiducialsFit(lights[0].guides.width()) ? kHowtoPdf : kHowtoSmallPdf;
  text = Filled(text + kHowtoEnd, words(0));
  for (std::size_t i = 1; i < lights.size(); ++i) text += Filled(kHowtoOtherLight, words(i));
  return text + Filled(kHowtoLater, words(0));
}

bool SameIn8Bits(const Picture& file, const Picture& drawn) {
  return file.rgba.size() == drawn.rgba.size() &&
         std::equal(file.rgba.begin(), file.rgba.end(), drawn.rgba.begin(),
                    [](std::uint16_t a, std::uint16_t b) { return a / 257u == (b + 128u) / 257u; });
}

Error MayBePainting(const fs::path& path) {
  return OutputError(path.string() +
                     " is there already and differs from the template of this size and light: it may be "
                     "a painting. Move it away, give this light a --name of its own, or write to another folder");
}

// A template that somebody painted over must not be lost. One that equals our drawing, of this or an earlier version,
// may be replaced.
Status RefusePaintedTemplate(const fs::path& path, const KitLight& light, const Picture& drawn) {
  if (!Exists(path)) return Ok();
  const auto old = ReadPicture(path);
  if (old && (SameIn8Bits(*old, drawn) || SameIn8Bits(*old, DrawTemplateWithCrosses(light)))) return Ok();
  return MayBePainting(path);
}

// Whether the luminance differs by more than a thousandth of the brightest, as for lights a tenth of a degree apart.
// Other instruction sets round differently, by some millionths. Edge pixels depend on --aa, so they do not count.
bool HasOtherLight(const GuideSet& old, const GuideSet& now) {
  const auto was = old.Plane(Layer::kLuminance), is = now.Plane(Layer::kLuminance);
  const auto had = old.Plane(Layer::kCoverage), has = now.Plane(Layer::kCoverage);
  float brightest = 0.0f, difference = 0.0f;
  for (std::size_t i = 0; i < now.pixel_count(); ++i) {
    if (had[i] < 1.0f || has[i] < 1.0f) continue;
    brightest = std::max({brightest, was[i], is[i]});
    difference = std::max(difference, std::fabs(was[i] - is[i]));
  }
  return difference > 1e-3f * brightest;
}

// A painting fits the guides that it was painted with. Unreadable guides cannot fit it.
Status RefuseOtherGuides(const fs::path& folder, const KitLight& light, std::size_t index) {
  const int size = light.guides.width();
  const fs::path guides = folder / GuidesName(light, index);
  for (const std::string& name : PaintingNames(light, index)) {
    const fs::path painting = folder / name;
    if (!Exists(painting)) continue;
    const auto old = InspectGuides(guides);
    if (!old) continue;
    if (old->width != size || old->height != size) {
      return OutputError(guides.string() + " is of " + std::to_string(old->width) + "² pixels and belongs to " +
                         painting.string() + ": take --size " + std::to_string(old->width) +
                         ", or write to another folder");
    }
    GuideReadOptions lit;
    lit.required = {Layer::kCoverage, Layer::kNormal, Layer::kLuminance};  // guides are none without normals
    const auto read = ReadGuides(guides, lit);
    if (!read || !HasOtherLight(*read, light.guides)) continue;
    return OutputError(
        guides.string() + " has another light than " + AnglesInWords(light) + " and belongs to " + painting.string() +
        ": take the --light that it was made with, give this one a --name of its own, " + "or write to another folder");
  }
  return Ok();
}

// The layers from the top down: marks, paint, the lit sphere. Guides that are lines lie over the paint, so that they
// can be seen on it; those that cover the sphere lie under it. All but the layer to paint on are locked.
Expected<std::vector<RasterLayer>> TemplateLayers(const KitLight& light) {
  const int size = light.guides.width(), side = size + 2 * TemplateMargin(size);
  std::vector<RasterLayer> layers;
  // One after the other: of a large template a few pictures at once would fill the memory.
  const auto add = [&](const std::string& name, double opacity, bool visible, const Picture& picture) -> Status {
    SCUMBLE_ASSIGN(auto png, EncodePng(picture));
    layers.push_back({name, std::move(png), opacity, visible, true, false});
    return Ok();
  };
  constexpr bool kShown = true, kHidden = false;
  SCUMBLE_RETURN_IF_ERROR(add("marks", 1.0, kShown, DrawMarks(size)));
  SCUMBLE_RETURN_IF_ERROR(add("guide: edge", 0.8, kHidden, DrawEdgeLine(size)));
  SCUMBLE_RETURN_IF_ERROR(add("guide: light", 0.8, kHidden, DrawLightLines(size, light.azimuth, light.elevation)));
  SCUMBLE_RETURN_IF_ERROR(add("guide: contours", 0.6, kHidden, DrawContourLines(size)));
  SCUMBLE_RETURN_IF_ERROR(add("paint here", 1.0, kShown, Picture(side, side)));
  layers.back().locked = false, layers.back().selected = true;
  SCUMBLE_RETURN_IF_ERROR(add("guide: five tones", 1.0, kHidden, DrawFiveTones(light)));
  SCUMBLE_RETURN_IF_ERROR(add("guide: normals", 1.0, kHidden, DrawNormalColors(light)));
  SCUMBLE_RETURN_IF_ERROR(add("lit sphere", 1.0, kShown, DrawLitSphere(light)));
  Picture paper(side, side);
  std::fill(paper.rgba.begin(), paper.rgba.end(), std::uint16_t{65535});
  SCUMBLE_RETURN_IF_ERROR(add("paper", 1.0, kShown, paper));
  return layers;
}

// An [[exemplar]] of style.toml: plain file names, empty where there is none.
struct ListedExemplar {
  std::string image, guides;
};

std::vector<ListedExemplar> ExemplarsOf(const toml::table& style) {
  std::vector<ListedExemplar> listed;
  const auto* array = style["exemplar"].as_array();
  if (!array) return listed;
  const auto name = [](const toml::table& table, const char* key) {
    return fs::path(table[key].value_or(std::string())).lexically_normal().string();
  };
  for (const auto& item : *array) {
    if (const auto* table = item.as_table()) listed.push_back({name(*table, "image"), name(*table, "guides")});
  }
  return listed;
}

// A painting fits the guides that it was painted with: a light must not ask for a painting that has others.
Status RefuseOtherExemplar(const fs::path& style, const std::vector<ListedExemplar>& listed, const KitLight& light,
                           std::size_t index) {
  const std::string guides = GuidesName(light, index);
  const std::vector<std::string> names = PaintingNames(light, index);
  for (const ListedExemplar& exemplar : listed) {
    const bool is_it = std::find(names.begin(), names.end(), exemplar.image) != names.end();
    if (!is_it || exemplar.guides.empty() || exemplar.guides == guides) continue;
    return OutputError(style.string() + " lists " + exemplar.image + " with " + exemplar.guides +
                       ", and this light has the guides " + guides +
                       ": give it a --name of its own, or write to another folder");
  }
  return Ok();
}

// The new text of style.toml; empty optional where the file should stay. Lights without names are those of a new style:
// they are added where no exemplar is listed and the method needs one.
Expected<std::optional<std::string>> NewStyle(const fs::path& path, const std::vector<KitLight>& lights) {
  std::error_code failed;
  if (!fs::exists(path, failed)) return std::optional(StarterStyle(lights));
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path, kMaxStyleBytes));
  const std::string old(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  SCUMBLE_ASSIGN(const toml::table style, internal::ParseToml(old, path.string()));
  const std::vector<ListedExemplar> listed = ExemplarsOf(style);
  const bool add_all = listed.empty() && !IsUnpainted(style["transfer"]["method"].value_or(std::string()));
  std::string text = old;
  std::size_t count = listed.size();
  for (std::size_t i = 0; i < lights.size(); ++i) {
    SCUMBLE_RETURN_IF_ERROR(RefuseOtherExemplar(path, listed, lights[i], i));
    const std::vector<std::string> names = PaintingNames(lights[i], i);
    const bool is_listed = std::any_of(listed.begin(), listed.end(), [&](const ListedExemplar& exemplar) {
      return std::find(names.begin(), names.end(), exemplar.image) != names.end();
    });
    if ((lights[i].name.empty() && !add_all) || is_listed) continue;
    if (!text.empty() && text.back() != '\n') text += '\n';
    text += ExemplarEntry(lights[i], i, "");
    ++count;
  }
  if (text == old) return std::optional<std::string>();
  if (count > std::size_t(kMaxExemplars)) {
    return OutputError(path.string() + " would list " + std::to_string(count) + " lights: a style takes up to " +
                       std::to_string(kMaxExemplars) + "; take an [[exemplar]] out, or write to another folder");
  }
  return std::optional(std::move(text));
}

// Another run that writes to the folder waits until this one has ended, and then sees its files. File systems without
// locks have none.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder) : file_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    while (file_ >= 0 && ::flock(file_, LOCK_EX) != 0 && errno == EINTR) continue;
  }
  ~FolderLock() {
    if (file_ >= 0) ::close(file_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_;
};

struct KitFile {
  fs::path path;
  std::vector<std::byte> bytes;
};

// The files of one light's template, nothing written yet; an error where one of them would replace a painting.
Status MakeTemplate(const fs::path& folder, const KitLight& light, std::size_t index, const KitOptions& options,
                    std::vector<KitFile>& files) {
  const Picture drawn = DrawTemplate(light);
  if (options.png) {
    const fs::path path = folder / TemplateName(light, index);
    SCUMBLE_RETURN_IF_ERROR(RefusePaintedTemplate(path, light, drawn));
    SCUMBLE_ASSIGN(auto png, EncodePng(drawn, options.dpi));
    files.push_back({path, std::move(png)});
  }
  if (options.ora) {
    const fs::path path = folder / TemplateName(light, index, ".ora");
    SCUMBLE_ASSIGN(const auto layers, TemplateLayers(light));
    if (Exists(path) && !SameLayers(path, layers, drawn)) return MayBePainting(path);
    SCUMBLE_ASSIGN(auto ora, EncodeOpenRaster(layers, drawn, options.dpi, path.string()));
    files.push_back({path, std::move(ora)});
  }
  if (options.pdf) {
    const fs::path path = folder / TemplateName(light, index, ".pdf");
    if (Exists(path)) {
      const auto old = ReadWholeFile(path);
      if (!old || !IsTemplatePdf(*old)) {
        return OutputError(path.string() +
                           " is there already and another program has written to it: move it away, or write "
                           "to another folder");
      }
    }
    SCUMBLE_ASSIGN(const PrintPage page, PlacePage(options.page, light.guides.width(), options.dpi));
    SCUMBLE_ASSIGN(auto pdf, EncodeTemplatePdf(light, page, options.dpi, PaintingName(light, index), path.string()));
    files.push_back({path, std::move(pdf)});
  }
  return Ok();
}

}  // namespace

Expected<std::vector<fs::path>> WriteSphereKit(const fs::path& folder, std::vector<KitLight> lights,
                                               const KitOptions& options) {
  SCUMBLE_CHECK(!lights.empty());
  std::error_code made;
  fs::create_directories(folder, made);
  if (made) return OutputError("cannot make the folder " + folder.string() + ": " + made.message());
  const FolderLock lock(folder);
  std::vector<std::vector<KitFile>> templates(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    SCUMBLE_RETURN_IF_ERROR(MakeTemplate(folder, lights[i], i, options, templates[i]));
    SCUMBLE_RETURN_IF_ERROR(RefuseOtherGuides(folder, lights[i], i));
  }
  const fs::path style = folder / "style.toml", howto = folder / "HOWTO.txt";
  SCUMBLE_ASSIGN(const std::optional<std::string> new_style, NewStyle(style, lights));
  GuideWriteOptions write;
  if (options.fast_guides) write.compression = kFastCompression;
  std::vector<fs::path> written;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    for (const KitFile& file : templates[i]) {
      SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(file.path, file.bytes));
      written.push_back(file.path);
    }
    GuideSet& guides = lights[i].guides;
    guides.attributes[kMarginAttribute] = std::to_string(TemplateMargin(guides.width()));
    const fs::path guide_file = folder / GuidesName(lights[i], i);
    SCUMBLE_RETURN_IF_ERROR(WriteGuides(guide_file, guides, write));
    written.push_back(guide_file);
  }
  if (new_style) {
    SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(style, *new_style));
    written.push_back(style);
  }
  if (lights.front().name.empty() || !Exists(howto)) {
    SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(howto, Howto(lights, options)));
    written.push_back(howto);
  }
  return written;
}

std::vector<std::string> UnlistedGuides(const fs::path& folder, const std::vector<fs::path>& written) {
  std::vector<std::string> unlisted;
  if (std::find(written.begin(), written.end(), folder / "style.toml") != written.end()) return unlisted;
  const auto bytes = ReadWholeFile(folder / "style.toml", kMaxStyleBytes);
  if (!bytes) return unlisted;
  const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  const auto style = internal::ParseToml(text, "style.toml");
  if (!style) return unlisted;
  const std::vector<ListedExemplar> listed = ExemplarsOf(*style);
  for (const fs::path& file : written) {
    const std::string name = file.filename().string();
    const bool is_listed = std::any_of(listed.begin(), listed.end(),
                                       [&](const ListedExemplar& exemplar) { return exemplar.guides == name; });
    if (file.extension() == ".exr" && !is_listed) unlisted.push_back(name);
  }
  return unlisted;
}

std::optional<fs::path> GuidesOfPainting(const fs::path& painting) {
  const std::string stem = painting.stem().string();
  std::vector<std::string> names{stem + "-guides.exr"};
  if (const auto number = NumberBehind("lit", stem)) names.push_back("guides" + *number + ".exr");
  for (const std::string& name : names) {
    std::error_code failed;
    const fs::path guides = painting.parent_path() / name;
    if (fs::is_regular_file(guides, failed)) return guides;
  }
  return std::nullopt;
}

std::optional<std::string> PaintingOfTemplate(const std::string& stem) {
  if (const auto number = NumberBehind("template", stem)) return "lit" + *number;
  constexpr std::string_view kEnd = "-template";
  if (stem.size() <= kEnd.size() || stem.compare(stem.size() - kEnd.size(), kEnd.size(), kEnd) != 0)
    return std::nullopt;
  return stem.substr(0, stem.size() - kEnd.size());
}

}  // namespace scumble
