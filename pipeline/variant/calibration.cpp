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

double LeastOf(const Runs& runs) { return *std::min_element(runs.begin(), runs.end()); }

// What is kept between runs.
struct Known {
  std::map<std::string, Runs> variants;
  double cold_ms = 0.0;
  double picks = 0.0;  // that left variants out, as a count
};

// One fact a line: a word, then numbers, then a text up to the line's end.
constexpr std::string_view kCircumstances = "circumstances", kCold = "cold_ms", kPicks = "picks", kRuns = "runs";

std::string OneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string ToText(const Known& known, const std::string& circumstances) {
  std::string text = fmt::format("{} {}\n{} {}\n{} {}\n", kCircumstances, OneLine(circumstances), kCold, known.cold_ms,
                                 kPicks, known.picks);
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
    } else if (word == kPicks) {
      if (!ReadNumber(line, known.picks) || !std::isfinite(known.picks)) return std::nullopt;
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
        kept_(calibration.variants.size()),
        replaced_(calibration.variants.size()) {}

  void Load() {
    if (!calibration_.cache || calibration_.anew) return;
    const auto bytes = calibration_.cache->Load(Key());
    if (!bytes) return;
    const std::optional<Known> known = ParseTimes(*bytes, calibration_.circumstances);
    if (!known) return;
    cold_ms_ = known->cold_ms;
    picks_ = known->picks;
    for (std::size_t variant = 0; variant < runs_.size(); ++variant) {
      const auto found = known->variants.find(calibration_.variants[variant]);
      if (found != known->variants.end()) runs_[variant] = found->second, kept_[variant] = runs_[variant].size();
    }
  }

  void Store() const {
    if (!calibration_.cache || !cold_ms_ || (measured_ == 0 && !left_out_)) return;
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
    known.picks = picks_ + (left_out_ ? 1.0 : 0.0);
    for (std::size_t variant = 0; variant < runs_.size(); ++variant) {
      const std::string& name = calibration_.variants[variant];
      Runs& runs = known.variants[name];
      if (replaced_[variant]) runs.clear();
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
      SCUMBLE_ASSIGN(const bool fits, IsKnownNotToFit(variant) && ChecksAgain() ? FitsNow(variant) : Fits(variant));
      if (fits) return Picked(variant, true);
      left_out_ = true;
    }
    return PickNearlyQuickest();
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

  bool IsKnownNotToFit(std::size_t variant) const {
    const Runs& runs = runs_[variant];
    return std::any_of(runs.begin(), runs.end(), [&](double ms) { return ms > budget_ms_; }) ||
           (runs.size() == std::size_t(kCalibrationRuns) && Predicted(variant) > budget_ms_);
  }

  // At the second pick, the fourth, the eighth and so on.
  bool ChecksAgain() const {
    const double power = std::log2(picks_ + 1.0);
    return picks_ > 0.0 && power == std::floor(power);
  }

  // By new runs; where the known ones are quicker, they stay.
  Expected<bool> FitsNow(std::size_t variant) {
    Runs before = std::exchange(runs_[variant], {});
    const std::size_t kept = std::exchange(kept_[variant], 0);
    replaced_[variant] = checks_again_ = true;
    const Expected<bool> fits = Fits(variant);
    if (fits && (*fits || LeastOf(runs_[variant]) <= LeastOf(before))) return fits;
    runs_[variant] = std::move(before), kept_[variant] = kept, replaced_[variant] = false;
    return fits ? Expected<bool>(!IsKnownNotToFit(variant)) : fits;
  }

  // Where nothing fits. What was left out at its first run may have been slow by chance, so what is not far from the
  // quickest is run a few times, and the least run counts.
  Expected<PickedVariant> PickNearlyQuickest() {
    const auto quicker = [](const Runs& a, const Runs& b) { return LeastOf(a) < LeastOf(b); };
    const auto quickest = [&] {
      return static_cast<std::size_t>(std::min_element(runs_.begin(), runs_.end(), quicker) - runs_.begin());
    };
    SCUMBLE_RETURN_IF_ERROR(RunUpTo(kHopelessRuns, quickest()));
    const auto is_within = [&](std::size_t variant, double factor) {
      return LeastOf(runs_[variant]) <= factor * LeastOf(runs_[quickest()]);
    };
    std::size_t variant = 0;
    for (; variant < runs_.size(); ++variant) {
      if (is_within(variant, kNearQuickest)) SCUMBLE_RETURN_IF_ERROR(RunUpTo(kHopelessRuns, variant));
      if (is_within(variant, kNearlyQuickest)) break;
    }
    // What is far over the budget will not fit, however often it is run.
    const bool hopeless = LeastOf(runs_[variant]) > 2.0 * budget_ms_;
    SCUMBLE_RETURN_IF_ERROR(RunUpTo(hopeless ? kHopelessRuns : kCalibrationRuns, variant));
    return Picked(variant, false);
  }

  Status RunUpTo(int count, std::size_t variant) {
    while (runs_[variant].size() < std::size_t(count)) SCUMBLE_RETURN_IF_ERROR(RunOnce(variant));
    return Ok();
  }

  Status RunOnce(std::size_t variant) {
    if (!cold_ms_ || (checks_again_ && !warmed_up_)) {
      SCUMBLE_RETURN_IF_ERROR(WarmUp());
    } else if (measured_ == 0) {
      SCUMBLE_RETURN_IF_ERROR(measure_(calibration_.cold));  // this process is cold, too
    }
    return Measure(variant);
  }

  Status WarmUp() {
    const std::size_t one = calibration_.cold;
    warmed_up_ = true;
    SCUMBLE_ASSIGN(const double cold, measure_(one));
    double warm = 0.0;
    for (int run = 0; run < 2; ++run) {
      SCUMBLE_ASSIGN(const double ms, measure_(one));
      ++measured_;
      warm = std::max(warm, ms);
      if (runs_[one].size() < std::size_t(kCalibrationRuns)) runs_[one].push_back(ms);
    }
    const double more = std::max(0.0, cold - warm);
    cold_ms_ = std::min(more, cold_ms_.value_or(more));
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
  std::vector<bool> replaced_;     // likewise: those that are kept do not count any more
  std::optional<double> cold_ms_;
  double picks_ = 0.0;         // before, by times that were known
  bool left_out_ = false;      // some variant, now
  bool checks_again_ = false;  // likewise
  bool warmed_up_ = false;     // now
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
