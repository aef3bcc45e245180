// How long each variant takes to paint a frame on this machine, and which is the most accurate that fits into a budget.
//
// A variant is run kCalibrationRuns times. If runs are alike, whatever their distribution, one more is slower than the
// slowest of nine in one case of ten. One frame of twenty may miss its budget, and two things make later runs slower
// than those, so two margins are added.
//   - The machine is busier at another moment: twice the slowest run's distance from the median, which is nothing on a
//     quiet machine and much on a busy one.
//   - A process has just begun: its first run wakes threads and touches memory. What that costs is measured once, by
//     one quick variant, and added.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "transfer/table_cache.h"

namespace scumble {

inline constexpr int kCalibrationRuns = 9;
inline constexpr int kHopelessRuns = 3;  // of the quickest, where even that is over twice the budget

struct Calibration {
  // Everything that times depend on, but for the variants themselves: machine, program, scene, style, size.
  std::string circumstances;
  std::vector<std::string> variants;  // by options, the most accurate first; at least one
  TableCache* cache = nullptr;        // where times are kept between runs; null: nowhere
  bool anew = false;                  // what is kept does not count
  std::size_t cold = 0;               // the place of a quick variant, by which a cold start is measured
};

// Milliseconds that a variant takes once; by its place in Calibration::variants.
using MeasureVariant = std::function<Expected<double>(std::size_t variant)>;

struct PickedVariant {
  std::size_t variant = 0;    // its place in Calibration::variants
  double predicted_ms = 0.0;  // nineteen frames of twenty take no longer
  bool fits = false;          // otherwise it is the quickest there is
  int measured = 0;           // runs that were made for it now; 0: all times were known
};

// What is predicted from times of equal runs, where the first run of a process takes `cold_ms` longer; infinity without
// any.
double PredictedMs(std::span<const double> runs_ms, double cold_ms);

// The first of the variants whose predicted time is within the budget; where none fits, the quickest.
//
// A variant is dropped at its first run beyond the budget: what is too slow costs one run. The very first run is one of
// Calibration::cold, and is compared with the slower of two more. What was kept and makes no sense is measured again.
// Fails as `measure` does.
Expected<PickedVariant> PickVariant(const Calibration& calibration, double budget_ms, const MeasureVariant& measure);

}  // namespace scumble
