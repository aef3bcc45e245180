// Pending temporary files: those of writes under way, for a handler of the signals that end a program.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

namespace scumble {

// Removes the temporary files of all writes under way. Nothing is begun from then on: a thread that would make another
// temporary file waits for the end of the process instead, and one that would give a file its name does so whole or not
// at all. For handlers of signals that end it: calls nothing but what is safe there, and waits no longer than a second
// for a file that another thread is just making.
void RemovePendingTemporaries();

namespace internal {

// A temporary file that RemovePendingTemporaries knows of as long as this lives. If it was not renamed by then, the
// destructor removes it.
class PendingTemporary {
 public:
  // Makes a new file beside `target`: hidden, with a random name, short enough where the target's own name is as long
  // as a name may be, and locked as long as this lives. The caller closes descriptor(). If no file can be made (it
  // takes two descriptors), descriptor() is -1 and errno says why. The first one in a folder removes stale temporaries
  // there.
  explicit PendingTemporary(const std::filesystem::path& target);
  ~PendingTemporary();
  PendingTemporary(const PendingTemporary&) = delete;
  PendingTemporary& operator=(const PendingTemporary&) = delete;

  int descriptor() const { return descriptor_; }

  // Renames it to `target`; 0 or an errno.
  int Finish(const std::filesystem::path& target);

 private:
  bool Make(const std::string& wanted);  // false: once more
  bool Hold();                           // locks it; false: another run has it
  void Forget();

  std::string name_;
  int descriptor_ = -1;
  int lock_ = -1;  // the same file: its lock lasts when the caller has closed the other
  std::atomic<const char*>* place_ =
      nullptr;  // where RemovePendingTemporaries finds the name; null where all are taken
  bool is_there_ = false;
};

}  // namespace internal
}  // namespace scumble
