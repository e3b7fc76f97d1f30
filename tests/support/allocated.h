#pragma once

#include <malloc.h>

#include <cstddef>

#include "tests/support/sanitizers.h"

#if defined(CONDYLE_ADDRESS_SANITIZER) || defined(CONDYLE_THREAD_SANITIZER)
extern "C" std::size_t __sanitizer_get_current_allocated_bytes();  // their own allocator's
#endif

namespace condyle {

/// Bytes of the heap in use.
inline std::size_t allocated_bytes() {
#if defined(CONDYLE_ADDRESS_SANITIZER) || defined(CONDYLE_THREAD_SANITIZER)
  return __sanitizer_get_current_allocated_bytes();
#else
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
#endif
}

}  // namespace condyle
