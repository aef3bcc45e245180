// --timing: where a run's time went, from the start of the process to its report.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/app/command.h"

namespace scumble {

// One line of the table.
struct Stage {
  std::string name;
  double wall_ms = 0;            // summed over frames
  std::optional<double> cpu_ms;  // of all threads of the process, none where only the wall's clock was read
};

// Collects what stages cost. Not thread-safe: told by the thread that runs the verb.
class Timing {
 public:
  // Its first stage, "start", is what is over already: loading the program and its libraries, up to here. Its wall time is
  // known to a tick of the kernel, 10 ms; 0 where the system does not tell.
  Timing();

  // Ends what has run since the last call: as the stages of `inside`, which took that many milliseconds of the wall's clock, and
  // under `name` what is left of it. Processor time is known for all of it together, and stands with `name`.
  void End(const std::string& name, const std::vector<std::pair<std::string, double>>& inside = {});
  // Of a stage that ran beside the others, on another thread.
  void Add(const std::string& name, double wall_ms);

  // The stages in the order they came up, then "total": from the start of the process until now.
  std::vector<Stage> Stages() const;
  std::string ToText() const;
  nlohmann::ordered_json ToJson() const;  // [{"stage": "start", "wall_ms": 4.2, "cpu_ms": 4.1}, …]

 private:
  Stage& At(const std::string& name);

  std::vector<Stage> stages_;
  double begun_wall_ms_ = 0;  // the process, on the wall's clock
  double last_wall_ms_ = 0, last_cpu_ms_ = 0;
};

// Timing::End, where --timing was given.
void EndStage(const Globals& globals, const std::string& name,
              const std::vector<std::pair<std::string, double>>& inside = {});

void AddTimingOption(CLI::App& verb, Globals& globals);

}  // namespace scumble
