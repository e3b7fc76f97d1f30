#include "engine/core/made_once.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace condyle {
namespace {

struct Source {
  std::atomic<int>* asked = nullptr;
  int fails = 0;
  std::vector<int> numbers;
};

struct Sum {
  explicit Sum(const Source& source) {
    if ((*source.asked)++ < source.fails) throw std::runtime_error("not yet");
    for (const int number : source.numbers) value += number;
  }
  int value = 0;
};

TEST(MadeOnce, IsMadeWhenFirstAskedForByOneOfTheThreads) {
  std::atomic<int> asked = 0;
  const MadeOnce<Sum, Source> sum(Source{&asked, 0, {1, 2, 3}});
  EXPECT_EQ(asked, 0);
  std::atomic<int> right = 0;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i) threads.emplace_back([&] { right += sum.get().value == 6; });
  }
  EXPECT_EQ(right, 8);
  EXPECT_EQ(asked, 1);
}

TEST(MadeOnce, IsMadeAgainAfterAFailure) {
  std::atomic<int> asked = 0;
  const MadeOnce<Sum, Source> sum(Source{&asked, 1, {4, 5}});
  EXPECT_THROW(sum.get(), std::runtime_error);
  EXPECT_EQ(sum.get().value, 9);
  EXPECT_EQ(sum.get().value, 9);
  EXPECT_EQ(asked, 2);
}

}  // namespace
}  // namespace condyle
