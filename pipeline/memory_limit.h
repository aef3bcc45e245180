// How much memory a run takes at its peak: noted before it is taken, refused where there is less.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "pipeline/run_context.h"

namespace scumble {

// A run's memory, added up in the order in which it is taken. docs/memory.md explains the parts,
// pipeline/memory_estimate.h its terms.
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

  // Whether a part of that name has been taken to stay.
  bool Holds(const std::string& name) const;

  std::uint64_t peak() const { return peak_; }
  // What there is at the peak.
  const std::vector<Part>& parts() const { return at_peak_; }

 private:
  void LookForPeak(const std::vector<Part>& parts);

  std::vector<Part> held_, at_peak_;
  std::uint64_t peak_ = 0;
};

// What a run may take, and what limits it.
struct MemoryLimit {
  std::uint64_t bytes = 0;
  std::string who;     // "the machine has", "--max-memory allows"
  bool asked = false;  // it is the user's own, by --max-memory
};

// RunContext::max_memory where it is given. Otherwise the least of three: what the machine has (MemAvailable of
// proc(5)); what the control groups of this process leave (memory.max of version 2, memory.limit_in_bytes of 1); what
// `ulimit -v` leaves. What this process holds already counts as available. `root` is "/", or a folder in its place.
MemoryLimit LimitFor(const RunContext& context, const std::filesystem::path& root = "/");

// Ok, or an error that says how much is needed, for what, how much there is, and what to do: `fix`,
// or, where exemplars take the most, their size. kUsage where max_memory is the limit, kMemory otherwise. Where the
// machine's memory is not known, nothing is refused.
Status CheckMemory(const MemoryNeed& need, const MemoryLimit& limit, const std::string& fix);
// CheckMemory for this machine. A need of kMuchMemory or more is noted before it is taken: once, and again where a
// later check of the run comes to half as much more.
Status CheckMemory(const MemoryNeed& need, const RunContext& context, const std::string& fix);
inline constexpr std::uint64_t kMuchMemory = std::uint64_t(4) << 30;

// For StyleRequest::room: adds up what the pictures of a run's styles take, and refuses as CheckMemory does where they
// alone are more than there is. Copies add up together. kCancelled where the context is cancelled.
std::function<Status(std::uint64_t bytes)> RoomForStyles(const RunContext& context);

// The most that this process has held so far, as the system counts it (VmHWM of proc(5)); 0 where it does not.
std::uint64_t PeakMemory();
// Makes PeakMemory begin again at what is held now. Does nothing where the system cannot.
void ForgetPeakMemory();

// "1.2 GiB", in powers of 1024.
std::string BytesToText(std::uint64_t bytes);
// "4G", "1.5g", "800M", "64K", "1T" or plain bytes, in powers of 1024, as `ulimit` and systemd count.
Expected<std::uint64_t> ParseBytes(const std::string& text);

}  // namespace scumble
