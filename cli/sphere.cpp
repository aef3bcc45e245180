// scumble sphere: the artist's kit.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <string_view>

#include "cli/command.h"
#include "cli/json_text.h"
#include "cli/options.h"
#include "cli/rectify.h"
#include "guidegen/guidegen.h"
#include "image/direction.h"
#include "style/sphere_kit.h"

namespace scumble {
namespace {

struct SphereVerb {
  int size = 1024;
  std::vector<std::string> lights;
  std::vector<std::string> names;  // none, or one a light
  std::string layers;
  int aa = 4;
  std::string isa;
  std::string output;
  RectifyRequest rectify;
};

// As --light takes it.
std::string KeyLightText() { return fmt::format("{:g},{:g}", kKeyLightAzimuth, kKeyLightElevation); }

Expected<KitLight> RenderLight(const SphereVerb& verb, const std::string& text, const Globals& globals) {
  SCUMBLE_ASSIGN(const auto angles, ParseNumbers(text, 2, 2, "--light"));
  if (angles[1] < -90.0 || angles[1] > 90.0) return UsageError("--light " + text + ": elevation must be -90 to 90");
  SphereOptions options;
  options.size = verb.size;
  options.layers = {Layer::kPosition, Layer::kAlbedo, Layer::kLuminance, Layer::kShadow};
  SCUMBLE_ASSIGN(const LayerSet more, ParseLayers(verb.layers));
  options.layers.Add(more);
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
      return std::isalnum(c) || c == '-' || c == '_' || c >= 0x80;
    });
    constexpr std::string_view kTemplate = "template";
    const bool ours = name.size() >= kTemplate.size() &&
                      name.compare(name.size() - kTemplate.size(), kTemplate.size(), kTemplate) == 0;
    if (name.empty() || name[0] == '-' || !plain || ours) {
      return UsageError("--name " + name + ": expected the name of the painting without its ending, of letters, digits, "
                        "- and _, that does not end in 'template'");
    }
    if (std::count(verb.names.begin(), verb.names.end(), name) > 1) {
      return UsageError("--name " + name + " stands there twice: each light has a painting of its own");
    }
  }
  return Ok();
}

Expected<ExitCode> RunSphereVerb(const SphereVerb& verb, const Globals& globals) {
  std::vector<std::string> texts = verb.lights;
  if (texts.empty()) texts = {KeyLightText()};
  SCUMBLE_RETURN_IF_ERROR(CheckNames(verb, texts.size()));
  std::vector<KitLight> lights;
  for (const std::string& text : texts) {
    SCUMBLE_ASSIGN(KitLight light, RenderLight(verb, text, globals));
    if (!verb.names.empty()) light.name = verb.names[lights.size()];
    lights.push_back(std::move(light));
  }
  SCUMBLE_ASSIGN(const auto files, WriteSphereKit(verb.output, std::move(lights)));
  if (globals.json) {
    nlohmann::ordered_json json;
    for (const auto& file : files) json["files"].push_back(file.string());
    Print(JsonText(json));
  } else {
    for (const auto& file : files) Print(file.string() + "\n");
    const std::string drawn = verb.names.empty() ? "template.png" : verb.names[0] + "-template.png";
    const std::string painting = verb.names.empty() ? "lit.png" : verb.names[0] + ".png";
    Say(globals, "paint over " + drawn + ", save it as " + painting + " in the same folder; HOWTO.txt says how");
  }
  return ExitCode::kOk;
}

}  // namespace

void AddSphereVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<SphereVerb>();
  CLI::App* sub = app.add_subcommand("sphere", "a lit sphere to paint over: template, guides, starter style");
  sub->add_option("--size", verb->size,
                  "pixels of the sphere's square, 16 to 8192; the template has a margin around it")
      ->type_name("N")
      ->check(CLI::Range(16, 8192))
      ->capture_default_str();
  sub->add_option(
         "--light", verb->lights,
         "where the light comes from: azimuth in degrees to the right of the viewer, elevation in degrees above "
         "the horizon; left out: " +
             KeyLightText() + ", upper left over the shoulder. Repeat it for one template per light")
      ->type_name("AZ,EL")
      ->allow_extra_args(false);
  sub->add_option("--name", verb->names,
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
  sub->add_option("-o,--output", verb->output, "folder to write to; what is painted there is kept. With --rectify the picture to write: the kit's lit.png")
      ->type_name("FOLDER")
      ->required();
  AddRectifyOptions(*sub, verb->rectify);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, sub, &globals, &chosen] {
    chosen = [verb, sub, &globals]() -> Expected<ExitCode> {
      if (sub->count("--rectify") == 0) return RunSphereVerb(*verb, globals);
      verb->rectify.size = verb->size, verb->rectify.output = verb->output;
      return RunRectify(*sub, verb->rectify, globals);
    };
  });
}

}  // namespace scumble
