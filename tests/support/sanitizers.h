#pragma once

// Which sanitizers the tests are compiled with: GCC and Clang say it in different ways.
#if defined(__SANITIZE_ADDRESS__)
#define CONDYLE_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CONDYLE_ADDRESS_SANITIZER 1
#endif
#endif

#if defined(__SANITIZE_THREAD__)
#define CONDYLE_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define CONDYLE_THREAD_SANITIZER 1
#endif
#endif
