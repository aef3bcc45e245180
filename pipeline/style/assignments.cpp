#include "pipeline/style/assignments.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <set>
#include <string_view>

#include "core/io/atomic_file.h"
#include "core/style/nearest_name.h"

namespace scumble {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t(16) << 20;
constexpr const char* kExpected = "expected NAME=STYLE, as in 'Tree*=charcoal' or Glass=rendered";

std::string Trimmed(std::string_view text) {
  constexpr const char* kBlank = " \t\r";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(kBlank) - begin + 1));
}

// The last '=': names of objects are anyone's, names of styles rarely hold one.
bool Split(const std::string& text, Assignment& assignment) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos) return false;
  assignment.pattern = text.substr(0, equals), assignment.style = text.substr(equals + 1);
  return !assignment.pattern.empty() && !assignment.style.empty();
}

Status ReadFile(const std::string& file, std::vector<Assignment>& assignments) {
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(file, kMaxFileBytes));
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string line = Trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line[0] == '#') continue;
    Assignment one;
    const std::string place = file + ":" + std::to_string(number) + ": ";
    if (!Split(line, one)) return InputError(place + line + ": " + kExpected);
    one.pattern = Trimmed(one.pattern), one.style = Trimmed(one.style);
    if (one.pattern.empty() || one.style.empty()) return InputError(place + line + ": " + kExpected);
    one.where = place + line;
    assignments.push_back(std::move(one));
  }
  return Ok();
}

std::string Lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// The name that the pattern fits but for upper and lower case, or the one nearest to it; empty: none is near.
std::string ProbablyMeant(const std::string& pattern, const std::set<std::string>& names) {
  const NamePattern lower(Lower(pattern));
  for (const std::string& name : names) {
    if (lower.Fits(Lower(name))) return name;
  }
  return NearestName(pattern, std::vector<std::string>(names.begin(), names.end()));
}

std::set<std::string> Sorted(const std::map<std::uint32_t, std::string>& names) {
  std::set<std::string> sorted;
  for (const auto& [id, name] : names) sorted.insert(name);
  return sorted;
}

}  // namespace

Expected<std::vector<Assignment>> ReadAssignments(const std::vector<std::string>& options) {
  std::vector<Assignment> assignments;
  for (const std::string& text : options) {
    if (text.size() > 1 && text[0] == '@') {
      SCUMBLE_RETURN_IF_ERROR(ReadFile(text.substr(1), assignments));
      continue;
    }
    Assignment one;
    if (!Split(text, one)) return UsageError("--assign " + text + ": " + kExpected);
    one.where = "--assign " + text;
    assignments.push_back(std::move(one));
  }
  return assignments;
}

NamePattern::NamePattern(const std::string& text) : text_(text) {
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('*', begin), text.size());
    parts_.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
}

bool NamePattern::Fits(std::string_view name) const {
  if (parts_.size() == 1) return name == text_;
  const std::string &first = parts_.front(), &last = parts_.back();
  if (name.size() < first.size() + last.size() || !name.starts_with(first) || !name.ends_with(last)) return false;
  name = name.substr(first.size(), name.size() - first.size() - last.size());
  for (std::size_t i = 1; i + 1 < parts_.size(); ++i) {  // each as far left as it can be
    const std::size_t at = name.find(parts_[i]);
    if (at == std::string_view::npos) return false;
    name.remove_prefix(at + parts_[i].size());
  }
  return true;
}

std::string SomeOf(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 12;
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i == kMost) return list + ", …";
    list += (list.empty() ? "" : ", ") + names[i];
  }
  return list.empty() ? "none" : list;
}

std::string DescribeNames(const std::string& pattern, const std::map<std::uint32_t, std::string>& objects,
                          const std::map<std::uint32_t, std::string>& materials) {
  std::set<std::string> names = Sorted(objects);
  std::string text = "its objects are " + SomeOf({names.begin(), names.end()});
  const std::set<std::string> of_materials = Sorted(materials);
  text += "; its materials are " + SomeOf({of_materials.begin(), of_materials.end()});
  names.insert(of_materials.begin(), of_materials.end());
  const std::string meant = ProbablyMeant(pattern, names);
  return meant.empty() ? text : text + "; did you mean " + meant + "?";
}

}  // namespace scumble
