#include "engine/core/similar_word.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <vector>

namespace condyle {
namespace {

bool same_letter(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

/// Levenshtein distance: letters that are inserted, deleted or replaced.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t above = row[j + 1];
      row[j + 1] = std::min({above + 1, row[j] + 1, diagonal + (same_letter(a[i], b[j]) ? 0 : 1)});
      diagonal = above;
    }
  }
  return row.back();
}

}  // namespace

std::string suggestion(const std::string& word, std::span<const std::string> known) {
  constexpr std::size_t letters_per_mistake = 3, longest = 64;
  if (word.size() > longest) return {};
  const std::string* best = nullptr;
  std::size_t mistakes = word.size() / letters_per_mistake + 1;
  for (const std::string& one : known)
    if (const std::size_t distance = edit_distance(word, one); distance < mistakes) {
      mistakes = distance;
      best = &one;
    }
  return best ? " (did you mean \"" + *best + "\"?)" : std::string();
}

}  // namespace condyle
