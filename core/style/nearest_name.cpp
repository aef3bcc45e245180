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

// Letters to add, drop, change or swap with the next, to come from one to the other (Damerau and Levenshtein, each
// letter touched once).
std::size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> rows(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) rows[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) rows[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = rows[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
      rows[i][j] = std::min({changed, rows[i - 1][j] + 1, rows[i][j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        rows[i][j] = std::min(rows[i][j], rows[i - 2][j - 2] + 1);
    }
  }
  return rows[a.size()][b.size()];
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
