#include "render/image/image.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <random>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "render/output/recording_sheet.h"
#include "tests/support/picture.h"

namespace condyle {
namespace {
namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("condyle-image-" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

Image noise(int width, int height, bool opaque = false) {
  Image image{width, height, {}};
  std::mt19937 random(7);
  image.rgba.resize(std::size_t{4} * width * height);
  for (auto& byte : image.rgba) byte = static_cast<std::uint8_t>(random());
  for (std::size_t i = 3; opaque && i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return image;
}

TEST(Png, RoundTrips) {
  const Folder folder;
  for (const bool opaque : {false, true})
    for (const auto& [w, h] : {std::pair{1, 1}, {37, 11}, {640, 480}}) {
      const Image image = noise(w, h, opaque);
      write_png(folder.path / "a.png", image);
      const Image again = read_png(folder.path / "a.png");
      EXPECT_EQ(again.width, w);
      EXPECT_EQ(again.height, h);
      EXPECT_TRUE(test::same_bytes(again, image));
      EXPECT_EQ(encode_png(image), encode_png(again));
      EXPECT_TRUE(is_whole_png(folder.path / "a.png", w, h));
      EXPECT_FALSE(is_whole_png(folder.path / "a.png", w + 1, h));
    }
}

TEST(Png, AnyCutAndAnyFlippedByteOfTheDataIsSeen) {
  const Folder folder;
  const fs::path file = folder.path / "a.png";
  const std::string bytes = encode_png(noise(40, 30));
  int cuts = 0, flips = 0;
  for (std::size_t size = 0; size + 1 < bytes.size(); size += 97, ++cuts) {
    write_file(file, bytes.substr(0, size));
    EXPECT_FALSE(is_whole_png(file, 40, 30)) << size;
    if (size + 16 < bytes.size()) {
      EXPECT_THROW(read_png(file), InputError) << size;
    }
  }
  for (std::size_t at = 0; at < bytes.size(); at += 131, ++flips) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x20);
    write_file(file, flipped);
    EXPECT_FALSE(is_whole_png(file, 40, 30)) << at;
  }
  EXPECT_GT(cuts, 20);
  EXPECT_GT(flips, 20);
}

TEST(Png, AFileThatIsNoPngIsRefusedByName) {
  const Folder folder;
  write_file(folder.path / "text.png", "not a picture");
  for (const char* name : {"text.png", "absent.png", "."}) try {
      read_png(folder.path / name);
      FAIL() << name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(folder.path.string()), std::string::npos);
    }
}

TEST(Png, AHugeHeaderIsRefusedBeforeAnyMemoryIsTaken) {
  const Folder folder;
  std::string bytes = encode_png(noise(4, 4));
  bytes[16] = '\x00', bytes[17] = '\x01';  // 65540 wide; the header's checksum is wrong as well
  write_file(folder.path / "huge.png", bytes);
  EXPECT_THROW(read_png(folder.path / "huge.png"), InputError);
}

TEST(Png, AnUnwritableFolderIsAMachineError) {
  EXPECT_THROW(write_png("/proc/condyle-cannot/a.png", noise(2, 2)), MachineError);
}

}  // namespace
}  // namespace condyle
