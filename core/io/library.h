// Settings of the picture library that hold for the whole process.
#pragma once

namespace scumble {

// Threads that reading and writing may use; 0 for all. Call once, before anything is read.
void SetIoThreads(int threads);

// Whether OpenImageIO has been loaded: some file needed it.
bool IsLibraryLoaded();

}  // namespace scumble
