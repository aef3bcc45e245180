#include <malloc.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/or_stop.h"
#include "bench/performance/performance.h"

namespace scumble::bench {
namespace {

// Sides of a picture of 16 : 9.
std::pair<int, int> SidesOf(double megapixels) {
  const double height = std::sqrt(megapixels * 1e6 * 9.0 / 16.0);
  return {static_cast<int>(std::lround(height * 16.0 / 9.0)), static_cast<int>(std::lround(height))};
}

// Kilobytes of a line of /proc/self/status; 0 where there is none.
double StatusKilobytes(const std::string& name) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(name + ":")) return std::stod(line.substr(name.size() + 1));
  }
  return 0.0;
}

// One line of JSON from another process; null if it failed.
nlohmann::json AskProcess(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return {};
  std::string text(4096, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), pipe));
  return pclose(pipe) == 0 ? nlohmann::json::parse(text, nullptr, false) : nlohmann::json();
}

}  // namespace

void MeasureSizes(const PerformanceOptions& options, Report& report) {
  const auto frame_of = [](double megapixels) {
    const auto [width, height] = SidesOf(megapixels);
    return HillsFrame(width, height, false);
  };
  const Frame first = frame_of(options.megapixels.front());
  Engine small(PlainStyle(), first.guides.height());
  RepeatOptions repeats = options.repeats;
  repeats.least_rounds = std::min(3, repeats.least_rounds);
  for (std::size_t k = 1; k < options.megapixels.size(); ++k) {
    const Frame frame = frame_of(options.megapixels[k]);
    report.Say("linear: " + frame.name);
    Engine large(PlainStyle(), frame.guides.height());
    const std::function<void()> contestants[] = {Painting(small, first), Painting(large, frame)};
    const std::vector<Times> times = TakeTurns(contestants, repeats);
    const double more = static_cast<double>(first.covered) / static_cast<double>(frame.covered);
    const auto ns = [&](const Times& taken, const Frame& of) {
      return taken.Milliseconds(Clock::kThread).median * 1e6 / static_cast<double>(of.covered);
    };
    std::optional<double> target;
    if (k + 1 == options.megapixels.size()) target = 1.15;
    report.Add({"5",
                "time a pixel against that of " + first.name,
                frame.name,
                "×",
                Ratio(times[1], times[0], Clock::kThread, more),
                target,
                false,
                {},
                {{"megapixels", options.megapixels[k]},
                 {"ns", ns(times[1], frame)},
                 {"first_megapixels", options.megapixels.front()},
                 {"first_ns", ns(times[0], first)}}});
  }
}

// Guides, picture and the transfer's other memory, at its peak, less the memory of the process and the style before.
int PrintMemory(int width, int height, bool edge_aware) {
  Style style = PlainStyle();
  style.transfer.edge_aware = edge_aware;
  Engine engine(style, height, 2);
  style = {};
  const Frame one = HillsFrame(16, 9, true);  // threads and their pools exist before memory is counted
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // resets the peak to the present value
  const double before = StatusKilobytes("VmRSS");
  const Frame frame = HillsFrame(width, height, true);
  const double guides = StatusKilobytes("VmRSS");
  engine.Paint(frame);
  engine.Paint(frame);
  const double peak = StatusKilobytes("VmHWM");
  const double per_pixel = 1024.0 / static_cast<double>(frame.covered);
  std::printf("{\"peak\": %.2f, \"guides\": %.2f}\n", (peak - before) * per_pixel, (guides - before) * per_pixel);
  return before > 0.0 && peak > guides ? 0 : 1;
}

void MeasureMemory(const std::string& program, const PerformanceOptions& options, Report& report) {
  for (const bool edge_aware : {false, true}) {
    const auto [width, height] = SidesOf(options.megapixels.back());
    const std::string name = "hills " + std::to_string(width) + "×" + std::to_string(height);
    report.Say("memory: " + name);
    const nlohmann::json found = AskProcess("'" + program + "' --memory " + std::to_string(width) + "x" +
                                            std::to_string(height) + (edge_aware ? " --edge-aware" : ""));
    if (!found.is_object()) {
      report.Note("memory of " + name + " could not be measured");
      continue;
    }
    const double guides = found["guides"];
    report.Add({"5", std::string("peak memory") + (edge_aware ? ", edge-aware" : ""), name, "bytes/px",
                Exactly(found["peak"]), 64.0, false,
                "guides as they are always written are " + std::to_string(int(std::lround(guides))) + " of it"});
  }
}

}  // namespace scumble::bench
