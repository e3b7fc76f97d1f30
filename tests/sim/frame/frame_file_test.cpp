#include "sim/frame/frame_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include "engine/core/error.h"
#include "sim/frame/frame_fields.h"
#include "sim/frame/state_hash.h"

namespace condyle {
namespace {

/// Gives every field of a frame another value.
class Scrambler {
 public:
  template <class T>
  void operator()(T& value) {
    ++fields;
    if (fields - 1 != only && only >= 0) return;
    if constexpr (std::is_same_v<T, bool>)
      value = !value;
    else if constexpr (std::is_enum_v<T>)
      value = PairPolicy::guided;
    else if constexpr (std::is_arithmetic_v<T>)
      value += static_cast<T>(1 + random_() % 1000);
    else
      value = value.array() + static_cast<typename T::Scalar>(random_() % 1000) / 7 + 1;
  }
  template <class List>
  void size_of(List& list) {
    if (only < 0) list.resize(3);
  }
  template <class List>
  void values(List& list) {
    size_of(list);
    for (auto& value : list) (*this)(value);
  }

  int only = -1;  // none: all, and lists get lengths
  int fields = 0;

 private:
  std::mt19937 random_{11};
};

FrameState full_frame() {
  FrameState frame;
  visit_frame(frame, Scrambler());
  frame.times[Stage::contact] = 1.5;
  frame.lids = {-0.25, 0.75};
  frame.state_hash = state_hash(frame);
  return frame;
}

std::string refusal(const std::string& bytes) {
  try {
    frame_of_bytes(bytes, "jaw.frame");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(FrameFile, AFrameRoundTripsBitIdentically) {
  const FrameState frame = full_frame();
  const std::string bytes = frame_bytes(frame);
  const FrameState read = frame_of_bytes(bytes, "jaw.frame");
  EXPECT_EQ(frame_bytes(read), bytes);
  EXPECT_EQ(state_hash(read), frame.state_hash);
  EXPECT_EQ(read.state_hash, frame.state_hash);
  EXPECT_EQ(read.times[Stage::contact], 1.5);
  EXPECT_EQ(read.lids, frame.lids);
  EXPECT_EQ(read.poses.X_CB.size(), 3u);
  EXPECT_EQ(read.contacts.pairs[2].contacts.size(), 3u);
  EXPECT_EQ(read.face[2], frame.face[2]);
  EXPECT_NE(read.measures.opening_mm, 0);
}

TEST(FrameFile, TheHashDependsOnEveryFieldButMeasuredTimes) {
  const FrameState frame = full_frame();
  Scrambler counter;
  counter.only = 1 << 30;
  FrameState counted = frame;
  visit_frame(counted, counter);
  EXPECT_EQ(state_hash(counted), frame.state_hash);
  ASSERT_GT(counter.fields, 100);
  for (int field = 0; field < counter.fields; ++field) {
    FrameState other = frame;
    Scrambler one;
    one.only = field;
    visit_frame(other, one);
    if (state_hash(other) == frame.state_hash) {
      EXPECT_EQ(frame_bytes(other), frame_bytes(frame)) << field;  // it had that value already
    }
  }
  FrameState later = frame;
  later.times[Stage::tissue] += 1;
  EXPECT_EQ(state_hash(later), frame.state_hash);
}

TEST(FrameFile, DamagedFilesAreRefusedWithTheirName) {
  const std::string bytes = frame_bytes(full_frame());
  for (std::size_t size = 0; size < bytes.size(); size += 13)
    EXPECT_NE(refusal(bytes.substr(0, size)).find("jaw.frame"), std::string::npos) << size;
  EXPECT_NE(refusal(bytes + "x").find("1 bytes follow"), std::string::npos);
  EXPECT_NE(refusal("PNG").find("is not a Condyle frame"), std::string::npos);
  for (const char version : {2, 7}) {
    std::string other = bytes;
    other[8] = version;
    EXPECT_NE(
        refusal(other).find("is " + std::to_string(version) + "; this program reads version 3"),
        std::string::npos);
  }
  constexpr std::size_t lids_begin = 8 + 4 + 6 * 8, state_begins = lids_begin + 2 * 8;
  std::string lids = bytes;
  lids[lids_begin + 7] ^= 0x40;  // a huge number
  EXPECT_NE(refusal(lids).find("closure of lids"), std::string::npos) << refusal(lids);
  for (const double closure : {std::nan(""), -1.25, 1.25}) {
    std::memcpy(&lids[lids_begin], &closure, sizeof closure);
    EXPECT_NE(refusal(lids).find("closure of lids"), std::string::npos) << refusal(lids);
  }
  for (std::size_t at = state_begins; at + 16 < bytes.size(); at += 7) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    EXPECT_NE(refusal(flipped), "") << at;
  }
}

}  // namespace condyle
