#pragma once

// ThreadSanitizer does not see the synchronization inside libraries that are compiled without it.
// These two functions state it: what a thread did before it published a token happened before what
// another does after it acquired the token. Without -fsanitize=thread they do nothing.

#ifdef __SANITIZE_THREAD__
extern "C" {
void __tsan_acquire(void* token);
void __tsan_release(void* token);
}
#endif

namespace condyle {

inline void publish_to_sanitizer([[maybe_unused]] void* token) {
#ifdef __SANITIZE_THREAD__
  __tsan_release(token);
#endif
}

inline void acquire_for_sanitizer([[maybe_unused]] void* token) {
#ifdef __SANITIZE_THREAD__
  __tsan_acquire(token);
#endif
}

}  // namespace condyle
