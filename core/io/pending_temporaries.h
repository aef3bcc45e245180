// Pending temporary files: those of writes under way, for a handler of the signals that end a program.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

namespace scumble {

// Removes the temporary files of all writes under way. From then on nothing is begun: a thread that would make another
// temporary file waits for the end of the process. A thread that would rename a file does so completely or not at all.
// For handlers of signals that end the process: calls only async-signal-safe functions, and waits at most a second for
// a file that another thread is creating.
void RemovePendingTemporaries();

namespace internal {

// A temporary file that RemovePendingTemporaries can remove while this object lives. If the file was not renamed by
// then, the destructor removes it.
class PendingTemporary {
 public:
  // Makes a new file beside `target`: hidden, with a random name, shortened where the target's name has the greatest
  // length, and locked while this object lives. The caller closes descriptor(). If no file can be made (it takes two
  // descriptors), descriptor() is -1 and errno has the reason. The first one in a folder removes stale temporaries
  // there.
  explicit PendingTemporary(const std::filesystem::path& target);
  ~PendingTemporary();
  PendingTemporary(const PendingTemporary&) = delete;
  PendingTemporary& operator=(const PendingTemporary&) = delete;

  int descriptor() const { return descriptor_; }

  // Renames it to `target`; 0 or an errno.
  int Finish(const std::filesystem::path& target);

 private:
  bool Make(const std::string& wanted);  // false: try again
  bool Hold();                           // locks it; false: another run has it
  void Forget();

  std::string name_;
  int descriptor_ = -1;
  int lock_ = -1;  // the same file: this lock lasts after the caller has closed the other descriptor
  // The slot in which RemovePendingTemporaries finds the name; null where all are taken.
  std::atomic<const char*>* place_ = nullptr;
  bool is_there_ = false;
};

}  // namespace internal
}  // namespace scumble
