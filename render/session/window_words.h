#pragma once

#include <string>

namespace condyle {

/// A sentence of an error or a note for the window: with the window's controls in place of the
/// command line's options, and with unit symbols.
std::string in_window_words(std::string sentence);

}  // namespace condyle
