#include "apps/cli/verbs/rectify_verb.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

#include "apps/cli/app/json_text.h"
#include "apps/cli/app/options.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/style/fiducials.h"
#include "core/style/rectify.h"
#include "core/style/sphere_kit.h"
#include "pipeline/run_inputs.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

// Options of `scumble sphere` that apply here; the others draw templates.
constexpr std::array<std::string_view, 8> kOptionsHere{
    "--rectify", "--square", "--no-white-balance", "--size", "--output", "--threads", "--json", "--quiet"};

Status CheckOptions(const CLI::App& verb) {
  for (const CLI::Option* option : verb.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || std::find(kOptionsHere.begin(), kOptionsHere.end(), name) != kOptionsHere.end())
      continue;
    return UsageError(name + " says how a template is made, and --rectify reads one: leave " + name + " out");
  }
  return Ok();
}

// The output is a painting: neither a folder nor the template itself.
Status CheckIsPainting(const std::string& output) {
  const fs::path path(output);
  std::error_code failed;
  if (fs::is_directory(path, failed) || (!output.empty() && output.back() == '/'))
    return UsageError("-o " + output +
                      " is a folder, and with --rectify -o is the picture: " + (path / "lit.png").string());
  if (const auto painting = PaintingOfTemplate(path.stem().string())) {
    return UsageError("-o " + output + " is the name of a kit's template, which stays as it is: save it as " +
                      (path.parent_path() / (*painting + ".png")).string());
  }
  return Ok();
}

// The side of the sphere in the kit's guides.
std::optional<int> KitSize(const fs::path& guides) {
  const auto info = InspectGuides(guides);
  return info && info->width == info->height && SphereMargin(info->header) ? std::optional(info->width) : std::nullopt;
}

// The colour of the white paper, in words.
std::string Cast(const double (&paper)[3]) {
  const auto [least, most] = std::minmax({paper[0], paper[1], paper[2]});
  if (most - least < 0.03) return "none";
  const std::string hue = paper[0] == most   ? (paper[2] == least ? "warm" : "pink")
                          : paper[1] == most ? "green"
                                             : "cool";
  return fmt::format("{}, the paper is {:.2f} : {:.2f} : {:.2f}", hue, paper[0], paper[1], paper[2]);
}

// A number that is not "-0.0".
double Tidy(double value, double step) { return std::abs(value) < step / 2 ? 0.0 : value; }

std::string ReportText(const RectifyReport& report, int size) {
  const auto out = [](std::string& text, const std::string& key, const std::string& value) {
    text += fmt::format("  {:<14} {}\n", key, value);
  };
  std::string text;
  std::string marks = fmt::format("{} of {}", report.found.size(), kFiducialCount);
  if (!report.missing.empty()) marks += "; not seen: " + FiducialPlaces(report.missing);
  out(text, "marks", marks);
  out(text, "registration",
      fmt::format("error {:.3f}% of the sphere, {:.2f} of its {} pixels; {:.3f}% at the marks", 100 * report.error,
                  report.error * size, size, 100 * report.error_at_marks));
  out(text, "sphere",
      fmt::format("{:.0f} pixels across in the scan, blurred by {:.1f}", report.sphere_pixels, report.blur));
  const std::string lens = report.lens == 0 ? "" : fmt::format(", lens {:+.1f}% at the corners", 100 * report.lens);
  out(text, "held",
      fmt::format("turned {:.1f}° clockwise, tilted about {:.0f}°{}", Tidy(report.rotation, 0.1), report.tilt, lens));
  out(text, "cast", Cast(report.paper));
  out(text, "light",
      fmt::format("falls off by {:.0f}% across the sheet; printed black reflects {:.0f}% of the paper",
                  100 * report.unevenness, 100 * report.black));
  out(text, "paint",
      fmt::format("covers {:.0f}% of the sphere, {:.0f}% of its edge", 100 * report.painted, 100 * report.painted_rim));
  return text;
}

