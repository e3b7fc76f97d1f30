#pragma once

#include "tools/command.h"

namespace condyle {

/// Adds `condyle plan compare`.
void add_plan_compare(Commands& commands, CLI::App& plan);

}  // namespace condyle
