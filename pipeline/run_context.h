// What a run is allowed, and where it reports to: threads, memory, messages, the clock of its stages, folders.
//
// No function of this library prints, exits, parses arguments, reads the environment or changes what a signal does. The
// application fills a RunContext once and passes it down; a copy is cheap.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/image/progress.h"
#include "core/image/status.h"

namespace scumble {

class ProcessGuard;
class StageClock;

struct Message {
  enum class Kind {
    kNote,     // a decision that the user may want to know: a camera that was chosen, an exposure that was measured
    kWarning,  // something that was asked for and has no effect, or that probably is not meant
  };
  Kind kind = Kind::kNote;
  std::string text;  // one line, no newline at its end
};

struct RunContext {
  int threads = 0;  // 0: all. Reading and writing files has one number for the process: that of the latest call
  std::uint64_t max_memory = 0;  // bytes; 0: what the machine has
  // Starts a progress report of this label; the report ends when the returned callback is destroyed. Null: none.
  // The callback returns false to cancel the run, which then ends with kCancelled.
  std::function<Progress(const std::string& label)> on_progress;
  // Asked between the steps of a run, and while a program is waited for, from any thread. True cancels the run, which
  // then ends with kCancelled. Null: nothing cancels it but a progress callback.
  std::function<bool()> is_cancelled;
  // Receives messages on the thread that runs the request; null: they are dropped.
  std::function<void(const Message&)> on_message;
  std::shared_ptr<StageClock> clock;  // null: stages are not timed
  // Look-up tables and measured times are kept here between runs; empty: nowhere.
  std::filesystem::path cache_folder;
  // Folders that may hold "exemplars" and "blender_scripts". Of a style in several, the first is taken.
  std::vector<std::filesystem::path> data_roots;
  // "NAME=VALUE": what programs that a run starts get, such as Blender. They are looked for in the PATH given here;
  // without one, in /bin and /usr/bin.
  std::vector<std::string> environment;
  std::filesystem::path temporary_folder = "/tmp";  // for exported scenes and logs, while a program runs
  // This program, scumble, which measures memory in a process of its own; empty: memory cannot be measured.
  std::filesystem::path program;
  std::shared_ptr<ProcessGuard> process_guard;  // ends programs when a signal ends this one; null: they would go on
  // The largest need of memory that was noted so far; null: needs are checked and not noted.
  std::shared_ptr<std::atomic<std::uint64_t>> noted_memory = std::make_shared<std::atomic<std::uint64_t>>(0);

  // Whether a note said that light has more noise than is aimed at: frames do not repeat it. Null: none says so.
  std::shared_ptr<std::atomic<bool>> noted_light_noise = std::make_shared<std::atomic<bool>>(false);

  Progress StartProgress(const std::string& label) const { return on_progress ? on_progress(label) : Progress(); }
  void Note(const std::string& text) const;
  void Warn(const std::string& text) const;
  // Ok, or kCancelled where is_cancelled says so.
  Status CheckNotCancelled() const;
  // Ends a stage on the clock, as StageClock::End.
  void EndStage(const std::string& name, const std::vector<std::pair<std::string, double>>& inside = {}) const;

  // This context for work beside the run: warnings are passed on, notes are dropped, no stage is timed and no progress
  // reported.
  RunContext WithoutNotes() const;

  // The folders of this name that are there, under data_roots.
  std::vector<std::filesystem::path> DataFolders(const std::string& name) const;
};

}  // namespace scumble
