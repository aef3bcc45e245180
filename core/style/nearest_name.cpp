#include "core/style/nearest_name.h"

#include <algorithm>
#include <cctype>
#include <vector>

namespace scumble {
namespace {

std::string Lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Letters to add, drop or change, to come from one to the other (Levenshtein).
std::size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({changed, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string NearestName(const std::string& text, std::span<const std::string> names) {
  const std::string lower = Lower(text);
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(1, text.size() / 3) + 1;
  for (const std::string& name : names) {
    // Long names are no slips of the finger, and the distance takes time.
    if (name.size() > text.size() + best_distance || text.size() > 256) continue;
    const std::size_t distance = EditDistance(lower, Lower(name));
    if (distance < best_distance) best = name, best_distance = distance;
  }
  return best;
}

}  // namespace scumble
