// scumble sphere: the artist's kit.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>

#include "apps/cli/app/command.h"
#include "apps/cli/app/json_text.h"
#include "apps/cli/app/options.h"
#include "apps/cli/app/run_report.h"
#include "apps/cli/verbs/rectify_verb.h"
#include "core/image/direction.h"
#include "core/style/fiducials.h"
#include "core/style/sphere_kit.h"
#include "guidegen/guidegen.h"
#include "pipeline/memory_estimate.h"

namespace scumble {
namespace {

constexpr int kUsualSize = 1024, kSmallest = 16, kLargest = 8192;
constexpr int kSmallestPrinted = 128;  // FiducialsFit

struct SphereVerb {
  int size = kUsualSize;
  std::string print_size;  // instead of pixels
  int dpi = KitOptions().dpi;
  std::string page = "auto";
  bool page_given = false;
  std::vector<std::string> only;
  std::vector<std::string> lights;
  std::vector<std::string> names;  // none, or one a light
  std::string layers;
  int aa = 4;
  std::string isa;
  bool fast_io = false;
  std::string output;
  RectifyRequest rectify;
};

// As --light takes it.
std::string KeyLightText() { return fmt::format("{:g},{:g}", kKeyLightAzimuth, kKeyLightElevation); }

Expected<LayerSet> LayersOf(const SphereVerb& verb) {
  SCUMBLE_ASSIGN(const LayerSet more, ParseLayers(verb.layers));
  if (more.Has(Layer::kMotion)) return UsageError("--layers motion: the sphere does not move; leave it out");
  return LayerSet{Layer::kPosition, Layer::kAlbedo, Layer::kLuminance, Layer::kShadow}.Add(more);
}

Expected<KitLight> RenderLight(const SphereVerb& verb, const std::string& text, const Globals& globals) {
  SCUMBLE_ASSIGN(const auto angles, ParseNumbers(text, 2, 2, "--light"));
  if (const Status good = CheckLight({angles[0], angles[1]}); !good.ok()) {
    return UsageError("--light " + text + ": " + good.error().message);
  }
  SphereOptions options;
  options.size = verb.size;
  SCUMBLE_ASSIGN(options.layers, LayersOf(verb));
  options.aa = verb.aa;
  options.light_azimuth = angles[0], options.light_elevation = angles[1];
  options.threads = globals.threads;
  options.isa = verb.isa;
  SCUMBLE_ASSIGN(GuidegenResult rendered, RenderSphereGuides(options));
  return KitLight{angles[0], angles[1], std::move(rendered.guides)};
}

// Names of pictures to be painted, which must not be those of files that are written.
Status CheckNames(const SphereVerb& verb, std::size_t lights) {
  if (verb.names.empty()) return Ok();
  if (verb.names.size() != lights) {
    return UsageError(fmt::format("{} --name for {} --light: expected one each", verb.names.size(), lights));
  }
  for (const std::string& name : verb.names) {
    const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
      return std::isalnum(c) || c == '-' || c == '_' || c == ' ' || c >= 0x80;
    });
    constexpr std::string_view kTemplate = "template";
    const bool ours = name.size() >= kTemplate.size() &&
                      name.compare(name.size() - kTemplate.size(), kTemplate.size(), kTemplate) == 0;
    if (name.empty() || name[0] == '-' || name.front() == ' ' || name.back() == ' ' || !plain || ours) {
      return UsageError("--name '" + name +
                        "': expected the name of the painting without its ending: letters, digits, -, _, and spaces "
                        "between them, not with 'template' at its end");
    }
    if (std::count(verb.names.begin(), verb.names.end(), name) > 1) {
      return UsageError("--name " + name + " stands there twice: each light has a painting of its own");
    }
  }
  return Ok();
}

// Pixels of a sphere of that length on paper.
Expected<int> PrintedSize(const std::string& length, int dpi) {
  const auto millimetres = ParseLengthMm(length);
  if (!millimetres) return UsageError("--print-size " + millimetres.error().message);
  const double pixels = *millimetres / MillimetresOf(1, dpi);
  if (!(pixels >= kSmallest && pixels <= kLargest)) {
    return UsageError(fmt::format("--print-size {} at {} dpi is {:.0f} pixels: expected {} to {}; take another --dpi",
                                  length, dpi, pixels, kSmallest, kLargest));
  }
  return static_cast<int>(std::lround(pixels));
}

