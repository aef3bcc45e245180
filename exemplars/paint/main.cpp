// Paints the exemplars: spheres for Scumble's bundled styles. Exit codes are those of `scumble`.
#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

#include <CLI/CLI.hpp>
#include <iostream>
#include <span>
#include <string>
#include <vector>

#include "core/image/hash.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "exemplars/paint/hatching.h"
#include "exemplars/paint/styles.h"

namespace {

using namespace scumble;
using paint::Light;

enum ExitCode { kOk = 0, kUsage = 2, kInput = 3, kOutput = 4 };

int Report(const Error& error) {
  std::cerr << "paint_exemplars: " << error.message << "\n";
  switch (error.kind) {
    case ErrorKind::kUsage:
      return kUsage;
    case ErrorKind::kOutput:
      return kOutput;
    default:
      return kInput;
  }
}

// Whether all channels are equal.
bool IsGrey(const Picture& picture) {
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const std::uint16_t* texel = picture.rgba.data() + i;
    if (texel[0] != texel[1] || texel[0] != texel[2] || texel[3] != 65535) return false;
  }
  return true;
}

// The pixels of the guides: a scene's exemplar has the size of its guides.
Expected<int> SizeOfGuides(const std::filesystem::path& guides) {
  SCUMBLE_ASSIGN(const GuideFileInfo info, InspectGuides(guides));
  return info.width;
}

Status PaintOne(const paint::StyleEntry& style, const paint::Studio& studio, const std::filesystem::path& folder) {
  const std::filesystem::path style_folder = folder / style.name;
  std::error_code failure;
  std::filesystem::create_directories(style_folder, failure);
  if (failure) {
    return OutputError(style_folder.string() + " cannot be made: " + failure.message() +
                       "; choose another folder with -o");
  }
  const auto write = [&](const char* name, const Expected<Picture>& picture) -> Status {
    if (!picture) return picture.error();
    const std::filesystem::path file = style_folder / name;
    PictureWriteOptions options;
    options.png_level = 9;
    options.grey = IsGrey(*picture);
    SCUMBLE_RETURN_IF_ERROR(WritePicture(file, *picture, options));
    std::cout << file.string() << "\n";
    return Ok();
  };
  SCUMBLE_RETURN_IF_ERROR(write("paper.png", style.paper(studio)));
  for (const paint::LightEntry& entry : std::span(paint::kLights).first(static_cast<std::size_t>(style.lights))) {
    paint::Studio sheet = studio;
    sheet.light = entry.light;
    // Another sheet, other strokes.
    if (entry.light != Light::kKey) sheet.seed = Hash(studio.seed, static_cast<std::uint64_t>(entry.light));
    SCUMBLE_RETURN_IF_ERROR(write(entry.file, style.paint(sheet)));
  }
  return Ok();
}

// FOLDER/pencil.png and so on.
Status PaintAllHatching(const paint::Studio& studio, const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  for (const char* tool : paint::kHatchTools) {
    SCUMBLE_ASSIGN(const Picture picture, paint::PaintHatching(studio, tool));
    const std::filesystem::path file = folder / (std::string(tool) + ".png");
    PictureWriteOptions options;
    options.png_level = 9, options.grey = true;
    SCUMBLE_RETURN_IF_ERROR(WritePicture(file, picture, options));
    std::cout << file.string() << "\n";
  }
  return Ok();
}

}  // namespace

int main(int argc, char** argv) {
#ifdef M_PERTURB
  // libmypaint reads a few fields of a new brush before it has set them. With this setting glibc clears new memory (the
  // byte is inverted), so that one seed always gives one picture.
  mallopt(M_PERTURB, 0xff);
#endif
  paint::Studio studio;
  studio.brushes = SCUMBLE_MYPAINT_BRUSHES;
  studio.scene = SCUMBLE_BALL_GUIDES;
  std::string chosen = "all";
  std::filesystem::path folder = ".";
  std::vector<std::string> names{"all"};
  for (const paint::StyleEntry& style : paint::kStyles) names.emplace_back(style.name);

  CLI::App app{
      "Paints spheres and papers in the styles that come with Scumble: FOLDER/NAME/lit.png and paper.png, and "
      "half.png, shade.png and deep.png for styles that are painted for several lights"};
  app.add_option("--style", chosen, "Which one")->check(CLI::IsMember(names))->capture_default_str();
  const CLI::Option* size =
      app.add_option("--size", studio.size, "Pixels along a side; left out: 1024, for scenes that of their guides")
          ->check(CLI::Range(64, 8192));
  app.add_option("--seed", studio.seed, "The same number paints the same picture")->capture_default_str();
  app.add_option("--brushes", studio.brushes, "Folder of the brushes of mypaint-brushes")->capture_default_str();
  app.add_option("--scene", studio.scene, "Guides of scenes/ball.glb, for the styles that paint a scene")
      ->capture_default_str();
  bool hatching = false;
  app.add_flag("--hatching", hatching,
               "Paint the threshold textures of finishing effects instead: FOLDER/pencil.png …");
  app.add_option("-o", folder, "Folder to write to")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kUsage;
  }
  if (hatching) {
    const Status painted = PaintAllHatching(studio, folder);
    return painted ? kOk : Report(painted.error());
  }
  for (const paint::StyleEntry& style : paint::kStyles) {
    if (chosen != "all" && chosen != style.name) continue;
    paint::Studio own = studio;
    if (style.scene && size->empty()) {
      const Expected<int> side = SizeOfGuides(studio.scene);
      if (!side) return Report(side.error());
      own.size = *side;
    }
    if (const Status status = PaintOne(style, own, folder); !status) return Report(status.error());
  }
  return kOk;
}
