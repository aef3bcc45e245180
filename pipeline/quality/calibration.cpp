#include "pipeline/quality/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/image/check.h"
#include "core/image/hash.h"

namespace scumble {
namespace {

using Runs = std::vector<double>;

double Median(Runs runs) {
  std::sort(runs.begin(), runs.end());
  const std::size_t half = runs.size() / 2;
  return runs.size() % 2 ? runs[half] : 0.5 * (runs[half - 1] + runs[half]);
}

// What is kept between runs.
struct Known {
  std::map<std::string, Runs> ways;
  std::map<std::string, double> off;  // of ways that had rivals; infinity where it cannot be known
  std::string off_of;                 // Calibration::judged
  double cold_ms = 0.0;
};

// One fact a line: a word, then numbers, then a text up to the line's end.
constexpr std::string_view kCircumstances = "circumstances", kCold = "cold_ms", kOffOf = "off_of", kRuns = "runs",
                           kOff = "off";

std::string OneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string ToText(const Known& known, const std::string& circumstances) {
  std::string text = fmt::format("{} {}\n{} {}\n{} {}\n", kCircumstances, OneLine(circumstances), kCold, known.cold_ms,
                                 kOffOf, OneLine(known.off_of));
  for (const auto& [name, runs] : known.ways) {
    if (!runs.empty()) text += fmt::format("{} {} {} {}\n", kRuns, runs.size(), fmt::join(runs, " "), name);
  }
  for (const auto& [name, off] : known.off) text += fmt::format("{} {} {}\n", kOff, off, name);
  return text;
}

// The next number of a line, 0 or more; infinity is one.
bool ReadNumber(std::istringstream& line, double& number) {
  std::string word;
  if (!(line >> word)) return false;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), number);
  return failure == std::errc() && end == word.data() + word.size() && number >= 0.0;
}

std::string RestOf(std::istringstream& line) {
  std::string text;
  std::getline(line, text);
  return text.empty() ? text : text.substr(1);
}