Expected<KitOptions> ReadKitOptions(const SphereVerb& verb) {
  KitOptions options;
  options.dpi = verb.dpi;
  options.fast_guides = verb.fast_io;
  SCUMBLE_ASSIGN(options.page, ParsePaperSize(verb.page));
  if (verb.only.empty()) return options;
  options.png = options.ora = options.pdf = false;
  for (const std::string& format : verb.only) {
    if (format == "png")
      options.png = true;
    else if (format == "ora")
      options.ora = true;
    else if (format == "pdf")
      options.pdf = true;
    else
      return UsageError("--only " + format + ": expected png, ora or pdf, or several with commas between");
  }
  return options;
}

// Refuses unavailable paper, and warns of unsuitable paper.
Status CheckPaper(const SphereVerb& verb, const KitOptions& options, const Globals& globals) {
  if (!options.pdf) {
    if (verb.page_given) globals.Warn("--page is the paper of the PDF, which --only leaves out: it changes nothing");
    return Ok();
  }
  if (!options.png && !options.ora && !FiducialsFit(verb.size)) {
    return UsageError(
        fmt::format("--only pdf with a sphere of {} pixels: it is too small to have the marks by which "
                    "--rectify reads a painting on paper; expected --size {} or more",
                    verb.size, kSmallestPrinted));
  }
  constexpr double kLeastMm = 20;
  const double across = MillimetresOf(verb.size, verb.dpi);
  if (FiducialsFit(verb.size) && across < kLeastMm) {
    globals.Warn(
        fmt::format("the printed sphere is {:.1f} mm across, small for a brush, and must be scanned at {} dpi or more: "
                    "take a larger --size, or --print-size",
                    across, ScanDpi(verb.size, verb.dpi)));
  }
  return Ok();
}

// Prints the file to paint on, and the next step.
void PrintNextStep(const SphereVerb& verb, const KitOptions& options, const std::optional<PrintPage>& page,
                   const Globals& globals) {
  const std::string stem = verb.names.empty() ? "template" : verb.names[0] + "-template";
  const std::string painting = verb.names.empty() ? "lit.png" : verb.names[0] + ".png";
  std::string files;
  if (options.ora) files = stem + ".ora (layers: Krita, GIMP, MyPaint)";
  if (options.png) files += std::string(files.empty() ? "" : " or ") + stem + ".png";
  if (!files.empty())
    globals.Note("paint over " + files + ", save it as " + painting + " in the same folder; HOWTO.txt says how");
  if (page && !FiducialsFit(verb.size)) {
    globals.Note(fmt::format("{}.pdf is for looking at: only spheres of {} pixels or more have marks to scan by", stem,
                             kSmallestPrinted));
  } else if (page) {
    globals.Note(
        fmt::format("print {}.pdf at 100%: a sphere of {:.1f} mm on {}", stem, MillimetresOf(verb.size, verb.dpi),
                    page->name == "fit" ? fmt::format("a page of {:.0f} x {:.0f} mm", page->width_mm, page->height_mm)
                                        : page->name));
  }
}

Expected<ExitCode> RunSphereVerb(SphereVerb verb, const Globals& globals) {
  if (!verb.print_size.empty()) {
    SCUMBLE_ASSIGN(verb.size, PrintedSize(verb.print_size, verb.dpi));
  }
  SCUMBLE_ASSIGN(const KitOptions options, ReadKitOptions(verb));
  SCUMBLE_RETURN_IF_ERROR(CheckPaper(verb, options, globals));
  std::optional<PrintPage> page;
  // A large sphere takes a while to render: paper sizes are checked before.
  if (options.pdf) {
    SCUMBLE_ASSIGN(page, PlacePage(options.page, verb.size, verb.dpi));
  }
  std::vector<std::string> texts = verb.lights;
  if (texts.empty()) texts = {KeyLightText()};
  SCUMBLE_RETURN_IF_ERROR(CheckNames(verb, texts.size()));
  MemoryNeed memory;
  AddProgram(globals.threads, memory);
  SCUMBLE_ASSIGN(const LayerSet layers, LayersOf(verb));
  AddKit(verb.size, texts.size(), layers, options.ora, memory);
  SCUMBLE_RETURN_IF_ERROR(CheckMemory(memory, globals, "take a smaller --size, fewer --light, or --only png"));
  std::vector<KitLight> lights;
  for (const std::string& text : texts) {
    SCUMBLE_ASSIGN(KitLight light, RenderLight(verb, text, globals));
    if (!verb.names.empty()) light.name = verb.names[lights.size()];
    lights.push_back(std::move(light));
  }
  SCUMBLE_ASSIGN(const auto files, WriteSphereKit(verb.output, std::move(lights), options));
  for (const std::string& guides : UnlistedGuides(verb.output, files)) {
    globals.Warn(
        fmt::format("{}/style.toml was kept and does not name {}: for a painting over this template add "
                    "[[exemplar]] with its image and guides = \"{}\"",
                    verb.output, guides, guides));
  }
  if (globals.json) {
    nlohmann::ordered_json json;
    for (const auto& file : files) json["files"].push_back(file.string());
    json["size"] = verb.size;
    json["dpi"] = verb.dpi;
    json["memory"] = MemoryToJson(memory);
    json["memory"]["peak_bytes"] = PeakMemory();
    if (page) json["page"] = {{"name", page->name}, {"width_mm", page->width_mm}, {"height_mm", page->height_mm}};
    Print(JsonText(json));
  } else {
    for (const auto& file : files) Print(file.string() + "\n");
    PrintNextStep(verb, options, page, globals);
  }
  return ExitCode::kOk;
}

}  // namespace

void AddSphereVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<SphereVerb>();
  CLI::App* sub = app.add_subcommand("sphere", "a lit sphere to paint over: template, guides, starter style");
  auto* size = sub->add_option("--size", verb->size,
                               "pixels of the sphere's square, 16 to 8192; the template has a margin around it")
                   ->type_name("N")
                   ->check(CLI::Range(kSmallest, kLargest))
                   ->capture_default_str();
  sub->add_option("--print-size", verb->print_size,
                  "the sphere's diameter on paper instead, 150mm, 15cm or 6in; --dpi makes pixels of it")
      ->type_name("LENGTH")
      ->excludes(size);
  sub->add_option("--dpi", verb->dpi, "pixels an inch on paper, 72 to 2400: how large the template is printed")
      ->type_name("N")
      ->check(CLI::Range(72, 2400))
      ->capture_default_str();
  sub->add_option("--page", verb->page,
                  "paper of the PDF, true to scale: a4, letter, a3, or fit for a page of the template's own size; "
                  "auto: A4, A3 or fit, "
                  "the first that holds it")
      ->type_name("NAME")
      ->capture_default_str();
  sub->add_option("--only", verb->only,
                  "template files to write: png for any painting program, ora in layers for Krita, GIMP and MyPaint, "
                  "pdf for the "
                  "printer; several with commas between. Left out: all three")
      ->type_name("FORMATS")
      ->delimiter(',')
      ->allow_extra_args(false);
  sub->add_option(
         "--light", verb->lights,
         "where the light comes from: azimuth in degrees to the right of the viewer, elevation in degrees above "
         "the horizon; left out: " +
             KeyLightText() + ", upper left over the shoulder. Repeat it for one template per light")
      ->type_name("AZ,EL")
      ->allow_extra_args(false);
  sub->add_option(
         "--name", verb->names,
         "what the painting for a light will be called: shade for shade.png, to be painted over "
         "shade-template.png; once for each --light; style.toml lists it, also one that is there already. Left "
         "out: lit, lit-2 and so on")
      ->type_name("NAME")
      ->allow_extra_args(false);
  sub->add_option("--layers", verb->layers,
                  "layers of the guides beyond A, normal, depth, object, material, position, albedo, luminance and "
                  "shadow, for transfer.guide_weights: lpe.LDE, lpe.LSE, ...")
      ->type_name("NAMES");
  sub->add_option("--aa", verb->aa, "N x N subsamples of the silhouette's coverage, 1 to 16")
      ->type_name("N")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  sub->add_option("--isa", verb->isa,
                  "Embree's instruction set: sse2, sse4.2, avx, avx2 or avx512; left out: the best of this machine")
      ->type_name("NAME");
  AddFastIoOption(*sub, verb->fast_io);
  sub->add_option(
         "-o,--output", verb->output,
         "folder to write to; what is painted there is kept. With --rectify the picture to write: the kit's lit.png")
      ->type_name("FOLDER")
      ->required();
  AddRectifyOptions(*sub, verb->rectify);
  AddMemoryOption(*sub, globals);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, sub, &globals, &chosen] {
    chosen = [verb, sub, &globals]() -> Expected<ExitCode> {
      verb->page_given = sub->count("--page") > 0;
      if (sub->count("--rectify") == 0) return RunSphereVerb(*verb, globals);
      verb->rectify.size = verb->size, verb->rectify.output = verb->output;
      return RunRectify(*sub, verb->rectify, globals);
    };
  });
}

}  // namespace scumble
