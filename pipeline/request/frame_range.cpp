#include "pipeline/frame_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <unordered_set>

namespace scumble {
namespace {

Error BadFrames(const std::string& text, const std::string& part, const std::string& why) {
  const std::string where = part == text ? "" : " at '" + part + "'";
  return UsageError("--frames " + text + where + ": " + why);
}

// From the first frame that there may be to the last.
constexpr std::int64_t kMaxStep = 2 * std::int64_t(kMaxFrame);

// One part between commas.
struct Part {
  std::int64_t first = 0, last = 0, step = 1;
};

std::string Trimmed(const std::string& text) {
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  const auto begin = std::find_if_not(text.begin(), text.end(), blank);
  const auto end = std::find_if_not(text.rbegin(), std::make_reverse_iterator(begin), blank).base();
  return {begin, end};
}

// Moves `at` behind the number; false where there is none.
bool TakeNumber(const char*& at, const char* end, std::int64_t& number) {
  const auto [next, failure] = std::from_chars(at, end, number);
  if (failure != std::errc()) return false;
  at = next;
  return true;
}

Expected<Part> ParsePart(const std::string& text, const std::string& part) {
  const auto refuse = [&](const std::string& why) { return BadFrames(text, part, why); };
  const std::string forms = "expected frames as 7, 1-24, 12-24x2 or 10-1, with commas between";
  if (part.empty()) return refuse(text.empty() ? forms : "there is nothing between two commas, or after the last");
  const char *at = part.data(), *end = at + part.size();
  Part range;
  if (!TakeNumber(at, end, range.first)) return refuse(forms);
  range.last = range.first;
  if (at + 1 < end && at[0] == '.' && at[1] == '.') return refuse("write a range with one dash, as 1-24");
  if (at != end) {
    if (*at++ != '-' || !TakeNumber(at, end, range.last)) return refuse(forms);
    if (at != end && (*at == 'y' || *at == ':')) {
      return refuse("y and : are not known here; every Nth frame is 1-24x2");
    }
    range.step = range.last < range.first ? -1 : 1;
    if (at != end) {
      if ((*at != 'x' && *at != 'X') || !TakeNumber(++at, end, range.step) || at != end) return refuse(forms);
      if (range.step == 0) return refuse("a step of 0 leads nowhere");
      if (range.step < -kMaxStep || range.step > kMaxStep) {
        return refuse(fmt::format("a step is at most {}, as 1-24x2 has one of 2", kMaxStep));
      }
      if (range.last < range.first && range.step > 0) range.step = -range.step;
      if (range.last > range.first && range.step < 0) {
        return refuse("a step backwards never gets to the last frame: 10-1x-1 counts down");
      }
    }
  }
  for (const std::int64_t frame : {range.first, range.last}) {
    if (frame < -kMaxFrame || frame > kMaxFrame)
      return refuse(fmt::format("frames go from {} to {}", -kMaxFrame, kMaxFrame));
  }
  return range;
}

}  // namespace

Status CheckFrame(std::optional<int> frame) {
  if (!frame || (*frame >= -kMaxFrame && *frame <= kMaxFrame)) return Ok();
  return UsageError(fmt::format("frame {}: frames go from {} to {}", *frame, -kMaxFrame, kMaxFrame));
}

Expected<std::vector<int>> ParseFrames(const std::string& text) {
  std::vector<int> frames;
  std::unordered_set<int> seen;
  std::int64_t named = 0;  // frames, some of them perhaps twice
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    SCUMBLE_ASSIGN(const Part part, ParsePart(text, Trimmed(text.substr(begin, comma - begin))));
    named += std::llabs(part.last - part.first) / std::llabs(part.step) + 1;
    if (named > static_cast<std::int64_t>(kMaxFrames))
      return BadFrames(text, text, fmt::format("more than {} frames", kMaxFrames));
    for (std::int64_t frame = part.first; part.step > 0 ? frame <= part.last : frame >= part.last; frame += part.step) {
      if (!seen.insert(static_cast<int>(frame)).second) continue;
      frames.push_back(static_cast<int>(frame));
    }
    begin = comma + 1;
  }
  return frames;
}

std::string FramesToText(std::span<const int> frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    const int step = i + 1 < frames.size() ? frames[i + 1] - frames[i] : 0;
    std::size_t last = i;
    while (last + 1 < frames.size() && frames[last + 1] - frames[last] == step) ++last;
    const bool is_range = last >= i + 2 || (last == i + 1 && std::abs(step) == 1);
    if (!is_range) last = i;
    text += (text.empty() ? "" : ",") + std::to_string(frames[i]);
    if (is_range) text += "-" + std::to_string(frames[last]);
    if (is_range && std::abs(step) != 1) text += "x" + std::to_string(step);
    i = last + 1;
  }
  return text;
}

Expected<FrameName> FrameName::Parse(const std::string& name) {
  FrameName result;
  result.text_ = name;
  const std::size_t slash = name.rfind('/');
  const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
  if (const std::size_t last = name.rfind('#'); last != std::string::npos && last >= begin) {
    std::size_t first = last;
    while (first > begin && name[first - 1] == '#') --first;
    result.begin_ = first, result.length_ = last + 1 - first;
    result.digits_ = static_cast<int>(result.length_);
  }
  constexpr int kMostDigits = 20;
  for (std::size_t at = name.find('%', begin); at != std::string::npos; at = name.find('%', at + 1)) {
    std::size_t end = at + 1;
    int digits = 0;
    const bool padded = end < name.size() && name[end] == '0';
    if (padded) {
      const auto [next, failure] = std::from_chars(name.data() + end, name.data() + name.size(), digits);
      if (failure != std::errc() || digits > kMostDigits) continue;
      end = static_cast<std::size_t>(next - name.data());
    }
    if (end >= name.size() || name[end] != 'd') continue;
    if (result.has_place()) {
      return UsageError(name + " has two places for the frame number: leave one, as in p.####.png");
    }
    result.begin_ = at, result.length_ = end + 1 - at, result.digits_ = digits, result.printf_ = true;
  }
  return result;
}

std::string FrameName::At(int frame) const {
  if (!has_place()) return text_;
  const std::string number = printf_ ? fmt::format("{:0{}d}", frame, std::max(1, digits_))
                                     : fmt::format("{}{:0{}d}", frame < 0 ? "-" : "", std::abs(frame), digits_);
  return text_.substr(0, begin_) + number + text_.substr(begin_ + length_);
}

}  // namespace scumble
