#include "engine/core/buffer_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

namespace condyle {
namespace {

TEST(BufferPool, AReturnedBufferIsUsedNext) {
  const BufferPool<float> pool(100);
  auto first = pool.take();
  EXPECT_TRUE(std::all_of(first.get(), first.get() + 100, [](float f) { return f == 0; }));
  first[7] = 3;
  const float* const where = first.get();
  const auto other = pool.take();
  EXPECT_NE(other.get(), where);
  first.reset();
  const auto again = pool.take();
  EXPECT_EQ(again.get(), where);
  EXPECT_EQ(again[7], 3);
}

TEST(BufferPool, BuffersOutliveIt) {
  BufferPool<int>::Buffer kept;
  {
    const BufferPool<int> pool(10);
    kept = pool.take();
  }
  kept[9] = 1;
  EXPECT_EQ(kept[9], 1);
}

TEST(BufferPool, NoBufferIsLentTwice) {
  const BufferPool<int> pool(1);
  bool alone[2] = {true, true};
  const auto use = [&](int who) {
    for (int i = 0; i < 20000; ++i) {
      const auto buffer = pool.take();
      buffer[0] = who;
      std::this_thread::yield();
      alone[who] = alone[who] && buffer[0] == who;
    }
  };
  std::thread one(use, 0), two(use, 1);
  one.join();
  two.join();
  EXPECT_TRUE(alone[0] && alone[1]);
}

}  // namespace
}  // namespace condyle
