#pragma once

#include <memory>

namespace CLI {
class FormatterBase;
}

namespace condyle {

/// The help of the program and its commands: a heading for each group of options, the values that
/// an option takes beside its name, lines of 90 characters at most.
std::shared_ptr<CLI::FormatterBase> help_format();

}  // namespace condyle
