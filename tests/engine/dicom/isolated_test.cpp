// Work in a process of its own: what it returns, and what its failures leave.
#include "engine/dicom/isolated.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace condyle {
namespace {

TEST(Isolated, OutputAndMessagesAreReturned) {
  int outside = 1;
  const auto result = run_isolated(1000, [&](char* buffer) {
    std::memset(buffer, 'x', 999);
    outside = 2;
    std::fputs("a message", stderr);
    return true;
  });
  ASSERT_TRUE(result);
  EXPECT_EQ(result->output, std::string(999, 'x') + '\0');
  EXPECT_EQ(result->messages, "a message");
  EXPECT_EQ(outside, 1);
}

TEST(Isolated, FailuresStayInside) {
  EXPECT_FALSE(run_isolated(10, [](char*) { return false; }));
  EXPECT_FALSE(run_isolated(10, [](char*) -> bool { throw std::runtime_error("no"); }));
  EXPECT_FALSE(run_isolated(10, [](char*) -> bool { std::abort(); }));
  EXPECT_FALSE(run_isolated(10, [](char* buffer) {
    std::vector<char> large(std::size_t{1} << 34);
    buffer[0] = large[12345];
    return true;
  }));
}

}  // namespace
}  // namespace condyle
