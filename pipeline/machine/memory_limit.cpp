#include "pipeline/memory_limit.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr double kKibi = 1024.0;
constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();

// Without going beyond what the type holds.
std::uint64_t Sum(std::uint64_t a, std::uint64_t b) { return a > kMost - b ? kMost : a + b; }
// What is left of a when b is taken from it.
std::uint64_t Less(std::uint64_t a, std::uint64_t b) { return a > b ? a - b : 0; }

void AddPart(std::vector<MemoryNeed::Part>& parts, const std::string& name, std::uint64_t bytes) {
  const auto same = std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.name == name; });
  if (same == parts.end())
    parts.push_back({name, bytes});
  else
    same->bytes = Sum(same->bytes, bytes);
}

// As --max-memory takes it, rounded up.
std::string BytesToOption(std::uint64_t bytes) {
  constexpr std::uint64_t kMebi = 1 << 20;
  return fmt::format("{}M", bytes / kMebi + (bytes % kMebi != 0));
}

// The number behind a name in a file of lines "Name:   1234 kB"; in bytes.
std::optional<std::uint64_t> FieldOf(const fs::path& file, const std::string& name) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(name, 0) != 0) continue;
    std::istringstream fields(line.substr(name.size()));
    std::uint64_t number = 0;
    std::string unit;
    if (!(fields >> number)) return std::nullopt;
    fields >> unit;
    return unit == "kB" ? number * 1024 : number;
  }
  return std::nullopt;
}

// A file that holds one number, or "max".
std::optional<std::uint64_t> NumberIn(const fs::path& file) {
  std::ifstream stream(file);
  std::uint64_t number = 0;
  if (stream >> number) return number;
  return std::nullopt;
}

// What a group leaves: its limit without what it has, of which files in the cache can be dropped.
std::optional<std::uint64_t> LeftInGroup(const fs::path& folder, const char* limit_file, const char* usage_file) {
  const auto limit = NumberIn(folder / limit_file);
  if (!limit) return std::nullopt;
  const std::uint64_t used = NumberIn(folder / usage_file).value_or(0);
  const std::uint64_t dropped = FieldOf(folder / "memory.stat", "inactive_file ").value_or(0);
  return Less(*limit, Less(used, dropped));
}

// The least that the group of this process and those above it leave. In a container the path may be one of the world
// outside: then the folder that is mounted is the group's own.
std::optional<std::uint64_t> LeftInGroups(const fs::path& root) {
  std::optional<std::uint64_t> least;
  const auto look = [&](const fs::path& mount, std::string path, const char* limit_file, const char* usage_file) {
    while (true) {
      const auto left = LeftInGroup(path.empty() ? mount : mount / path.substr(1), limit_file, usage_file);
      if (left) least = std::min(*left, least.value_or(*left));
      if (path.empty()) return;
      path.resize(path.rfind('/') == std::string::npos ? 0 : path.rfind('/'));
    }
  };
  std::ifstream stream(root / "proc/self/cgroup");
  for (std::string line; std::getline(stream, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    std::string path = line.substr(second + 1);
    if (path.empty() || path.front() != '/' || path == "/") path.clear();
    if (controllers == ",,") look(root / "sys/fs/cgroup", path, "memory.max", "memory.current");
    if (controllers.find(",memory,") != std::string::npos) {
      look(root / "sys/fs/cgroup/memory", path, "memory.limit_in_bytes", "memory.usage_in_bytes");
    }
  }
  return least;
}

}  // namespace

void MemoryNeed::Take(const std::string& name, std::uint64_t bytes) {
  AddPart(held_, name, bytes);
  LookForPeak(held_);
}

void MemoryNeed::TakeTransient(const std::string& name, std::uint64_t bytes) {
  std::vector<Part> parts = held_;
  AddPart(parts, name, bytes);
  LookForPeak(parts);
}

bool MemoryNeed::Holds(const std::string& name) const {
  return std::any_of(held_.begin(), held_.end(), [&](const Part& part) { return part.name == name; });
}

void MemoryNeed::LookForPeak(const std::vector<Part>& parts) {
  std::uint64_t sum = 0;
  for (const Part& part : parts) sum = Sum(sum, part.bytes);
  if (sum < peak_) return;
  peak_ = sum, at_peak_ = parts;
}

