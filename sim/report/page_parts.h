#pragma once

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace condyle {

/// Builds one HTML page without scripts, with the style sheet of all reports. Classes: verdict
/// (good, bad), small; td.bad.
class PageWriter {
 public:
  explicit PageWriter(const std::string& title);

  /// Appends formatted HTML.
  template <class... Args>
  void add(fmt::format_string<Args...> text, Args&&... args) {
    fmt::format_to(std::back_inserter(html_), text, std::forward<Args>(args)...);
  }
  /// Appends HTML verbatim.
  PageWriter& operator+=(std::string_view html);

  /// Appends one list item per note, escaped.
  void add_notes(const std::vector<std::string>& notes);

  /// The whole page, ended with the disclaimer. The writer is empty afterwards.
  std::string finish();

 private:
  std::string html_;
};

}  // namespace condyle
