#include "style/sphere_kit.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "image/check.h"
#include "image/color.h"
#include "image/direction.h"
#include "image/style.h"
#include "io/atomic_file.h"
#include "io/guide_file.h"
#include "io/picture_file.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMarginAttribute = "scumble:sphereMargin";

void FillRectangle(Picture& picture, int x0, int y0, int x1, int y1, std::uint16_t grey) {
  for (int y = std::max(0, y0); y < std::min(picture.height, y1); ++y) {
    for (int x = std::max(0, x0); x < std::min(picture.width, x1); ++x) {
      std::uint16_t* pixel = picture.At(x, y);
      pixel[0] = pixel[1] = pixel[2] = grey, pixel[3] = 65535;
    }
  }
}

// Crosses in the corners of the margin, and short ticks where the square's sides begin.
void DrawRegistrationMarks(Picture& picture, int size, int margin) {
  const int stroke = std::max(1, size / 256), arm = std::max(1, margin / 3);
  const int far = margin + size;
  for (const int cy : {margin / 2, far + margin - margin / 2}) {
    for (const int cx : {margin / 2, far + margin - margin / 2}) {
      FillRectangle(picture, cx - arm, cy - stroke / 2, cx + arm, cy - stroke / 2 + stroke, 0);
      FillRectangle(picture, cx - stroke / 2, cy - arm, cx - stroke / 2 + stroke, cy + arm, 0);
    }
  }
  const int tick = margin / 4;
  constexpr std::uint16_t kGrey = 40000;
  for (const int side : {margin, far - stroke}) {
    FillRectangle(picture, side, 0, side + stroke, tick, kGrey);
    FillRectangle(picture, side, far + margin - tick, side + stroke, far + margin, kGrey);
    FillRectangle(picture, 0, side, tick, side + stroke, kGrey);
    FillRectangle(picture, far + margin - tick, side, far + margin, side + stroke, kGrey);
  }
}

std::string Numbered(const std::string& stem, const std::string& ending, std::size_t index) {
  return index == 0 ? stem + ending : stem + "-" + std::to_string(index + 1) + ending;
}

std::string LightInWords(const KitLight& light) {
  char text[120];
  std::snprintf(text, sizeof text, "azimuth %g, elevation %g degrees", light.azimuth, light.elevation);
  return text;
}

std::string PaintingName(const KitLight& light, std::size_t index) {
  return light.name.empty() ? Numbered("lit", ".png", index) : light.name + ".png";
}
std::string TemplateName(const KitLight& light, std::size_t index) {
  return light.name.empty() ? Numbered("template", ".png", index) : light.name + "-template.png";
}
std::string GuidesName(const KitLight& light, std::size_t index) {
  return light.name.empty() ? Numbered("guides", ".exr", index) : light.name + "-guides.exr";
}

// `mark` begins each line: empty, or what makes a comment of it.
std::string ExemplarEntry(const KitLight& light, std::size_t index, const std::string& mark) {
  return "\n" + mark + "[[exemplar]]          # light from " + LightInWords(light) + "\n" + mark + "image = \"" +
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
                     "threshold = 0.125     # smaller: shape is followed closer; larger: bigger patches of your paint\n"
                     "blend_radius = 1      # how softly patches melt into each other, pixels\n"
                     "scale = 1.0           # smaller: finer strokes in the picture\n"
                     "paper = \"\"            # a colour like \"#f4efe6\" or a picture behind; empty: transparent\n";
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (i == std::size_t(kMaxExemplars)) text += "\n# A style takes up to four lights.";
    text += ExemplarEntry(lights[i], i, i < std::size_t(kMaxExemplars) ? "" : "# ");
  }
  return text;
}

