#pragma once

#include <optional>

#include "sim/frame/before_operation.h"
#include "sim/operation/operation.h"

namespace condyle {

/// The patient before the operation: `at_rest` with all bodies where they were. Absent where
/// nothing was moved, resected or grafted. `at_rest`: of the operated patient; `uncut`: with its
/// face.
std::optional<BeforeOperation> before_operation(const Operated& operated, const FrameState& at_rest,
                                                const Case& uncut);

}  // namespace condyle
