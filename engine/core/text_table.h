#pragma once

#include <cassert>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace condyle {

// Reading of tables of numbers in text, one row per line. Every problem is an InputError that names
// the file, the line, the column and the value.

/// The text without surrounding blanks, line ends and quotes.
std::string_view trimmed(std::string_view text);

/// At most 40 printable characters of the text, for messages.
std::string shortened(std::string_view text);

std::string lower_case(std::string_view text);

/// The fields of a line between `separator`s, trimmed; ' ' stands for any run of blanks.
std::vector<std::string_view> fields_of(std::string_view line, char separator);

/// A finite number, the whole text. throws: InputError.
double parse_number(const std::filesystem::path& file, const std::string& item,
                    std::string_view text);

/// The lines of a text, counted from 1; a byte order mark is skipped.
class TextLines {
 public:
  explicit TextLines(std::string_view text);
  /// Goes to the next line; false at the end. Line ends are not part of the line.
  bool next();
  /// Goes to the next line that is not blank.
  bool next_filled();
  std::string_view line() const { return line_; }
  std::size_t number() const { return number_; }
  std::string where() const;  // "line 3"

 private:
  std::string_view rest_, line_;
  std::size_t number_ = 0;
};

/// Columns of numbers: the value of column c in row r is values[r * names.size() + c].
struct NumberTable {
  std::vector<std::string> names;
  std::vector<double> values;
  std::vector<std::size_t> lines;  // line number of each row
  std::size_t header_line = 1;     // line number of the names

  std::size_t rows() const { return lines.size(); }
  double at(std::size_t row, std::size_t column) const {
    assert(row < rows() && column < names.size());
    return values[row * names.size() + column];
  }
  std::string where(std::size_t row, std::size_t column) const;  // "line 3, tx_mm"
};

/// Reads the remaining rows of `lines`, each as wide as `names`. Columns that are not in `selected`
/// are skipped (0 in the table); an empty `selected` means all.
NumberTable read_rows(const std::filesystem::path& file, TextLines& lines,
                      std::vector<std::string> names, char separator,
                      std::span<const std::size_t> selected = {});

/// Refuses times (column `time`) that do not increase, or that span more than a day.
void check_times(const std::filesystem::path& file, const NumberTable& table, std::size_t time);

}  // namespace condyle
