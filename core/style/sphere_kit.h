// The artist's kit: a lit sphere to paint over, on screen or on paper, and the files that make a style of the painting.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/style/kit/print_page.h"
#include "core/style/sphere_template.h"

namespace scumble {

// The template files to write, and the paper they are for.
struct KitOptions {
  bool png = true;           // for any painting program
  bool ora = true;           // in layers, for Krita, GIMP and MyPaint
  bool pdf = true;           // for the printer
  bool fast_guides = false;  // guides in kFastCompression
  int dpi = 300;             // pixels an inch on paper
  PaperSize page = PaperSize::kAuto;
};

// Writes the kit into `folder`. Lights without names get template.png, template.ora, template.pdf and guides.exr,
// further ones template-2.png, guides-2.exr and so on. Lights with names get shade-template.png and shade-guides.exr. A
// style.toml lists them all; HOWTO.txt explains them.
//
// An existing style.toml may be the artist's: missing lights with names are added at its end. Lights without names are
// added if it lists no exemplar and its method needs one. Otherwise it is kept.
// Paintings (lit.png, shade.ora) are never written. A template that differs from the drawn one, in any of its files,
// may be a painting. Guides of another size or light belong to an existing painting. Either is an error, as is a
// painting that style.toml lists with other guides, a fifth light in style.toml, or a template that does not fit the
// paper, and nothing is written. Runs that write to one folder wait for each other. Returns the files written.
Expected<std::vector<std::filesystem::path>> WriteSphereKit(const std::filesystem::path& folder,
                                                            std::vector<KitLight> lights,
                                                            const KitOptions& options = {});

// The names of those guides among the `written` files of WriteSphereKit that no [[exemplar]] of a style.toml that was
// kept has: a template painted for them is no exemplar yet.
std::vector<std::string> UnlistedGuides(const std::filesystem::path& folder,
                                        const std::vector<std::filesystem::path>& written);

// The kit's guides for a painting of that name. STEM-guides.exr of a light with a name; else, for lit.png and
// lit-2.png, guides.exr and guides-2.exr. Empty if there is no such file.
std::optional<std::filesystem::path> GuidesOfPainting(const std::filesystem::path& painting);

// The painting that belongs to a template, by their stems: "lit" for "template", "lit-2" for "template-2", "shade" for
// "shade-template". Empty for stems of no template.
std::optional<std::string> PaintingOfTemplate(const std::string& stem);

}  // namespace scumble
