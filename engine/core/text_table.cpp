#include "engine/core/text_table.h"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "engine/core/error.h"

namespace condyle {
namespace {

constexpr std::size_t max_shown = 40;
constexpr double longest_s = 86400;

std::string text_of(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '"';
  };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string shortened(std::string_view text) {
  std::string out(text.substr(0, max_shown));
  for (char& c : out)
    if (!std::isprint(static_cast<unsigned char>(c))) c = '?';
  return text.size() <= max_shown ? out : out + "...";
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

std::vector<std::string_view> fields_of(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  if (separator != ' ') {
    for (;;) {
      const std::size_t end = line.find(separator);
      fields.push_back(trimmed(line.substr(0, end)));
      if (end == std::string_view::npos) return fields;
      line.remove_prefix(end + 1);
    }
  }
  constexpr std::string_view blanks = " \t\r";
  for (;;) {
    const std::size_t start = line.find_first_not_of(blanks);
    if (start == std::string_view::npos) return fields;
    line.remove_prefix(start);
    const std::size_t end = std::min(line.find_first_of(blanks), line.size());
    fields.push_back(trimmed(line.substr(0, end)));
    line.remove_prefix(end);
  }
}

double parse_number(const std::filesystem::path& file, const std::string& item,
                    std::string_view text) {
  std::string_view digits = text;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size())
    throw InputError(file, item, "\"" + shortened(text) + "\" is not a number");
  if (!std::isfinite(value))
    throw InputError(file, item, shortened(text) + " is not a finite number");
  return value;
}

TextLines::TextLines(std::string_view text) : rest_(text) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
}

bool TextLines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  line_ = rest_.substr(0, end);
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++number_;
  return true;
}

bool TextLines::next_filled() {
  while (next())
    if (!trimmed(line_).empty()) return true;
  return false;
}

std::string TextLines::where() const { return "line " + std::to_string(number_); }

std::string NumberTable::where(std::size_t row, std::size_t column) const {
  return "line " + std::to_string(lines[row]) + ", " + shortened(names[column]);
}

NumberTable read_rows(const std::filesystem::path& file, TextLines& lines,
                      std::vector<std::string> names, char separator,
                      std::span<const std::size_t> selected) {
  NumberTable table;
  table.names = std::move(names);
  const std::size_t columns = table.names.size();
  assert(std::all_of(selected.begin(), selected.end(), [&](std::size_t c) { return c < columns; }));
  const std::size_t needed =
      selected.empty() ? columns : *std::max_element(selected.begin(), selected.end()) + 1;
  while (lines.next_filled()) {
    const auto fields = fields_of(lines.line(), separator);
    if (fields.size() < needed)
      throw InputError(file, lines.where(),
                       std::to_string(fields.size()) + " values where at least " +
                           std::to_string(needed) + " are needed (\"" +
                           shortened(trimmed(lines.line())) + "\"); the file may be cut off");
    const std::size_t first = table.values.size();
    table.values.resize(first + columns, 0.0);
    const auto take = [&](std::size_t c) {
      table.values[first + c] =
          parse_number(file, lines.where() + ", " + shortened(table.names[c]), fields[c]);
    };
    if (selected.empty())
      for (std::size_t c = 0; c < columns; ++c) take(c);
    else
      for (const std::size_t c : selected) take(c);
    table.lines.push_back(lines.number());
  }
  return table;
}

void check_times(const std::filesystem::path& file, const NumberTable& table, std::size_t time) {
  for (std::size_t r = 1; r < table.rows(); ++r) {
    const double now = table.at(r, time), before = table.at(r - 1, time);
    if (!(now > before))
      throw InputError(file, table.where(r, time),
                       text_of(now) + " does not come after " + text_of(before) +
                           " of the row before; sort the rows by time");
    if (now - table.at(0, time) > longest_s)
      throw InputError(file, table.where(r, time),
                       text_of(now) + " is more than " + text_of(longest_s) +
                           " s after the first row; times are in seconds");
  }
}

}  // namespace condyle
