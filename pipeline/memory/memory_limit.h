// How much memory a run takes at its peak, said before it is taken, and refused where there is less.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "pipeline/run_context.h"

namespace scumble {

// A run's memory, told in the order in which it is taken; docs/memory.md has the formula,
// pipeline/memory/memory_estimate.h its terms.
class MemoryNeed {
 public:
  struct Part {
    std::string name;  // "guides"
    std::uint64_t bytes;
  };

  // Stays until the run ends. Parts of one name are one part.
  void Take(const std::string& name, std::uint64_t bytes);
  // Is given back before the next call.
  void TakeTransient(const std::string& name, std::uint64_t bytes);

  std::uint64_t peak() const { return peak_; }
  // What there is at the peak.
  const std::vector<Part>& parts() const { return at_peak_; }

 private:
  void LookForPeak(const std::vector<Part>& parts);

  std::vector<Part> held_, at_peak_;
  std::uint64_t peak_ = 0;
};

// What a run may take, and who says so.
struct MemoryLimit {
  std::uint64_t bytes = 0;
  std::string who;     // "the machine has", "--max-memory allows"
  bool asked = false;  // it is the user's own, by --max-memory
};

// --max-memory where it was given, else the least of what the machine has (MemAvailable of proc(5)), what the control
// groups that this process is in leave (memory.max of version 2, memory.limit_in_bytes of 1) and what `ulimit -v`
// leaves; what this process has already counts as there. `root` is "/", or a folder that stands for it.
MemoryLimit LimitFor(const RunContext& context, const std::filesystem::path& root = "/");

// Ok, or an error that says how much is needed, for what, how much there is, and what to do: kUsage where it was
// --max-memory, kMemory otherwise. A machine that does not tell refuses nothing.
Status CheckMemory(const MemoryNeed& need, const MemoryLimit& limit, const std::string& mend);
// The same for this machine. From kMuchMemory on what fits is said before it is taken: once, and again where a later
// check of the run comes to half as much more.
Status CheckMemory(const MemoryNeed& need, const RunContext& context, const std::string& mend);
inline constexpr std::uint64_t kMuchMemory = std::uint64_t(4) << 30;

// For StyleRequest::room: adds up what the pictures of a run's styles take, and refuses as CheckMemory does where they
// alone are more than there is. Copies add up together.
std::function<Status(std::uint64_t bytes)> RoomForStyles(const RunContext& context);

// The most that this process has had so far, as the system counts it (VmHWM of proc(5)); 0 where it does not.
std::uint64_t PeakMemory();
// What it has now (VmRSS); 0 likewise.
std::uint64_t ResidentMemory();
// From here on PeakMemory is that of what comes, beside what is there; where the system cannot forget, it stays.
void ForgetPeakMemory();

// "1.2 GiB", in powers of 1024.
std::string BytesToText(std::uint64_t bytes);
// "4G", "1.5g", "800M", "64K", "1T" or plain bytes, in powers of 1024, as `ulimit` and systemd count.
Expected<std::uint64_t> ParseBytes(const std::string& text);

}  // namespace scumble
