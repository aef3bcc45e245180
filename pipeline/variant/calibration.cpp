#include "pipeline/variant/calibration.h"

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
  std::map<std::string, Runs> variants;
  double cold_ms = 0.0;
};

// One fact a line: a word, then numbers, then a text up to the line's end.
constexpr std::string_view kCircumstances = "circumstances", kCold = "cold_ms", kRuns = "runs";

std::string OneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string ToText(const Known& known, const std::string& circumstances) {
  std::string text = fmt::format("{} {}\n{} {}\n", kCircumstances, OneLine(circumstances), kCold, known.cold_ms);
  for (const auto& [name, runs] : known.variants) {
    if (!runs.empty()) text += fmt::format("{} {} {} {}\n", kRuns, runs.size(), fmt::join(runs, " "), name);
  }
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
    } else if (word == kRuns) {
      if (!ReadNumber(line, number) || number > kCalibrationRuns) return std::nullopt;
      Runs runs(static_cast<std::size_t>(number));
      for (double& ms : runs) {
        if (!ReadNumber(line, ms) || !std::isfinite(ms)) return std::nullopt;
      }
      known.variants[RestOf(line)] = std::move(runs);
    } else {
      return std::nullopt;
    }
  }
  return same && cold ? std::optional(std::move(known)) : std::nullopt;
}

class Picker {
 public:
  Picker(const Calibration& calibration, double budget_ms, const MeasureVariant& measure)
      : calibration_(calibration),
        budget_ms_(budget_ms),
        measure_(measure),
        runs_(calibration.variants.size()),
        kept_(calibration.variants.size()) {}

  void Load() {
    if (!calibration_.cache || calibration_.anew) return;
    const auto bytes = calibration_.cache->Load(Key());
    if (!bytes) return;
    const std::optional<Known> known = ParseTimes(*bytes, calibration_.circumstances);
    if (!known) return;
    cold_ms_ = known->cold_ms;
    for (std::size_t variant = 0; variant < runs_.size(); ++variant) {
      const auto found = known->variants.find(calibration_.variants[variant]);
      if (found != known->variants.end()) runs_[variant] = found->second, kept_[variant] = runs_[variant].size();
    }
  }

  void Store() const {
    if (!calibration_.cache || measured_ == 0 || !cold_ms_) return;
    // Another process may have measured other variants meanwhile, or all of them anew: only what was found out here
    // joins what is kept.
    Known known;
    known.cold_ms = *cold_ms_;
    if (const auto bytes = calibration_.cache->Load(Key()); bytes && !calibration_.anew) {
      if (const auto other = ParseTimes(*bytes, calibration_.circumstances)) {
        known = *other;
        if (warmed_up_) known.cold_ms = *cold_ms_;
      }
    }
    for (std::size_t variant = 0; variant < runs_.size(); ++variant) {
      const std::string& name = calibration_.variants[variant];
      Runs& runs = known.variants[name];
      for (std::size_t run = kept_[variant]; run < runs_[variant].size() && runs.size() < std::size_t(kCalibrationRuns);
           ++run) {
        runs.push_back(runs_[variant][run]);
      }
    }
    const std::string text = ToText(known, calibration_.circumstances);
    calibration_.cache->Store(Key(), std::as_bytes(std::span(text)));
  }

  Expected<PickedVariant> Pick() {
    for (std::size_t variant = 0; variant < runs_.size(); ++variant) {
      SCUMBLE_ASSIGN(const bool fits, Fits(variant));
      if (fits) return Picked(variant, true);
    }
    // What was dropped at its first run may have been slow by chance: the least of its runs says how quick it can be.
    const auto least = [](const Runs& runs) { return *std::min_element(runs.begin(), runs.end()); };
    const auto quickest =
        std::min_element(runs_.begin(), runs_.end(), [&](const Runs& a, const Runs& b) { return least(a) < least(b); });
    const auto variant = static_cast<std::size_t>(quickest - runs_.begin());
    // What is far over the budget will not fit, however often it is run.
    const bool hopeless = least(runs_[variant]) > 2.0 * budget_ms_;
    const auto wanted = static_cast<std::size_t>(hopeless ? kHopelessRuns : kCalibrationRuns);
    while (runs_[variant].size() < wanted) SCUMBLE_RETURN_IF_ERROR(RunOnce(variant));
    return Picked(variant, false);
  }

 private:
  std::string Key() const { return fmt::format("{:016x}", HashText(calibration_.circumstances)); }

  double Predicted(std::size_t variant) const { return PredictedMs(runs_[variant], cold_ms_.value_or(0.0)); }
  PickedVariant Picked(std::size_t variant, bool fits) const { return {variant, Predicted(variant), fits, measured_}; }

  Expected<bool> Fits(std::size_t variant) {
    const Runs& runs = runs_[variant];
    const auto too_slow = [&] {
      return std::any_of(runs.begin(), runs.end(), [&](double ms) { return ms > budget_ms_; });
    };
    while (!too_slow() && runs.size() < std::size_t(kCalibrationRuns)) SCUMBLE_RETURN_IF_ERROR(RunOnce(variant));
    return !too_slow() && Predicted(variant) <= budget_ms_;
  }

  Status RunOnce(std::size_t variant) {
    if (!cold_ms_) {
      SCUMBLE_RETURN_IF_ERROR(WarmUp());
    } else if (measured_ == 0) {
      SCUMBLE_RETURN_IF_ERROR(measure_(calibration_.cold));  // this process is cold, too
    }
    return Measure(variant);
  }

  Status WarmUp() {
    const std::size_t one = calibration_.cold;
    SCUMBLE_ASSIGN(const double cold, measure_(one));
    SCUMBLE_RETURN_IF_ERROR(Measure(one));
    SCUMBLE_RETURN_IF_ERROR(Measure(one));
    warmed_up_ = true;
    cold_ms_ = std::max(0.0, cold - std::max(runs_[one][0], runs_[one][1]));
    return Ok();
  }

  Status Measure(std::size_t variant) {
    SCUMBLE_ASSIGN(const double ms, measure_(variant));
    runs_[variant].push_back(ms);
    ++measured_;
    return Ok();
  }

  const Calibration& calibration_;
  const double budget_ms_;
  const MeasureVariant& measure_;
  std::vector<Runs> runs_;         // by variant
  std::vector<std::size_t> kept_;  // likewise: how many of them were known
  std::optional<double> cold_ms_;
  bool warmed_up_ = false;  // now
  int measured_ = 0;
};

}  // namespace

double PredictedMs(std::span<const double> runs_ms, double cold_ms) {
  if (runs_ms.empty()) return std::numeric_limits<double>::infinity();
  const double slowest = *std::max_element(runs_ms.begin(), runs_ms.end());
  return slowest + 2.0 * (slowest - Median({runs_ms.begin(), runs_ms.end()})) + cold_ms;
}

Expected<PickedVariant> PickVariant(const Calibration& calibration, double budget_ms, const MeasureVariant& measure) {
  SCUMBLE_CHECK(calibration.cold < calibration.variants.size());
  Picker picker(calibration, budget_ms, measure);
  picker.Load();
  Expected<PickedVariant> picked = picker.Pick();
  picker.Store();
  return picked;
}

}  // namespace scumble
