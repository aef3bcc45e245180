// Measures the transfer against the targets of docs/performance.md and prints figures as JSON; bench/performance.py
// makes the table. `--help` lists the choices. It gates nothing, but stops if the engine's picture is not the
// yardstick's.
#include "bench/performance/performance.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>

namespace scumble::bench {
namespace {

using Part = void (*)(const PerformanceOptions&, Report&);

struct NamedPart {
  const char* name;
  Part measure;
};

constexpr NamedPart kParts[] = {{"yardstick", MeasureYardstick},    {"rates", MeasureFrameRates},
                                {"radius", MeasureRadius},          {"extensions", MeasureExtensions},
                                {"light-paths", MeasureLightPaths}, {"sizes", MeasureSizes}};

// Everything once, at sizes that take a second: a test that it runs, not a measurement.
PerformanceOptions SmokeOptions() {
  PerformanceOptions options;
  options.sizes = {{160, 90}};
  options.light_size = {64, 36};
  options.light_samples = 1;
  options.megapixels = {0.01, 0.02};
  options.repeats = {0.0, 1, 1, 0.0, 1};
  return options;
}

int Run(int argc, char** argv) {
  CLI::App app("The transfer's speed against its targets; prints JSON.");
  std::vector<std::string> only;
  std::string memory;
  bool smoke = false, edge_aware = false, one_size = false;
  PerformanceOptions chosen;
  std::vector<std::string> names{"memory"};
  for (const NamedPart& part : kParts) names.push_back(part.name);
  app.add_option("--only", only, "parts to measure; left out: all")->check(CLI::IsMember(names))->delimiter(',');
  app.add_option("--seconds", chosen.repeats.seconds, "about how long the rounds of one group may take")
      ->check(CLI::PositiveNumber);
  app.add_option("--rounds", chosen.repeats.most_rounds, "the most rounds of a group")->check(CLI::Range(1, 1000));
  app.add_flag("--hd", one_size, "the yardstick at 1920×1080 alone");
  app.add_flag("--smoke", smoke, "everything once at small sizes, to see that it runs");
  app.add_option("--memory", memory, "print bytes a pixel of one transfer of WIDTHxHEIGHT, and stop");
  app.add_flag("--edge-aware", edge_aware, "for --memory: with the edge test");
  CLI11_PARSE(app, argc, argv);

  int width = 0, height = 0;
  if (!memory.empty()) {
    if (std::sscanf(memory.c_str(), "%dx%d", &width, &height) == 2 && width > 0 && height > 0) {
      return PrintMemory(width, height, edge_aware);
    }
    std::fprintf(stderr, "--memory %s: expected WIDTHxHEIGHT\n", memory.c_str());
    return 2;
  }
  PerformanceOptions options = smoke ? SmokeOptions() : chosen;
  if (one_size) options.sizes.resize(1);
  options.repeats.least_rounds = std::min(options.repeats.least_rounds, options.repeats.most_rounds);
  const auto wanted = [&](const std::string& name) {
    return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
  };
  Report report;
  for (const NamedPart& part : kParts) {
    if (wanted(part.name)) part.measure(options, report);
  }
  if (wanted("memory")) MeasureMemory(std::filesystem::read_symlink("/proc/self/exe").string(), options, report);
  std::fputs(report.ToJson().c_str(), stdout);
  return 0;
}

}  // namespace
}  // namespace scumble::bench

int main(int argc, char** argv) { return scumble::bench::Run(argc, argv); }
