// The artist's kit: a lit sphere to paint over, on screen or on paper, and what turns the painting into a style.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/style/kit/print_page.h"
#include "core/style/kit/sphere_template.h"

namespace scumble {

// Which files of the template are written, and for what paper.
struct KitOptions {
  bool png = true;           // for any painting program
  bool ora = true;           // in layers, for Krita, GIMP and MyPaint
  bool pdf = true;           // for the printer
  bool fast_guides = false;  // guides in kFastCompression
  int dpi = 300;             // pixels an inch on paper
  PaperSize page = PaperSize::kAuto;
};

// Writes into `folder`, for lights without names, template.png, template.ora, template.pdf and guides.exr, for further
// ones template-2.png and guides-2.exr and so on; for lights with names shade-template.png and shade-guides.exr; a
// style.toml that lists them all, and HOWTO.txt. A style.toml that is there already may be the artist's: lights with
// names that it does not list are added at its end, otherwise it is kept. Paintings (lit.png, shade.ora) are never
// written. A template that is not as it was drawn, in whichever of its files, may be one, and guides of another size
// or light belong to one that is there: either is an error, as is a fifth light in style.toml or a template that does
// not fit the paper, and nothing is written. Returns the files written.
Expected<std::vector<std::filesystem::path>> WriteSphereKit(const std::filesystem::path& folder,
                                                            std::vector<KitLight> lights,
                                                            const KitOptions& options = {});

// The guides that a kit has put beside a painting of that name: STEM-guides.exr of a light with a name; else, for
// lit.png and lit-2.png, guides.exr and guides-2.exr. Nothing where there is no such file.
std::optional<std::filesystem::path> GuidesOfPainting(const std::filesystem::path& painting);

// The painting that belongs on a template, by their stems: "lit" for "template", "lit-2" for "template-2", "shade" for
// "shade-template". Nothing for stems that are no template's.
std::optional<std::string> PaintingOfTemplate(const std::string& stem);

}  // namespace scumble