MemoryLimit LimitFor(const RunContext& context, const fs::path& root) {
  if (context.max_memory > 0) return {context.max_memory, "--max-memory allows", true};
  MemoryLimit limit{kMost, "", false};
  const auto at_most = [&](std::uint64_t bytes, const char* who) {
    if (bytes < limit.bytes) limit = {bytes, who, false};
  };
  const fs::path status = root / "proc/self/status";
  const std::uint64_t resident = FieldOf(status, "VmRSS:").value_or(0), mapped = FieldOf(status, "VmSize:").value_or(0);
  if (const auto free = FieldOf(root / "proc/meminfo", "MemAvailable:"))
    at_most(Sum(*free, resident), "the machine has");
  if (const auto left = LeftInGroups(root)) at_most(Sum(*left, resident), "the control group of this process has");
  rlimit space{};
  // What is mapped and not used, libraries and stacks, is lost to it.
  if (::getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY) {
    at_most(Sum(Less(space.rlim_cur, mapped), resident), "ulimit -v leaves");
  }
  return limit;
}

Status CheckMemory(const MemoryNeed& need, const MemoryLimit& limit, const std::string& fix) {
  if (need.peak() <= limit.bytes) return Ok();
  std::string parts;
  for (const MemoryNeed::Part& part : need.parts()) {
    parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", part.name, BytesToText(part.bytes));
  }
  const auto is_less = [](const auto& a, const auto& b) { return a.bytes < b.bytes; };
  const std::string most = std::max_element(need.parts().begin(), need.parts().end(), is_less)->name;
  const bool is_exemplar = most == "exemplars" || most == "preparing exemplars";
  const std::string message = fmt::format(
      "this takes up to {} of memory ({}), and {} {}: {}, or {}", BytesToText(need.peak()), parts, limit.who,
      BytesToText(limit.bytes),
      is_exemplar ? "take a smaller picture, a smaller transfer.scale or a larger transfer.reference_height" : fix,
      limit.asked ? "allow more" : "say --max-memory " + BytesToOption(need.peak()) + " to try all the same");
  return limit.asked ? UsageError(message) : MemoryError(message);
}

Status CheckMemory(const MemoryNeed& need, const RunContext& context, const std::string& fix) {
  const MemoryLimit limit = LimitFor(context);
  SCUMBLE_RETURN_IF_ERROR(CheckMemory(need, limit, fix));
  if (!context.noted_memory) return Ok();
  const std::uint64_t noted = *context.noted_memory;
  if (need.peak() < kMuchMemory || need.peak() < noted + noted / 2) return Ok();
  *context.noted_memory = need.peak();
  context.Note(fmt::format("takes up to {} of memory{}", BytesToText(need.peak()),
                           limit.who.empty() ? "" : fmt::format("; {} {}", limit.who, BytesToText(limit.bytes))));
  return Ok();
}

std::function<Status(std::uint64_t bytes)> RoomForStyles(const RunContext& context) {
  return [need = std::make_shared<MemoryNeed>(), limit = LimitFor(context), context](std::uint64_t bytes) -> Status {
    SCUMBLE_RETURN_IF_ERROR(context.CheckNotCancelled());
    need->Take("styles", bytes);
    return CheckMemory(*need, limit, "take smaller exemplars");
  };
}

std::uint64_t PeakMemory() { return FieldOf("/proc/self/status", "VmHWM:").value_or(0); }

std::string BytesToText(std::uint64_t bytes) {
  constexpr const char* kUnits[] = {"bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  double number = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; number >= 999.5 && unit + 1 < std::size(kUnits); ++unit) number /= kKibi;
  return fmt::format("{:.{}f} {}", number, unit > 0 && number < 9.95 ? 1 : 0, kUnits[unit]);
}

void ForgetPeakMemory() { std::ofstream("/proc/self/clear_refs") << "5"; }  // proc(5)

Expected<std::uint64_t> ParseBytes(const std::string& text) {
  const Error wrong = UsageError(text + " is no amount of memory: expected one above 0, as 4G, 1.5G or 800M");
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [next, failure] = std::from_chars(text.data(), end, number, std::chars_format::fixed);
  if (failure != std::errc() || !(number > 0.0) || end - next > 1) return wrong;
  if (next != end) {
    const std::size_t power =
        std::string("KMGT").find(static_cast<char>(std::toupper(static_cast<unsigned char>(*next))));
    if (power == std::string::npos) return wrong;
    number *= std::pow(kKibi, static_cast<double>(power + 1));
  }
  constexpr double kMostAsked = 0x1p62;
  if (!(number >= 1.0 && number <= kMostAsked)) return wrong;
  return static_cast<std::uint64_t>(number);
}

}  // namespace scumble
