#pragma once

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace condyle {

/// Reads a text line by line and word by word, without copies; LF, CRLF and CR end a line.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// Goes to the next line; false at the end. `number` counts from 1.
  bool next() {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find_first_of("\n\r");
    line_ = rest_.substr(0, end);
    if (end == std::string_view::npos) {
      rest_ = {};
    } else {
      const bool crlf = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
      rest_.remove_prefix(end + (crlf ? 2 : 1));
    }
    ++number_;
    return true;
  }
  /// Next word of the line, empty at its end.
  std::string_view word() {
    const std::size_t start = line_.find_first_not_of(" \t");
    if (start == std::string_view::npos) {
      line_ = {};
      return {};
    }
    line_.remove_prefix(start);
    const std::size_t end = std::min(line_.find_first_of(" \t"), line_.size());
    const std::string_view found = line_.substr(0, end);
    line_.remove_prefix(end);
    return found;
  }
  std::string_view line() const { return line_; }  // the rest of the line
  std::string_view rest() const { return rest_; }  // the lines after it
  long number() const { return number_; }
  std::string where() const { return "line " + std::to_string(number_); }

 private:
  std::string_view rest_, line_;
  long number_ = 0;
};

/// The whole word as a number, absent if it is none ("nan" and "inf" are numbers here).
template <class T>
std::optional<T> to_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  // Too large or small for a double: an infinity or zero, which the range check reports.
  if (error == std::errc::result_out_of_range && std::is_floating_point_v<T>)
    return word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos
               ? T{0}
               : std::numeric_limits<T>::infinity();
  if (error != std::errc{}) return std::nullopt;
  return value;
}

/// A word of the file for a message: printable and short.
std::string in_quotes(std::string_view word);

}  // namespace condyle
