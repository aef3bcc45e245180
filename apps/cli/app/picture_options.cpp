#include "apps/cli/app/picture_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>
#include <vector>

#include "measure/explain.h"
#include "pipeline/finish_layers.h"
#include "pipeline/frame_range.h"
#include "transfer/upsample_guides.h"

namespace scumble {

std::string ShownFinish(const std::string& show) {
  return show.rfind(kShowFinish, 0) == 0 ? show.substr(std::string_view(kShowFinish).size()) : "";
}

void AddShowOptions(CLI::App& verb, std::string& show, std::string& layers_out, bool explanations) {
  const std::string of_finish =
      "finish:NAME, what the finishing effect of that name does alone: its ink, or the picture after it";
  const std::vector<std::string> names = explanations ? ExplanationNames() : std::vector<std::string>();
  const auto check = [names](std::string& text) -> std::string {
    const bool is_known = !ShownFinish(text).empty() || std::find(names.begin(), names.end(), text) != names.end();
    return is_known
               ? ""
               : fmt::format("{}: expected {}{}finish:NAME", text, fmt::join(names, ", "), names.empty() ? "" : " or ");
  };
  verb.add_option("--show", show,
                  explanations ? "write a picture that explains the result instead of it: where the paint comes from "
                                 "(sources), the chunks and their borders (chunks, borders), their size (levels), the "
                                 "guide error (error), which exemplar (exemplar), which style (styles); or " +
                                     of_finish
                               : "write another picture instead of the result: " + of_finish)
      ->type_name("WHAT")
      ->check(
          CLI::Validator(check, fmt::format("{{{}{}finish:NAME}}", fmt::join(names, ","), names.empty() ? "" : ",")));
  verb.add_option("--layers-out", layers_out,
                  "also write the layers of the finish, for Krita, GIMP and MyPaint: paper, paint, and each effect, "
                  "lines as ink alone: .ora")
      ->type_name("FILE");
}

void AddPictureOptions(CLI::App& verb, PictureOptions& options, bool needed) {
  auto* output = verb.add_option("-o,--output", options.request.output,
                                 std::string("picture to write: .png, .tif, .exr or .jpg") +
                                     (needed ? "" : "; required unless --explain is given"));
  output->type_name("FILE");
  if (needed) output->required();
  verb.add_option("--over", options.request.over, "picture to composite over, of the same size")->type_name("FILE");
  verb.add_option("--bits", options.request.bits,
                  "bits a channel: 8 or 16 for .png and .tif; .exr takes 16, half floats, or 32, floats")
      ->type_name("N")
      ->check(CLI::IsMember({8, 16, 32}))
      ->capture_default_str();
  verb.add_option("--png-level", options.request.png_level, "PNG compression, 0 fast to 9 small")
      ->type_name("N")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
  AddFastIoOption(verb, options.request.fast_io);
  verb.add_option(
          "--frame", options.request.frame,
          "frame number, for jitter_fps, for keys of the style that change over time, and of a scene "
          "that moves; left out: 0, of a .blend the frame that it was saved at, of glTF the nodes as they stand")
      ->type_name("N");
  AddFpsOption(verb, options.fps,
               "frames a second, as 24 or 24000/1001, for jitter_fps, and of a glTF animation: frame N is at "
               "N / RATE s; left out: of a .blend its own, otherwise 24");
  verb.add_option("--exposure", options.exposure,
                  "stops by which the scene's light is brightened for styles of several exemplars or with weights for "
                  "light; auto fits it to the brightest exemplar and prints the stops that repeat it")
      ->type_name("auto|STOPS")
      ->capture_default_str();
  verb.add_option(
          "--seed", options.request.seed,
          "another seed, another pattern: where chunks begin, what paint flat surfaces, shadows and edges take, "
          "and the noise of a scene's area lights; the same seed, the same bytes")
      ->type_name("N")
      ->check(RefuseNegative)
      ->capture_default_str();
  AddShowOptions(verb, options.show, options.request.layers_out, true);
  verb.add_option(
          "--upsample", options.request.upsample,
          "the picture is N times as wide and high as the guides: they are quicker to make, and the paint has its "
          "full size")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxUpsampling))
      ->capture_default_str();
  verb.add_flag("--upscale", options.request.upscale,
                "with --upsample N: the picture is painted at the guides' size and scaled up, which is quicker still, "
                "and softer");
  verb.add_option("--repeat", options.request.repeat,
                  "times to run the transfer, to report the median time and its spread")
      ->type_name("N")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
}

