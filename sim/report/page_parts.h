#pragma once

#include <string>

namespace condyle {

/// Start of a page for people, HTML without scripts, in the style of the house: up to and with
/// <body>. Classes: verdict (good, bad), small; td.bad.
std::string page_head(const std::string& title);

/// Its end, with what it may not be used for.
std::string page_foot();

}  // namespace condyle
