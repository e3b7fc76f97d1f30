#pragma once

#include <cassert>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace condyle {

// Reading of tables of numbers in text, one row a line. Every problem is an InputError that names
// the file, the line, the column and the value.

/// Without blanks, line ends and quotes round it.
std::string_view trimmed(std::string_view text);

/// At most 40 characters, printable: for messages.
std::string shortened(std::string_view text);

std::string lower_case(std::string_view text);

/// Separated by `separator`, each trimmed; by any run of blanks where it is ' '.
std::vector<std::string_view> fields_of(std::string_view line, char separator);

/// A finite number, the whole text. throws: InputError.
double parse_number(const std::filesystem::path& file, const std::string& item,
                    std::string_view text);

/// The lines of a text, counted from 1; a byte order mark is passed over.
class TextLines {
 public:
  explicit TextLines(std::string_view text);
  /// False at the end. Line ends are not part of the line.
  bool next();
  /// The next line that is not blank.
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
  std::vector<std::size_t> lines;  // where each row stands
  std::size_t header_line = 1;     // where the names stand

  std::size_t rows() const { return lines.size(); }
  double at(std::size_t row, std::size_t column) const {
    assert(row < rows() && column < names.size());
    return values[row * names.size() + column];
  }
  std::string where(std::size_t row, std::size_t column) const;  // "line 3, tx_mm"
};

/// Reads the rows that follow in `lines`, all of them as wide as `names`; what stands in columns
/// whose number is not among `selected` is passed over (0 in the table); all count when it is
/// empty.
NumberTable read_rows(const std::filesystem::path& file, TextLines& lines,
                      std::vector<std::string> names, char separator,
                      std::span<const std::size_t> selected = {});

/// Refuses times (column `time`) that do not increase, or that span more than a day.
void check_times(const std::filesystem::path& file, const NumberTable& table, std::size_t time);

}  // namespace condyle
