// Temporary files of writes that are not finished, for a handler of the signals that end a program.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

namespace scumble {

// Removes the temporary files of all writes under way. Nothing is begun from then on: a thread that would make another
// temporary file waits for the end of the process instead, and one that would give a file its name does so whole or not
// at all. For handlers of signals that end it: calls nothing but what is safe there, and waits no longer than a second
// for a file that another thread is just making.
void RemoveUnfinishedFiles();

namespace internal {

// A temporary file that RemoveUnfinishedFiles knows of as long as this lives. What is left of it then is removed.
class UnfinishedFile {
 public:
  // Makes a new file that nobody else has beside `target`: hidden, with a random name, short enough where the target's
  // own name is as long as a name may be, and locked as long as this lives. descriptor() is -1 where it cannot (it takes two descriptors), and
  // errno says why; otherwise the caller's to close. The first in a folder takes away what killed runs left there
  // (core/io/file/stale_temporaries.h).
  explicit UnfinishedFile(const std::filesystem::path& target);
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  int descriptor() const { return descriptor_; }

  // Renames it to `target`; 0 or an errno.
  int Finish(const std::filesystem::path& target);

 private:
  bool Make(const std::string& wanted);  // false: once more
  bool Hold();                           // locks it; false: another run has it
  void Forget();

  std::string name_;
  int descriptor_ = -1;
  int lock_ = -1;                              // the same file: its lock lasts when the caller has closed the other
  std::atomic<const char*>* place_ = nullptr;  // where RemoveUnfinishedFiles finds the name; null where all are taken
  bool is_there_ = false;
};

}  // namespace internal
}  // namespace scumble
