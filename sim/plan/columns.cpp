#include "sim/plan/columns.h"

#include <algorithm>

namespace condyle {
namespace {

/// Number of characters of UTF-8.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

std::string aligned_columns(const std::vector<std::vector<std::string>>& rows,
                            const std::string& alignment) {
  std::vector<std::size_t> widths(alignment.size());
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size() && c < widths.size(); ++c)
      widths[c] = std::max(widths[c], width_of(row[c]));
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size() && c < widths.size(); ++c) {
      const std::string fill(widths[c] - width_of(row[c]), ' ');
      line += (c == 0 ? "" : "  ") + (alignment[c] == 'r' ? fill + row[c] : row[c] + fill);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace condyle