Expected<PictureRequest> ToRequest(const PictureOptions& options, const Globals& globals) {
  PictureRequest request = options.request;
  SCUMBLE_ASSIGN(request.exposure, ParseExposure(options.exposure));
  if (!options.fps.empty()) {
    SCUMBLE_ASSIGN(request.fps, ParseFrameRate(options.fps));
  }
  request.show = FindExplanation(options.show);
  request.show_finish = ShownFinish(options.show);
  request.measure_chunks = globals.json;
  return request;
}

void AddSequenceOptions(CLI::App& verb, SequenceOptions& options) {
  verb.add_option("--frames", options.frames,
                  "several frames: 1-24; 3,5-10; 12-24x2, every second; 10-1, backwards; -5--1. #### or %04d in the "
                  "names of files stands for the frame's number")
      ->type_name("RANGE");
  verb.add_flag("--resume", options.resume,
                "with --frames: keep frames whose output is there, whole, and made with these settings; all others are "
                "made again");
}

Expected<SequenceRequest> ToRequest(const SequenceOptions& options) {
  SequenceRequest request;
  request.resume = options.resume;
  if (options.frames.empty()) return request;
  SCUMBLE_ASSIGN(request.frames, ParseFrames(options.frames));
  return request;
}

void AddBudgetOptions(CLI::App& verb, BudgetOptions& options, bool casts) {
  const std::string smaller = casts ? "pictures scaled up, smaller guides, fewer samples, " : "";
  const std::string wins =
      std::string("--set") + (casts ? ", --upsample and --samples" : " and --upsample") + " win over it";
  verb.add_option("--quality", options.quality,
                  "final: the style as it is; preview and draft take less time where there is much to take, by " +
                      smaller + "less blending; what is taken is printed as options that repeat it. " + wins)
      ->type_name("NAME")
      ->check(CLI::IsMember(QualityNames()));
  verb.add_option(
          "--budget-ms", options.request.budget_ms,
          std::string("milliseconds that ") + (casts ? "the guides and the transfer" : "the transfer") +
              " of one picture may take, without start-up, reading, preparing the style and writing: of a dozen "
              "variants, ordered by how far their paint looks from the exemplar's, the first that fits is taken, by "
              "times that are measured once on this machine and kept in the user's cache folder; one variant for all "
              "frames; the options that repeat it are printed. " +
              wins)
      ->type_name("N")
      ->check(RefuseNoAmount("milliseconds, as 40"));
  verb.add_flag("--recalibrate", options.request.recalibrate, "with --budget-ms: measure anew");
}

Expected<BudgetRequest> ToRequest(const CLI::App& verb, const BudgetOptions& options) {
  BudgetRequest request = options.request;
  request.guides_are_fixed = verb.count("--upsample") > 0;  // and --upscale with it
  request.quality = FindQuality(options.quality);
  if (request.chooses() && !request.guides_are_fixed && verb.count("--upscale") > 0) {
    return UsageError("--upscale: --quality and --budget-ms choose it themselves; leave it out, or give --upsample N");
  }
  if (request.quality && request.budget_ms > 0) {
    return UsageError("--quality " + options.quality + " and --budget-ms exclude each other: give one of them");
  }
  if (request.recalibrate && !(request.budget_ms > 0)) {
    return UsageError("--recalibrate is for --budget-ms: give both, or leave it out");
  }
  return request;
}

}  // namespace scumble
