// What --assign takes: NAME=STYLE, or a file of such lines; how names are matched, and how messages list them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/status.h"

namespace scumble {

struct Assignment {
  std::string pattern;  // name of an object or material, * stands for any text
  std::string style;
  std::string where;  // "--assign Tree*=charcoal", or "sheet.txt:12: Tree* = charcoal"
};

// In the order given, a file's lines in place of it. "@FILE" names a file: one assignment a line, blanks around name
// and style left out, empty lines and those that begin with # passed over. A mistake in an option is kUsage, in a file
// kInput.
Expected<std::vector<Assignment>> ReadAssignments(const std::vector<std::string>& options);

// A name in which * stands for any text.
class NamePattern {
 public:
  explicit NamePattern(const std::string& text);
  bool Fits(std::string_view name) const;
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::vector<std::string> parts_;  // between the stars; one: there is none
};

// Up to 12 of them, in their order, with commas between; "none" if there are none.
std::string SomeOf(const std::vector<std::string>& names);

// Which names there are, sorted, and which of them was probably meant by a pattern that fits none: "its objects are
// Ball, Floor; its materials are Grey; did you mean Ball?"
std::string DescribeNames(const std::string& pattern, const std::map<std::uint32_t, std::string>& objects,
                          const std::map<std::uint32_t, std::string>& materials);

}  // namespace scumble