// Nothing where the text is not ours, or is of other circumstances: keys are hashes.
std::optional<Known> ParseTimes(std::span<const std::byte> bytes, const std::string& circumstances) {
  std::istringstream text(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  Known known;
  bool same = false, cold = false;
  for (std::string one; std::getline(text, one);) {
    std::istringstream line(one);
    std::string word;
    line >> word;
    double number = 0.0;
    if (word == kCircumstances) {
      same = RestOf(line) == OneLine(circumstances);
    } else if (word == kCold) {
      cold = ReadNumber(line, known.cold_ms) && std::isfinite(known.cold_ms);
    } else if (word == kOffOf) {
      known.off_of = RestOf(line);
    } else if (word == kRuns) {
      if (!ReadNumber(line, number) || number > kCalibrationRuns) return std::nullopt;
      Runs runs(static_cast<std::size_t>(number));
      for (double& ms : runs) {
        if (!ReadNumber(line, ms) || !std::isfinite(ms)) return std::nullopt;
      }
      known.ways[RestOf(line)] = std::move(runs);
    } else if (word == kOff) {
      if (!ReadNumber(line, number)) return std::nullopt;
      known.off[RestOf(line)] = number;
    } else {
      return std::nullopt;
    }
  }
  return same && cold ? std::optional(std::move(known)) : std::nullopt;
}

class Picker {
 public:
  Picker(const Calibration& calibration, double budget_ms, const MeasureWay& measure, const JudgeWay& judge)
      : calibration_(calibration),
        budget_ms_(budget_ms),
        measure_(measure),
        judge_(judge),
        runs_(calibration.ways.size()),
        kept_(calibration.ways.size()),
        off_(calibration.ways.size()) {}

  void Load() {
    if (!calibration_.cache || calibration_.anew) return;
    const auto bytes = calibration_.cache->Load(Key());
    if (!bytes) return;
    const std::optional<Known> known = ParseTimes(*bytes, calibration_.circumstances);
    if (!known) return;
    cold_ms_ = known->cold_ms;
    for (std::size_t way = 0; way < runs_.size(); ++way) {
      const auto found = known->ways.find(calibration_.ways[way]);
      if (found != known->ways.end()) runs_[way] = found->second, kept_[way] = runs_[way].size();
      const auto off = known->off.find(calibration_.ways[way]);
      if (off != known->off.end() && known->off_of == calibration_.judged) off_[way] = off->second;
    }
  }

  void Store() const {
    if (!calibration_.cache || (measured_ == 0 && judged_.empty()) || !cold_ms_) return;
    // Another process may have measured other ways meanwhile, or all of them anew: only what was found out here joins what is kept.
    Known known;
    known.cold_ms = *cold_ms_;
    if (const auto bytes = calibration_.cache->Load(Key()); bytes && !calibration_.anew) {
      if (const auto other = ParseTimes(*bytes, calibration_.circumstances)) {
        known = *other;
        if (warmed_up_) known.cold_ms = *cold_ms_;
      }
    }
    if (known.off_of != calibration_.judged) known.off.clear();
    known.off_of = calibration_.judged;
    for (std::size_t way = 0; way < runs_.size(); ++way) {
      const std::string& name = calibration_.ways[way];
      Runs& runs = known.ways[name];
      for (std::size_t run = kept_[way]; run < runs_[way].size() && runs.size() < std::size_t(kCalibrationRuns); ++run) {
        runs.push_back(runs_[way][run]);
      }
    }
    for (const std::size_t way : judged_) known.off[calibration_.ways[way]] = *off_[way];
    const std::string text = ToText(known, calibration_.circumstances);
    calibration_.cache->Store(Key(), std::as_bytes(std::span(text)));
  }

  Expected<PickedWay> Pick() {
    for (std::size_t way = 0; way < runs_.size(); ++way) {
      SCUMBLE_ASSIGN(const bool fits, Fits(way));
      if (fits) return NearerOf(way);
    }
    // What was given up at its first run may have been slow by chance: the least of its runs says how quick it can be.
    const auto least = [](const Runs& runs) { return *std::min_element(runs.begin(), runs.end()); };
    const auto quickest =
        std::min_element(runs_.begin(), runs_.end(), [&](const Runs& a, const Runs& b) { return least(a) < least(b); });
    const auto way = static_cast<std::size_t>(quickest - runs_.begin());
    // What is far over the budget will not fit, however often it is run.
    const bool hopeless = least(runs_[way]) > 2.0 * budget_ms_;
    const auto wanted = static_cast<std::size_t>(hopeless ? kHopelessRuns : kCalibrationRuns);
    while (runs_[way].size() < wanted) SCUMBLE_RETURN_IF_ERROR(RunOnce(way));
    return Picked(way, false);
  }

 private:
  std::string Key() const { return fmt::format("{:016x}", HashText(calibration_.circumstances)); }

  double Predicted(std::size_t way) const { return PredictedMs(runs_[way], cold_ms_.value_or(0.0)); }
  PickedWay Picked(std::size_t way, bool fits) const { return {way, Predicted(way), fits, measured_, {}}; }

  // Of a way that fits and its rival, if there is one that does.
  Expected<PickedWay> NearerOf(std::size_t way) {
    const auto found = calibration_.rivals.find(way);
    if (found == calibration_.rivals.end()) return Picked(way, true);
    const std::size_t rival = found->second;
    SCUMBLE_CHECK(rival > way && rival < runs_.size());
    SCUMBLE_ASSIGN(const bool fits, Fits(rival));
    if (!fits) return Picked(way, true);
    for (const std::size_t one : {way, rival}) {
      if (off_[one]) continue;
      SCUMBLE_ASSIGN(off_[one], judge_(one));
      judged_.push_back(one);
    }
    const bool known = std::isfinite(*off_[way]) && std::isfinite(*off_[rival]);
    if (!known) return Picked(way, true);
    PickedWay picked = Picked(*off_[rival] < *off_[way] ? rival : way, true);
    picked.compared = {{way, *off_[way]}, {rival, *off_[rival]}};
    return picked;
  }

  Expected<bool> Fits(std::size_t way) {
    const Runs& runs = runs_[way];
    const auto too_slow = [&] {
      return std::any_of(runs.begin(), runs.end(), [&](double ms) { return ms > budget_ms_; });
    };
    while (!too_slow() && runs.size() < std::size_t(kCalibrationRuns)) SCUMBLE_RETURN_IF_ERROR(RunOnce(way));
    return !too_slow() && Predicted(way) <= budget_ms_;
  }

  Status RunOnce(std::size_t way) {
    if (!cold_ms_) {
      SCUMBLE_RETURN_IF_ERROR(WarmUp());
    } else if (measured_ == 0) {
      SCUMBLE_RETURN_IF_ERROR(measure_(runs_.size() - 1));  // this process is cold, too
    }
    return Measure(way);
  }

  Status WarmUp() {
    const std::size_t last = runs_.size() - 1;
    SCUMBLE_ASSIGN(const double cold, measure_(last));
    SCUMBLE_RETURN_IF_ERROR(Measure(last));
    SCUMBLE_RETURN_IF_ERROR(Measure(last));
    warmed_up_ = true;
    cold_ms_ = std::max(0.0, cold - std::max(runs_[last][0], runs_[last][1]));
    return Ok();
  }

  Status Measure(std::size_t way) {
    SCUMBLE_ASSIGN(const double ms, measure_(way));
    runs_[way].push_back(ms);
    ++measured_;
    return Ok();
  }

  const Calibration& calibration_;
  const double budget_ms_;
  const MeasureWay& measure_;
  const JudgeWay& judge_;
  std::vector<Runs> runs_;                  // by way
  std::vector<std::size_t> kept_;           // likewise: how many of them were known
  std::vector<std::optional<double>> off_;  // likewise, of those that were judged
  std::vector<std::size_t> judged_;         // ways, now
  std::optional<double> cold_ms_;
  bool warmed_up_ = false;  // now
  int measured_ = 0;
};

}  // namespace

double PredictedMs(std::span<const double> runs_ms, double cold_ms) {
  if (runs_ms.empty()) return std::numeric_limits<double>::infinity();
  const double slowest = *std::max_element(runs_ms.begin(), runs_ms.end());
  return slowest + (slowest - Median({runs_ms.begin(), runs_ms.end()})) + cold_ms;
}

Expected<PickedWay> PickWay(const Calibration& calibration, double budget_ms, const MeasureWay& measure,
                            const JudgeWay& judge) {
  SCUMBLE_CHECK(!calibration.ways.empty());
  SCUMBLE_CHECK(judge || calibration.rivals.empty());
  Picker picker(calibration, budget_ms, measure, judge);
  picker.Load();
  Expected<PickedWay> picked = picker.Pick();
  picker.Store();
  return picked;
}

}  // namespace scumble
