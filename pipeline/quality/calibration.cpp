#include "pipeline/quality/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
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

bool IsNumber(const nlohmann::json& json, double& number) {
  if (!json.is_number()) return false;
  number = json.get<double>();
  return number >= 0.0 && std::isfinite(number);
}

// Times by way, as {"circumstances": …, "cold_ms": 3.5, "ways": {"--upsample 4": [12.5, …], …}, "off_of": "", "off": {"--upsample 4": 0.3}},
// null where it cannot be known. Nothing where the text is none of ours, or of others: keys are hashes.
struct Known {
  std::map<std::string, Runs> ways;
  std::map<std::string, double> off;  // of ways that had rivals
  std::string off_of;                 // Calibration::judged
  double cold_ms = 0.0;
};
std::optional<Known> ParseTimes(std::span<const std::byte> bytes, const std::string& circumstances) {
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || json.value("circumstances", nlohmann::json()) != circumstances) return std::nullopt;
  const auto ways = json.find("ways");
  const auto cold = json.find("cold_ms");
  if (ways == json.end() || !ways->is_object() || cold == json.end()) return std::nullopt;
  Known known;
  if (!IsNumber(*cold, known.cold_ms)) return std::nullopt;
  for (const auto& [way, times] : ways->items()) {
    if (!times.is_array() || times.size() > std::size_t(kCalibrationRuns)) return std::nullopt;
    for (const auto& time : times) {
      double ms = 0.0;
      if (!IsNumber(time, ms)) return std::nullopt;
      known.ways[way].push_back(ms);
    }
  }
  const auto off = json.find("off");
  if (off == json.end() || !off->is_object()) return std::nullopt;
  for (const auto& [way, value] : off->items()) {
    if (value.is_null()) {
      known.off[way] = std::numeric_limits<double>::infinity();
    } else if (!IsNumber(value, known.off[way])) {
      return std::nullopt;
    }
  }
  if (const auto of = json.find("off_of"); of != json.end() && of->is_string()) known.off_of = of->get<std::string>();
  return known;
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
    nlohmann::ordered_json json{{"circumstances", calibration_.circumstances},
                                {"cold_ms", *cold_ms_},
                                {"ways", nlohmann::ordered_json::object()},
                                {"off_of", calibration_.judged},
                                {"off", nlohmann::ordered_json::object()}};
    // Another process may have measured other ways meanwhile, or all of them anew: only what was found out here joins what is kept.
    Known known;
    if (const auto bytes = calibration_.cache->Load(Key()); bytes && !calibration_.anew) {
      if (const auto other = ParseTimes(*bytes, calibration_.circumstances)) {
        known = *other;
        if (!warmed_up_) json["cold_ms"] = known.cold_ms;
      }
    }
    if (known.off_of != calibration_.judged) known.off.clear();
    for (std::size_t way = 0; way < runs_.size(); ++way) {
      const std::string& name = calibration_.ways[way];
      Runs& runs = known.ways[name];
      for (std::size_t run = kept_[way]; run < runs_[way].size() && runs.size() < std::size_t(kCalibrationRuns); ++run) {
        runs.push_back(runs_[way][run]);
      }
    }
    for (const std::size_t way : judged_) known.off[calibration_.ways[way]] = *off_[way];
    for (const auto& [name, runs] : known.ways) {
      if (!runs.empty()) json["ways"][name] = runs;
    }
    for (const auto& [name, off] : known.off) json["off"][name] = std::isfinite(off) ? nlohmann::ordered_json(off) : nullptr;
    const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
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
