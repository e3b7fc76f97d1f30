#pragma once

#include <span>
#include <string_view>

namespace condyle {

/// A page of the manual, embedded in the program from tools/manual/SUBJECT.md.
struct ManualPage {
  std::string_view subject, text;
};
/// In alphabetical order.
std::span<const ManualPage> manual_pages();

}  // namespace condyle
