// For an application that catches signals: which program runs on its behalf, and which temporary folder is in use.
#pragma once

#include <filesystem>

namespace scumble {

// The pipeline calls it for each program that it starts: Begin, FolderMade, the programs, End. One folder at a time. An
// application's signal handler can then end the program and remove the folder; apps/cli/app/program_guard.h does.
class ProcessGuard {
 public:
  virtual ~ProcessGuard() = default;

  virtual void Begin() = 0;  // before the temporary folder is made
  virtual void FolderMade(const std::filesystem::path& folder) = 0;
  virtual void End() = 0;  // after the folder was removed

  // `group` is a process group: the program leads it, its children are in it.
  virtual void ProgramStarted(int group) = 0;
  virtual void ProgramEnded() = 0;

  // While the program works and nobody waits for it, RunContext::is_cancelled is asked late: after a frame, perhaps.
  virtual void Waits(bool waits) = 0;
};

}  // namespace scumble
