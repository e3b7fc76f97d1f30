#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/text_table.h"

// Only for this module.
namespace condyle {

/// One row of a table with named columns. Errors name file, line and column. The columns must
/// outlive it.
class TableRow {
 public:
  /// throws: InputError where the row has fewer values than columns.
  TableRow(const std::filesystem::path& file, const TextLines& lines,
           const std::map<std::string, std::size_t>& columns)
      : file_(file),
        where_(lines.where()),
        columns_(columns),
        fields_(fields_of(lines.line(), ',')) {
    if (fields_.size() < columns.size())
      throw InputError(file, where_,
                       fmt::format("{} values instead of {}; the file may be cut off",
                                   fields_.size(), columns.size()));
  }
  /// Empty where the table lacks the column.
  std::string text(const std::string& column) const {
    const auto at = columns_.find(column);
    return at == columns_.end() ? "" : std::string(fields_[at->second]);
  }
  double number(const std::string& column, double low, double high) const {
    const double value = parse_number(file_, item(column), text(column));
    if (!(value >= low && value <= high))
      refuse(column, fmt::format("{} is not between {} and {}", value, low, high));
    return value;
  }
  double number_or(const std::string& column, double by_default, double low, double high) const {
    return text(column).empty() ? by_default : number(column, low, high);
  }
  /// The value of the choice that the column names.
  template <class T>
  T chosen(const std::string& column, const std::vector<std::pair<const char*, T>>& choices) const {
    const std::string given = lower_case(text(column));
    std::string known;
    for (const auto& [name, value] : choices) {
      if (given == name) return value;
      if (*name) known += (known.empty() ? "" : ", ") + std::string(name);
    }
    refuse(column, "\"" + shortened(text(column)) + "\" is not one of " + known);
  }
  [[noreturn]] void refuse(const std::string& column, const std::string& problem) const {
    throw InputError(file_, item(column), problem);
  }

 private:
  std::string item(const std::string& column) const { return where_ + ", " + column; }
  const std::filesystem::path& file_;
  std::string where_;
  const std::map<std::string, std::size_t>& columns_;
  std::vector<std::string_view> fields_;
};

}  // namespace condyle
