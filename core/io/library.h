// Settings of the picture library that hold for the whole process.
#pragma once

#include <filesystem>

namespace scumble {

// Threads that reading and writing may use; 0 for all. Holds for what begins afterwards, in the whole process. The
// module of formats keeps the number that it is loaded with.
void SetIoThreads(int threads);

// A further folder in which the module of formats may be, for programs that do not stand beside it. Call before
// anything is read; from any thread.
void SetModuleFolder(const std::filesystem::path& folder);

// Whether OpenImageIO has been loaded: some file needed it.
bool IsLibraryLoaded();

}  // namespace scumble