std::string Howto(const std::vector<KitLight>& lights) {
  std::string text =
      "PAINT YOUR OWN STYLE\n\n"
      "1. Open " + TemplateName(lights[0], 0) + " in any painting program. Paint over the sphere: its light comes from\n   " +
      LightInWords(lights.front()) +
      "\n   (azimuth to the right of the viewer, elevation above the horizon).\n"
      "2. Let strokes run over the sphere's edge; what lies outside it is never shown.\n"
      "3. Do not move, scale or crop the picture. Export it at the same size as " + PaintingName(lights[0], 0) +
      " into this folder.\n"
      "4. Stylise a scene:   scumble stylize scene.glb --style THIS_FOLDER -o picture.png\n"
      "5. Tune style.toml: threshold, scale, blend_radius, paper.\n\n"
      "What helps: the whole range from highlight to reflected light; strokes with a direction; irregular, lively\n"
      "texture. What hurts: a regular pattern (it tears where patches meet), bare template showing through.\n";
  for (std::size_t i = 1; i < lights.size(); ++i) {
    text += "\n" + TemplateName(lights[i], i) + " is the same sphere in another light: " + LightInWords(lights[i]) +
            ".\nPaint it too and save it as " + PaintingName(lights[i], i) +
            ", or take its [[exemplar]] out of style.toml.\n";
  }
  text += "\nAnother light later:   scumble sphere --size N --light AZ,EL --name shade -o THIS_FOLDER\n";
  return text;
}

}  // namespace

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

bool LooksLikeTemplate(const Picture& picture) {
  constexpr int kSmallestRecognised = 63;  // below it the crosses are specks
  if (picture.width != picture.height) return false;
  // The sphere's side from the whole template's: size + 2 · margin(size) grows with the size, so at most one fits.
  int size = picture.width * 4 / 5 - 8;
  while (size + 2 * TemplateMargin(size) < picture.width) ++size;
  const int margin = TemplateMargin(size), arm = margin / 3;
  if (size < kSmallestRecognised || size + 2 * margin != picture.width) return false;
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

Picture DrawTemplate(const KitLight& light) {
  const GuideSet& guides = light.guides;
  SCUMBLE_CHECK_EQ(guides.width(), guides.height());
  const glm::vec3 to_light(DirectionFromAngles(light.azimuth, light.elevation));
  const int size = guides.width(), margin = TemplateMargin(size);
  Picture picture(size + 2 * margin, size + 2 * margin);
  FillRectangle(picture, 0, 0, picture.width, picture.height, 65535);
  const auto coverage = guides.Plane(Layer::kCoverage), luminance = guides.Plane(Layer::kLuminance);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (!(coverage[i] > 0.0f)) continue;
      // A little reflected light from the far side keeps the form readable in the shade, as a model in a studio has it.
      const glm::vec3 normal = guides.Vec3(Layer::kNormal, i);
      const float away = std::max(0.0f, -glm::dot(normal, to_light));
      const float lit = 0.03f + 0.12f * away + 0.05f * normal.z + 0.80f * luminance[i];
      const float blended = lit * coverage[i] + (1.0f - coverage[i]);
      const std::uint16_t grey = Srgb16FromLinear(blended);
      std::uint16_t* pixel = picture.At(x + margin, y + margin);
      pixel[0] = pixel[1] = pixel[2] = grey;
    }
  }
  DrawRegistrationMarks(picture, size, margin);
  return picture;
}

