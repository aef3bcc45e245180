// What a run takes, term by term; docs/memory.md explains the parts. Every term is the most that its part takes, for
// pictures that are covered from edge to edge and paint that does not pack at all;
// tests/pipeline/memory_estimate_test.cpp holds it against what the system counted.
#pragma once

#include <filesystem>
#include <span>

#include "core/image/layers.h"
#include "core/image/style.h"
#include "core/io/guide_file.h"
#include "core/style/finish_chain.h"
#include "guidegen/scene.h"
#include "guidegen/scene_textures.h"
#include "pipeline/memory_limit.h"
#include "pipeline/requests.h"

namespace scumble {

// The program itself, its libraries, and what each thread has for itself. `threads` 0: all.
void AddProgram(int threads, MemoryNeed& need);

// What reading a picture takes besides the picture: its file and its samples as they are stored, and OpenImageIO, which
// stays.
void AddPictureRead(const std::filesystem::path& file, std::uint64_t pixels, MemoryNeed& need);

// A scene in memory and Embree's of it, with the pictures that are decoded, the files of those that are not, and
// pictures that are to be decoded.
void AddScene(const Scene& scene, const TexturePixels& more, MemoryNeed& need);

// Guides as guidegen makes them: the planes of `layers` and of those that are always there; briefly the pixels whose
// light paths are followed.
void AddGuides(const Size& size, const LayerSet& layers, const SceneRequest& options, MemoryNeed& need);

// More fragments (core/image/fragments.h) than guides of that size nearly ever have.
std::size_t FragmentsExpected(const Size& size, int aa);

// A guide file of these layers, for a moment: it is packed in memory before it is written.
void AddGuideFile(const Size& size, const LayerSet& layers, bool cryptomatte, MemoryNeed& need);

// A second set of guides and its file, for a sequence that writes one frame while it makes the next.
void AddGuidesBehind(const Size& size, const LayerSet& layers, MemoryNeed& need);

// Guides as they are read from a file.
void AddGuidesRead(const GuideFileInfo& info, const GuideReadOptions& read, MemoryNeed& need);

// What turns guides of a size into a picture: styles, their exemplars at the picture's height, picture, sources, file.
struct PictureWork {
  std::span<const Style> styles;
  bool has_map = false;      // several styles in one picture
  Size guides;               // before they are upsampled
  LayerSet layers;           // that the guides hold
  bool is_sequence = false;  // one picture is written while the next is made
  bool keeps_field = false;  // PictureRequest::KeepsField
  int threads = 0;
  std::size_t fragments = 0;            // of the guides
  const FinishChain* finish = nullptr;  // of the run; null: none
};
void AddPicture(const PictureWork& work, const PictureRequest& options, MemoryNeed& need);

// What finishing passes take over a picture, in the frame where they take the most: the pixels that they are for, and
// their work.
void AddFinish(const FinishChain& chain, bool has_map, const Size& size, MemoryNeed& need);

// The layers of passes, as a file (`all`) or one pass alone.
void AddFinishLayers(std::size_t passes, bool all, bool is_sequence, const Size& size, MemoryNeed& need);

// The artist's kit of `scumble sphere`: `lights` of N × N guides with these layers and their template files.
void AddKit(int size, std::size_t lights, const LayerSet& layers, bool has_layers_file, MemoryNeed& need);

}  // namespace scumble
