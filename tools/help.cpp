#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "engine/core/error.h"
#include "tools/commands.h"
#include "tools/manual_pages.h"

namespace condyle {
namespace {

/// The first line of a page without the heading mark.
std::string title_of(const ManualPage& page) {
  const std::string line(page.text.substr(0, page.text.find('\n')));
  return line.starts_with("# ") ? line.substr(2) : line;
}

std::string list_of_subjects() {
  std::string list;
  for (const auto& page : manual_pages())
    list += (list.empty() ? "" : ", ") + std::string(page.subject);
  return list;
}

}  // namespace

int run_help(const std::string& subject) {
  const auto pages = manual_pages();
  if (subject.empty()) {
    std::printf("Pages of the manual (condyle help SUBJECT):\n");
    for (const auto& page : pages)
      std::printf("  %-12s %s\n", std::string(page.subject).c_str(), title_of(page).c_str());
    return 0;
  }
  const auto page = std::find_if(pages.begin(), pages.end(),
                                 [&](const ManualPage& each) { return each.subject == subject; });
  if (page == pages.end())
    throw InputError("the manual has no page \"" + subject + "\"; it has " + list_of_subjects());
  std::fwrite(page->text.data(), 1, page->text.size(), stdout);
  return 0;
}

void add_help(Commands& commands) {
  const auto subject = std::make_shared<std::string>();
  CLI::App& command = commands.add("help", "Print a page of the manual, or the list of its pages",
                                   "condyle help motions",
                                   [subject](const CommonOptions&) { return run_help(*subject); });
  command.add_option("SUBJECT", *subject, "Page of the manual (default: list them)");
}

}  // namespace condyle
