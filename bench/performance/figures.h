// What the bench found: figures with their targets, for the table that bench/performance.py makes of them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/performance/repeats.h"

namespace scumble::bench {

// One line of the table.
struct Figure {
  std::string item;   // of the list of targets: "1" … "8"
  std::string what;   // "engine against the yardstick"
  std::string frame;  // "toys 1920×1080"
  std::string unit;   // "×", "ns/px", "frames/s", "bytes/px", "%"
  Spread value;
  std::optional<double> target;
  bool at_least = false;  // whether the target is the least that is wanted, or the most
  std::string note = {};
  std::vector<std::pair<std::string, double>> more =
      {};  // further values by name, for the chart and for who reads the JSON
};

// Collects figures and says on stderr what is being measured.
class Report {
 public:
  void Say(const std::string& text) const;
  void Add(Figure figure);
  // Facts that belong to no line: what a frame is, how quiet the machine was.
  void Note(std::string text) { notes_.push_back(std::move(text)); }
  std::string ToJson() const;

 private:
  std::vector<Figure> figures_;
  std::vector<std::string> notes_;
};

// A value that has no spread.
Spread Exactly(double value);

}  // namespace scumble::bench
