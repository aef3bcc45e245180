// The bench's results: figures with their targets, for the table of bench/performance.py.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/performance/repeats.h"

namespace scumble::bench {

// One line of the table.
struct Figure {
  std::string item;   // of the list of targets: "1" … "9"
  std::string what;   // "engine against the yardstick"
  std::string frame;  // "toys 1920×1080"
  std::string unit;   // "×", "ns/px", "ms", "frames/s", "bytes/px", "%"
  Spread value;
  std::optional<double> target;
  bool at_least = false;  // whether the target is a minimum or a maximum
  std::string note = {};
  // Further values by name, for the chart and for readers of the JSON.
  std::vector<std::pair<std::string, double>> more = {};
};

// Collects figures and reports progress on stderr.
class Report {
 public:
  void Say(const std::string& text) const;
  void Add(Figure figure);
  // Facts outside the lines: the frame, the load of the machine.
  void Note(std::string text) { notes_.push_back(std::move(text)); }
  std::string ToJson() const;

 private:
  std::vector<Figure> figures_;
  std::vector<std::string> notes_;
};

// A value that has no spread.
Spread Exactly(double value);

}  // namespace scumble::bench
