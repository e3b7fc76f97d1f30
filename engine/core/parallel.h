#pragma once

#include <cstddef>
#include <functional>

namespace condyle {

/// Calls body(i) for i in [0, count) on at most `threads` threads. Which thread runs which index is
/// not fixed: bodies must write to separate locations, and sums are formed afterwards in index
/// order.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

}  // namespace condyle
