// The time of each finishing effect at 1080p, as a ratio to a copy of the bytes that it reads and writes, in the same
// run and on the same threads. Before each, the caches are emptied. Prints the table of docs/finish.md; with --json the
// figures of bench/performance.py instead.
// Where OpenCV is installed (libopencv-imgproc-dev, libopencv-contrib-dev), its filters are timed, too.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>

#include "bench/finish/finish_reports.h"

namespace scumble::bench {
namespace {

int Run(int argc, char** argv) {
  CLI::App app("Times of finishing effects beside copies of their bytes and others' filters.");
  int runs = 9;
  std::string part;
  bool json = false, smoke = false;
  RepeatOptions repeats;
  app.add_option("runs", runs, "of each line of the table")->check(CLI::Range(1, 1000));
  app.add_option("name", part, "only work whose name has this in it");
  app.add_flag("--json", json, "print the figures that have targets as JSON");
  app.add_option("--seconds", repeats.seconds, "for --json: about how long the rounds of one group may take")
      ->check(CLI::PositiveNumber);
  app.add_option("--rounds", repeats.most_rounds, "for --json: the most rounds of a group")->check(CLI::Range(1, 1000));
  app.add_flag("--smoke", smoke, "everything once on a small picture, to see that it runs");
  CLI11_PARSE(app, argc, argv);
  if (smoke)
    runs = 1, repeats = {.seconds = 0.0, .least_rounds = 1, .most_rounds = 1, .turn_seconds = 0.0, .most_runs = 1};
  repeats.least_rounds = std::min(repeats.least_rounds, repeats.most_rounds);

  const auto fail = [](const Error& error) { return std::fprintf(stderr, "%s\n", error.message.c_str()), 3; };
  const auto work = smoke ? FinishWork::Make(160, 90) : FinishWork::Make(1920, 1080);
  if (!work) return fail(work.error());
  Report report;
  const Status done = json ? MeasureFinishRatios(*work, repeats, report) : PrintFinishTable(*work, runs, part);
  if (!done) return fail(done.error());
  if (json) std::fputs(report.ToJson().c_str(), stdout);
  return 0;
}

}  // namespace
}  // namespace scumble::bench

int main(int argc, char** argv) { return scumble::bench::Run(argc, argv); }
