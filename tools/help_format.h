#pragma once

#include <memory>

namespace CLI {
class FormatterBase;
}

namespace condyle {

/// The help of the program and its commands: a heading for each group of options, the values of an
/// option beside its name, lines of at most 90 characters.
std::shared_ptr<CLI::FormatterBase> help_format();

}  // namespace condyle