namespace {

bool SameIn8Bits(const Picture& file, const Picture& drawn) {
  return file.rgba.size() == drawn.rgba.size() &&
         std::equal(file.rgba.begin(), file.rgba.end(), drawn.rgba.begin(),
                    [](std::uint16_t a, std::uint16_t b) { return a / 257u == (b + 128u) / 257u; });
}

// A template that somebody painted over must not be lost; one that is as we would draw it may go.
Status RefusePaintedTemplate(const fs::path& path, const Picture& drawn) {
  std::error_code failed;
  if (!fs::exists(path, failed)) return Ok();
  const auto old = ReadPicture(path);
  if (old && SameIn8Bits(*old, drawn)) return Ok();
  return OutputError(path.string() + " is there already and differs from the template of this size and light: it may be "
                     "a painting. Move it away, give this light a --name of its own, or write to another folder");
}

// A painting fits the guides that it was painted with.
Status RefuseOtherGuides(const fs::path& guides, const fs::path& painting, int size) {
  std::error_code failed;
  if (!fs::exists(painting, failed)) return Ok();
  const auto old = InspectGuides(guides);
  if (!old || (old->width == size && old->height == size)) return Ok();
  return OutputError(guides.string() + " is of " + std::to_string(old->width) + "² pixels and belongs to " +
                     painting.string() + ": take --size " + std::to_string(old->width) + ", or write to another folder");
}

// style.toml as it should be; nothing where it should stay as it is.
Expected<std::optional<std::string>> NewStyle(const fs::path& path, const std::vector<KitLight>& lights) {
  std::error_code failed;
  if (!fs::exists(path, failed)) return std::optional(StarterStyle(lights));
  constexpr std::size_t kMaxStyleBytes = 1 << 20;
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path, kMaxStyleBytes));
  const std::string old(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::string text = old;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const std::string painting = PaintingName(lights[i], i);
    const bool listed = old.find('"' + painting + '"') != std::string::npos ||
                        old.find('\'' + painting + '\'') != std::string::npos;
    if (lights[i].name.empty() || listed) continue;
    if (!text.empty() && text.back() != '\n') text += '\n';
    text += ExemplarEntry(lights[i], i, "");
  }
  if (text == old) return std::optional<std::string>();
  int exemplars = 0;
  for (std::size_t at = text.find("\n[[exemplar]]"); at != std::string::npos; at = text.find("\n[[exemplar]]", at + 1)) ++exemplars;
  exemplars += text.rfind("[[exemplar]]", 0) == 0;
  if (exemplars > kMaxExemplars) {
    return OutputError(path.string() + " would list " + std::to_string(exemplars) + " lights: a style takes up to " +
                       std::to_string(kMaxExemplars) + "; take an [[exemplar]] out, or write to another folder");
  }
  return std::optional(std::move(text));
}

}  // namespace

Expected<std::vector<fs::path>> WriteSphereKit(const fs::path& folder, std::vector<KitLight> lights) {
  SCUMBLE_CHECK(!lights.empty());
  std::error_code made;
  fs::create_directories(folder, made);
  if (made) return OutputError("cannot make the folder " + folder.string() + ": " + made.message());
  std::vector<Picture> templates;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    templates.push_back(DrawTemplate(lights[i]));
    SCUMBLE_RETURN_IF_ERROR(RefusePaintedTemplate(folder / TemplateName(lights[i], i), templates.back()));
    SCUMBLE_RETURN_IF_ERROR(RefuseOtherGuides(folder / GuidesName(lights[i], i), folder / PaintingName(lights[i], i),
                                              lights[i].guides.width()));
  }
  const fs::path style = folder / "style.toml", howto = folder / "HOWTO.txt";
  SCUMBLE_ASSIGN(const std::optional<std::string> new_style, NewStyle(style, lights));
  std::vector<fs::path> written;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    GuideSet& guides = lights[i].guides;
    guides.attributes[kMarginAttribute] = std::to_string(TemplateMargin(guides.width()));
    const fs::path picture = folder / TemplateName(lights[i], i);
    const fs::path guide_file = folder / GuidesName(lights[i], i);
    SCUMBLE_RETURN_IF_ERROR(WritePicture(picture, templates[i]));
    SCUMBLE_RETURN_IF_ERROR(WriteGuides(guide_file, guides));
    written.insert(written.end(), {picture, guide_file});
  }
  if (new_style) {
    SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(style, *new_style));
    written.push_back(style);
  }
  std::error_code failed;
  if (lights.front().name.empty() || !fs::exists(howto, failed)) {
    SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(howto, Howto(lights)));
    written.push_back(howto);
  }
  return written;
}

}  // namespace scumble
