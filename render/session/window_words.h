#pragma once

#include <string>

namespace condyle {

/// A sentence of an error or a note as the window says it: with what the window offers in place of
/// the command line's options, and with signs of units.
std::string in_window_words(std::string sentence);

}  // namespace condyle
