// Settings of the picture library for the whole process.
#pragma once

#include <filesystem>

namespace scumble {

// Threads that reading and writing may use; 0 for all. Holds for what begins afterwards, in the whole process. The
// module of formats keeps the number that it is loaded with.
void SetIoThreads(int threads);

// A further folder that may hold the module of formats, for programs installed elsewhere. Call before anything is read;
// from any thread.
void SetModuleFolder(const std::filesystem::path& folder);

// Whether OpenImageIO has been loaded: some file needed it.
bool IsLibraryLoaded();

}  // namespace scumble
