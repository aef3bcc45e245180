// The measurements behind the ladder of --quality and --budget-ms: for sample scenes and bundled styles, time and
// texture of every cheaper variant, and the Pareto front of both. Prints one line a variant, tab-separated:
// docs/budget.md has the table. --help lists the arguments.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/or_stop.h"
#include "bench/performance/repeats.h"
#include "core/image/stopwatch.h"
#include "core/style/style_file.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "measure/tradeoff/pareto.h"
#include "pipeline/variant/variant_error.h"
#include "transfer/transfer.h"
#include "transfer/upsample_guides.h"

namespace scumble::bench {
namespace {

const std::string kSource = SCUMBLE_SOURCE_DIR;

constexpr std::array<int, 4> kUpsampling{1, 2, 4, 8};

struct Arguments {
  int width = 1280, height = 720, runs = 5;
  bool energy = false;
  std::vector<std::string> scenes{"suzanne", "stilllife", "toys"};
  std::vector<std::string> styles{"oil", "charcoal", "woodcut", "sumi-e", "chiaroscuro", "scene-oil"};
};

// The settings of a variant that replace the style's own.
struct Candidate {
  std::string name;
  int upsample = 1, upscale = 1;
  std::vector<std::string> settings;
};

// All combinations of cheaper settings that do not change the artist's choices of look.
std::vector<Candidate> Candidates(const Style& style, const Arguments& arguments) {
  const std::string less = "transfer.method=litsphere", crisp = "transfer.blend_radius=0";
  std::vector<Candidate> all;
  const bool splits = style.transfer.hybrid > 0.0;
  const auto add_all = [&](const std::string& name, int upsample, int upscale) {
    const auto add = [&](const std::string& what, std::vector<std::string> settings) {
      all.push_back({name + (name.empty() || what.empty() ? "" : ", ") + what, upsample, upscale, std::move(settings)});
    };
    add("", {});
    if (splits) add("hybrid 0", {"transfer.hybrid=0"});
    add("hybrid 0, radius 0", {"transfer.hybrid=0", crisp});
    add("litsphere", {less, "transfer.hybrid=0"});
    add("litsphere, radius 0", {less, "transfer.hybrid=0", crisp});
    if (upsample > 1 || upscale > 1) return;
    add("radius 0", {crisp});
    add("4 levels fewer", {fmt::format("transfer.levels={}", std::max(1, style.transfer.levels - 4))});
    add("match_step 4", {"transfer.match_step=4"});
  };
  for (const int factor : kUpsampling) {
    if (arguments.width % factor || arguments.height % factor) continue;
    add_all(factor > 1 ? fmt::format("upsample {}", factor) : "", factor, 1);
    if (factor > 1 && factor < 8) add_all(fmt::format("upsample {}, upscale", factor), 1, factor);
  }
  all.front().name = "the style";
  return all;
}

struct MadeGuides {
  GuideSet guides, small;  // upsampled, and as cast
  std::vector<double> ms, small_ms;
};

void Measure(const std::string& scene_name, const std::string& style_name, const Arguments& arguments) {
  const std::string folder = kSource + "/exemplars/" + style_name;
  Style style = OrStop(LoadStyle(folder));
  Scene scene = OrStop(LoadScene(kSource + "/scenes/" + scene_name + ".glb"));
  const PreparedView view =
      OrStop(PrepareView(scene, "", std::nullopt, double(arguments.width) / arguments.height, true));
  const std::vector<Candidate> candidates = Candidates(style, arguments);
  std::map<int, MadeGuides> guides;
  for (int run = 0; run <= arguments.runs; ++run) {
    for (const int factor : kUpsampling) {
      if (arguments.width % factor || arguments.height % factor) continue;
      GuidegenOptions options;
      options.width = arguments.width / factor, options.height = arguments.height / factor;
      options.layers = RequiredLayers(style);
      Stopwatch watch;
      GuideSet made = OrStop(RenderGuides(scene, view.camera, options)).guides;
      const double small_ms = watch.Lap();
      GuideSet large = factor > 1 ? OrStop(UpsampleGuides(made, factor)) : made;
      const double ms = small_ms + (factor > 1 ? watch.Lap() : 0.0);
      if (run > 0 || arguments.runs == 0) guides[factor].ms.push_back(ms), guides[factor].small_ms.push_back(small_ms);
      guides[factor].guides = std::move(large), guides[factor].small = std::move(made);
    }
  }
  std::vector<PreparedStyle> prepared;
  for (const Candidate& candidate : candidates) {
    Style one = OrStop(LoadStyle(folder, OrStop(ParseStyleOverrides(candidate.settings))));
    one.paper = {};
    prepared.push_back(OrStop(Prepare(one, arguments.height / candidate.upscale)));
  }
  TransferOptions options;
  options.exposure = MeasureExposure({prepared.data(), 1}, guides[1].guides).value_or(0.0);
  const TradeReference judge(std::make_shared<const GuideSet>(guides[1].guides), prepared.front(), options.exposure, 0);
  const GuidedTexture texture = OrStop(judge.Texture());
  std::vector<std::vector<double>> ms(candidates.size());
  std::vector<TradeMeasure> error(candidates.size());
  for (int run = 0; run <= arguments.runs;
       ++run) {  // in turns, so that other load of the machine affects all of them alike
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const Candidate& candidate = candidates[i];
      const int factor = candidate.upsample * candidate.upscale;
      const GuideSet& taken = candidate.upscale > 1 ? guides[factor].small : guides[factor].guides;
      TransferScratch scratch;
      Picture picture;
      Stopwatch watch;
      OrStop(Transfer(prepared[i], taken, options, scratch, picture));
      if (candidate.upscale > 1) picture = UpscalePicture(picture, candidate.upscale);
      if (run > 0 || arguments.runs == 0) ms[i].push_back(watch.Lap());
      if (run == 0) OrStop(judge.MeasureTexture(texture, picture, error[i]));
      if (run == 0 && arguments.energy) OrStop(judge.MeasurePaint(picture, nullptr, EnergyOptions(), error[i]));
    }
  }
  std::vector<TradePoint> whole, transfer_alone;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const MadeGuides& made = guides[candidates[i].upsample * candidates[i].upscale];
    const double painting = SpreadOf(ms[i]).median;
    const double casting = SpreadOf(candidates[i].upscale > 1 ? made.small_ms : made.ms).median;
    const double off = error[i].texture.value_or(NAN);
    whole.push_back({casting + painting, off});
    transfer_alone.push_back({candidates[i].upsample * candidates[i].upscale > 1 ? NAN : painting, off});
  }
  const auto on = [](const std::vector<std::size_t>& front, std::size_t i) {
    return std::find(front.begin(), front.end(), i) != front.end();
  };
  const std::vector<std::size_t> front = ParetoFront(whole), alone = ParetoFront(transfer_alone);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    std::fputs(
        fmt::format("{}\t{}\t{}\t{:.1f}\t{:.1f}\t{:.4f}\t{:.4f}\t{:.4f}\t{}\t{}\n", scene_name, style_name,
                    candidates[i].name, whole[i].time, SpreadOf(ms[i]).median, whole[i].error,
                    texture.floor().value_or(0.0), error[i].both.mean, on(front, i) ? "*" : "", on(alone, i) ? "*" : "")
            .c_str(),
        stdout);
  }
  std::fflush(stdout);
}

int Main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("time and texture of every way to do it with less");
  app.add_option("--width", arguments.width);
  app.add_option("--height", arguments.height);
  app.add_flag("--energy", arguments.energy, "also `both`, which takes long");
  app.add_option("--runs", arguments.runs);
  app.add_option("--scenes", arguments.scenes)->delimiter(',');
  app.add_option("--styles", arguments.styles)->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  std::puts(
      "scene\tstyle\tway\tguides and transfer, ms\ttransfer, ms\ttexture\thalves of the exemplar\tboth\tfront\tfront "
      "of "
      "transfer");
  for (const std::string& scene : arguments.scenes) {
    for (const std::string& style : arguments.styles) Measure(scene, style, arguments);
  }
  return 0;
}

}  // namespace
}  // namespace scumble::bench

int main(int argc, char** argv) { return scumble::bench::Main(argc, argv); }
