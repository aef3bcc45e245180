// Frame ranges, and file names with a place for the frame number, as animation programs write them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"

namespace scumble {

inline constexpr int kMaxFrame = 999'999'999;         // frame numbers are -kMaxFrame … kMaxFrame
inline constexpr std::size_t kMaxFrames = 1'000'000;  // that may be named, those that come again too

// Ok, or a kUsage error where there is a number out of range.
Status CheckFrame(std::optional<int> frame);

// "7", "1-24", "3,5-10", "12-24x2" (every second), "10-1" or "10-1x-1" (backwards), "-5--1" (negative numbers), as
// oiiotool, Nuke and fileseq write them. In the order given; a frame that comes again counts once. A usage error says
// what is wrong: fileseq's y and : and Blender's .. are refused by name.
Expected<std::vector<int>> ParseFrames(const std::string& text);

// Short text that ParseFrames reads back as the same list.
std::string FramesToText(std::span<const int> frames);

// A file name with a place for the frame number. That is the last run of # in it, as in Blender (p.####.png: four
// digits or more), or printf's %d and %04d. Folders are left alone.
class FrameName {
 public:
  // A usage error where there are two places.
  static Expected<FrameName> Parse(const std::string& name);

  // Whether there is a place.
  bool has_place() const { return length_ > 0; }
  // Whether the place cannot be part of a plain name: "take#2.png" may be one, "p.####.png" is none.
  bool must_have_frame() const { return has_place() && (printf_ || length_ > 1); }
  // The name of that frame's file. -5 is -0005 for #### as in Blender, and -005 for %04d as in C.
  std::string At(int frame) const;
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::size_t begin_ = 0, length_ = 0;  // of the place in text_
  int digits_ = 0;
  bool printf_ = false;
};

}  // namespace scumble