nlohmann::ordered_json ReportJson(const RectifyReport& report, const std::string& output, int size, bool balanced) {
  const auto places = [](const std::vector<int>& ids) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const int id : ids) list.push_back(FiducialPlace(id));
    return list;
  };
  nlohmann::ordered_json json;
  json["file"] = output;
  json["size"] = size;
  json["marks"] = {{"found", places(report.found)}, {"missing", places(report.missing)}};
  json["registration_error_percent"] = 100 * report.error;
  json["registration_error_pixels"] = report.error * size;
  json["error_at_marks_percent"] = 100 * report.error_at_marks;
  json["sphere_pixels"] = report.sphere_pixels;
  json["blur_pixels"] = report.blur;
  json["rotation_degrees"] = Tidy(report.rotation, 1e-6);
  json["tilt_degrees"] = report.tilt;
  json["lens_percent"] = 100 * report.lens;
  json["white_balance"] = balanced;
  json["paper"] = report.paper;
  json["paper_light"] = report.paper_light;
  json["uneven_percent"] = 100 * report.unevenness;
  json["black_percent"] = 100 * report.black;
  json["bare_margin_percent"] = 100 * report.bare_margin;
  json["overexposed_percent"] = 100 * report.clipped;
  json["painted_percent"] = 100 * report.painted;
  json["painted_edge_percent"] = 100 * report.painted_rim;
  json["warnings"] = report.warnings;
  return json;
}

}  // namespace

void AddRectifyOptions(CLI::App& verb, RectifyRequest& request) {
  constexpr const char* kGroup = "From a scan to the exemplar";
  CLI::Option* rectify =
      verb.add_option("--rectify", request.scan,
                      "lay a scan or photograph of the printed and painted template back onto its pixels, by its "
                      "printed marks; "
                      "the paper becomes white and the light even. -o is the picture; --size, left out, is "
                      "that of the kit in its folder, or 1024")
          ->type_name("SCAN")
          ->check(RefuseEmpty)
          ->group(kGroup);
  verb.add_flag("--square", request.square,
                "the sphere's square alone, without the template's margin: an exemplar without a kit")
      ->needs(rectify)
      ->group(kGroup);
  verb.add_flag("--no-white-balance", request.no_white_balance, "keep colours and light as they are in the scan")
      ->needs(rectify)
      ->group(kGroup);
}

Expected<ExitCode> RunRectify(const CLI::App& verb, const RectifyRequest& request, const Globals& globals) {
  SCUMBLE_RETURN_IF_ERROR(CheckOptions(verb));
  SCUMBLE_RETURN_IF_ERROR(CheckIsPainting(request.output));
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(request.output));
  RunInputs files;
  files.Reads("the scan", request.scan);
  SCUMBLE_RETURN_IF_ERROR(files.CheckOutput(request.output));
  SCUMBLE_ASSIGN(const PictureHeader header, InspectPicture(request.scan));
  SCUMBLE_RETURN_IF_ERROR(CheckScanSize(header.width, header.height, header.dpi, request.scan));
  std::optional<fs::path> guides = GuidesOfPainting(request.output);
  const fs::path of_kit = fs::path(request.output).parent_path() / "guides.exr";  // of a painting of another name
  std::error_code failed;
  if (!guides && fs::is_regular_file(of_kit, failed)) guides = of_kit;
  const int kit = guides ? KitSize(*guides).value_or(0) : 0;  // 0: there is none
  RectifyOptions options;
  options.size = verb.count("--size") > 0 ? request.size : kit > 0 ? kit : request.size;
  options.with_margin = !request.square, options.white_balance = !request.no_white_balance;
  options.dpi = header.dpi;
  SCUMBLE_ASSIGN(Picture scan, ReadPicture(request.scan));
  SCUMBLE_ASSIGN(const Rectified rectified, RectifyScan(std::move(scan), request.scan, options));
  PictureWriteOptions write;
  write.bits = header.bits > 8 && PictureBits(request.output, {.bits = 16}) == 16 ? 16 : 8;
  SCUMBLE_RETURN_IF_ERROR(WritePicture(request.output, rectified.picture, write));
  if (kit > 0 && kit != options.size) {
    globals.Warn(fmt::format("{} has {} pixels and the kit's {} {}: the style there will refuse it; take --size {}",
                             request.output, options.size, guides->string(), kit, kit));
  }
  for (const std::string& warning : rectified.report.warnings) globals.Warn(request.scan + ": " + warning);
  if (globals.json) {
    Print(JsonText(ReportJson(rectified.report, request.output, options.size, options.white_balance)));
  } else {
    Print(request.output + "\n" + ReportText(rectified.report, options.size));
  }
  return ExitCode::kOk;
}

}  // namespace scumble
