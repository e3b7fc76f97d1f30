#include "render/output/recorder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "engine/core/error.h"
#include "engine/core/files.h"

namespace condyle {
namespace {
namespace fs = std::filesystem;

class Recording : public testing::Test {
 protected:
  // A % in the folder's name must not be read as a frame number.
  fs::path top = fs::temp_directory_path() / ("condyle rec%03d-" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(top); }
  void TearDown() override {
    fs::permissions(top, fs::perms::owner_all);
    fs::remove_all(top);
  }

  RecorderSettings settings(const std::string& name, int frames = 12) const {
    RecorderSettings s;
    s.folder = top / name;
    s.width = 65;  // odd: the film is padded
    s.height = 48;
    s.frames = frames;
    s.film = have_ffmpeg();
    s.identity = {{"camera", "front"}, {"motion", "opening"}};
    return s;
  }
  static bool have_ffmpeg() { return std::system("ffmpeg -version >/dev/null 2>&1") == 0; }

  static Image frame(const RecorderSettings& s, int k) {
    Image image{s.width, s.height, {}};
    for (int y = 0; y < s.height; ++y)
      for (int x = 0; x < s.width; ++x)
        for (const int value : {x * 3, y * 5, 20 * k, 255})
          image.rgba.push_back(static_cast<std::uint8_t>(value));
    return image;
  }
  /// Draws the missing frames; returns how many.
  static int record(const RecorderSettings& s, int until = 1 << 20, bool finish = true) {
    Recorder recorder(s);
    int drawn = 0;
    for (int k = 0; k < s.frames && k < until; ++k)
      if (!recorder.has(k)) recorder.add(k, frame(s, k)), ++drawn;
    if (finish) recorder.finish();
    return drawn;
  }
  /// Every file by its path in the folder.
  static std::map<std::string, std::string> content(const fs::path& folder) {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file())
        all[fs::relative(entry.path(), folder).string()] = read_file(entry.path());
    return all;
  }
};

TEST_F(Recording, WritesNamedFramesReproducibly) {
  EXPECT_EQ(record(settings("a")), 12);
  EXPECT_EQ(record(settings("b")), 12);
  const auto a = content(top / "a");
  EXPECT_EQ(a, content(top / "b"));
  EXPECT_TRUE(a.contains("frames/000000.png") && a.contains("frames/000011.png"));
  EXPECT_EQ(a.size(), have_ffmpeg() ? 15u : 14u);
}

TEST_F(Recording, AnInterruptedOneIsCompletedBitIdentically) {
  record(settings("whole"));
  record(settings("killed"), 7, false);
  const fs::path frames = top / "killed/frames";
  // State after a kill or a power failure: incomplete temporary files, a torn frame, a missing one.
  write_file(frames / ".000007.png.4711.part", "half");
  write_file(top / "killed/.film.mp4.4711.part", "half");
  const std::string third = read_file(frames / "000003.png");
  std::ofstream(frames / "000003.png", std::ios::binary) << third.substr(0, third.size() / 2);
  fs::remove(frames / "000001.png");
  auto again = settings("killed");
  again.resume = true;
  EXPECT_EQ(record(again), 12 - 7 + 2);
  EXPECT_EQ(content(top / "killed"), content(top / "whole"));
  EXPECT_EQ(record(again), 0);
  EXPECT_EQ(content(top / "killed"), content(top / "whole"));
}

TEST_F(Recording, ExistingFilesAreReportedBeforeItBegins) {
  const auto s = settings("a");
  EXPECT_EQ(recording_there(s).pictures, 0);
  EXPECT_TRUE(recording_there(s).differs.empty());
  record(s, 7, false);
  fs::resize_file(top / "a/frames/000003.png", 40);
  EXPECT_EQ(recording_there(s).pictures, 6) << "complete ones";
  EXPECT_TRUE(recording_there(s).differs.empty());
  auto other = s;
  other.identity["camera"] = "left";
  other.width = 66;
  EXPECT_EQ(recording_there(other).pictures, 7);
  EXPECT_EQ(recording_there(other).differs, (std::vector<std::string>{"camera", "width"}));
  fs::remove(top / "a/recording.json");
  EXPECT_EQ(recording_there(s).pictures, 7);
  EXPECT_FALSE(recording_there(s).differs.empty()) << "of unknown origin";
}

// The encoder accepts no picture until released, and drawing continues meanwhile.
TEST_F(Recording, PicturesAreEncodedWhileDrawing) {
  ASSERT_TRUE(have_ffmpeg()) << "install ffmpeg";
  auto s = settings("a", 4);
  s.width = 400;
  s.height = 300;  // 480 kB: more than a pipe holds
  fs::create_directories(top / "bin");
  const std::string path = std::getenv("PATH");
  write_file(top / "bin/ffmpeg", "#!/bin/sh\nPATH='" + path + "'\ncd '" + top.string() +
                                     "'\nfor i in $(seq 600); do [ -e go ] && break; sleep 0.1; "
                                     "done\n: > reads\nexec ffmpeg \"$@\"\n");
  fs::permissions(top / "bin/ffmpeg", fs::perms::owner_all);
  ::setenv("PATH", ((top / "bin").string() + ":" + path).c_str(), 1);
  {
    Recorder recorder(s);
    for (int k = 0; k < s.frames; ++k) recorder.add(k, frame(s, k));
    EXPECT_FALSE(fs::exists(top / "reads")) << "drawing has waited for the film";
    EXPECT_FALSE(recorder.has(1) || fs::exists(recorder.frame_file(1)))
        << "drawing has waited for a picture's file";
    write_file(top / "go", "");
    recorder.finish();
  }
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_TRUE(fs::exists(top / "reads"));
  const auto beside = content(top / "a");
  auto by_default = s;
  by_default.folder = top / "b";
  record(by_default);
  EXPECT_EQ(beside, content(top / "b"));
}

TEST_F(Recording, ReportsEveryDriverThatDrewItsFrames) {
  const auto draw = [&](const std::string& driver, bool resume, int from, int to) {
    auto s = settings("a");
    s.resume = resume;
    Recorder recorder(s);
    recorder.set_driver(driver);
    for (int i = from; i < to; ++i)
      if (!recorder.has(i)) recorder.add(i, frame(s, i));
    if (to == s.frames) recorder.finish();
    return recorder.drivers();
  };
  EXPECT_EQ(draw("card", false, 0, 4), "card");
  EXPECT_EQ(draw("other", true, 0, 0), "card") << "it has drawn nothing";
  EXPECT_EQ(draw("other", true, 0, 8), "card; other");
  EXPECT_EQ(draw("card", true, 0, 12), "card; other");
  EXPECT_EQ(draw("third", true, 0, 12), "card; other") << "all was there";
  EXPECT_EQ(draw("third", false, 0, 12), "third") << "a new recording";
}

TEST_F(Recording, ResumingAnotherRecordingIsRefusedWithWhatDiffers) {
  record(settings("a"));
  const auto before = content(top / "a");
  auto other = settings("a", 20);
  other.resume = true;
  other.identity["camera"] = "left";
  try {
    const Recorder recorder(other);
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    for (const char* word : {"camera was front, is left", "frames was 12, is 20", "recording.json"})
      EXPECT_NE(text.find(word), std::string::npos) << text;
  }
  EXPECT_EQ(content(top / "a"), before);
}

TEST_F(Recording, EarlierResultsStayUntilTheFirstNewFrameIsReady) {
  record(settings("a"));
  write_file(top / "a/frames/notes.txt", "mine");
  const auto before = content(top / "a");
  auto other = settings("a", 3);
  other.identity["camera"] = "left";
  { const Recorder recorder(other); }
  EXPECT_EQ(content(top / "a"), before);
  record(other);
  const auto after = content(top / "a");
  EXPECT_TRUE(after.contains("frames/000002.png"));
  EXPECT_FALSE(after.contains("frames/000003.png"));
  EXPECT_EQ(after.at("frames/notes.txt"), "mine");
}

TEST_F(Recording, ResumingNothingStartsAndFramesOfUnknownOriginAreNotTrusted) {
  auto s = settings("new");
  s.resume = true;
  fs::create_directories(s.folder / "frames");
  write_png(s.folder / "frames/000000.png", frame(s, 5));
  EXPECT_EQ(record(s), 12);
  record(settings("b"));
  EXPECT_EQ(content(top / "new"), content(top / "b"));
}

TEST_F(Recording, TheFilmHasEveryFrameAndEvenSides) {
  ASSERT_TRUE(have_ffmpeg()) << "install ffmpeg";
  record(settings("a"));
  const std::string command =
      "ffprobe -v error -count_frames -select_streams v -show_entries "
      "stream=nb_read_frames,width,height,pix_fmt,codec_name -of csv=p=0 '" +
      (top / "a/film.mp4").string() + "'";
  FILE* pipe = ::popen(command.c_str(), "r");
  ASSERT_TRUE(pipe);
  char line[200] = "";
  ASSERT_TRUE(std::fgets(line, sizeof line, pipe));
  EXPECT_EQ(::pclose(pipe), 0);
  EXPECT_STREQ(line, "h264,66,48,yuv420p,12\n");
}

TEST_F(Recording, WithoutFfmpegTheFramesStayAndARemedyIsNamed) {
  auto s = settings("a");
  s.film = true;
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  try {
    record(s);
    ADD_FAILURE();
  } catch (const MachineError& error) {
    EXPECT_NE(std::string(error.what()).find("install ffmpeg"), std::string::npos) << error.what();
  }
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(content(top / "a").size(), 14u);
  s.resume = true;
  if (have_ffmpeg()) {
    EXPECT_EQ(record(s), 0);
  }
}

TEST_F(Recording, AFailingFfmpegIsQuotedAndTheOldFilmKept) {
  auto s = settings("a");
  record(s);
  write_file(s.folder / "film.mp4", "old film");
  fs::create_directories(top / "bin");
  write_file(top / "bin/ffmpeg",
             "#!/bin/sh\necho first >&2\necho 'No space left on device' >&2\nexit 1\n");
  fs::permissions(top / "bin/ffmpeg", fs::perms::owner_all);
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", ((top / "bin").string() + ":" + path).c_str(), 1);
  s.film = s.resume = true;
  try {
    record(s);
    ADD_FAILURE();
  } catch (const MachineError& error) {
    EXPECT_NE(std::string(error.what()).find("No space left on device"), std::string::npos);
  }
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(read_file(s.folder / "film.mp4"), "old film");
}

TEST_F(Recording, EachPictureHasItsHash) {
  record(settings("a"));
  const std::string hashes = read_file(top / "a/hashes.csv");
  EXPECT_EQ(std::count(hashes.begin(), hashes.end(), '\n'), 13);
  auto s = settings("b");
  {
    Recorder recorder(s);
    for (int k = 0; k < 12; ++k) {
      Image picture = frame(s, k);
      if (k == 7) picture.rgba[400] ^= 1;
      recorder.add(k, std::move(picture));
    }
    recorder.finish();
  }
  std::istringstream one(hashes), other(read_file(top / "b/hashes.csv"));
  std::string a, b;
  for (int line = 0; std::getline(one, a) && std::getline(other, b); ++line)
    EXPECT_EQ(a == b, line != 8) << line;  // the head, then frames from 0
}

TEST_F(Recording, AFolderThatCannotBeWrittenIsNamed) {
  auto s = settings("a");
  s.folder = "/proc/condyle-cannot/out";
  EXPECT_THROW(Recorder{s}, MachineError);
  write_file(top / "file", "in the way");
  s.folder = top / "file";
  EXPECT_THROW(Recorder{s}, MachineError);
}

TEST_F(Recording, AFrameThatCannotBeWrittenStopsTheRecordingWithItsName) {
  const auto s = settings("a");
  fs::create_directories(s.folder / "frames/000002.png/in the way");
  try {
    record(s);
    FAIL();
  } catch (const MachineError& error) {
    EXPECT_NE(std::string(error.what()).find("000002.png"), std::string::npos) << error.what();
  }
}

TEST_F(Recording, APictureOfAnotherSizeIsRefused) {
  const auto s = settings("a");
  auto small = s;
  small.width = 10;
  Recorder recorder(s);
  EXPECT_THROW(recorder.add(0, frame(small, 0)), MachineError);
  EXPECT_THROW(recorder.add(99, frame(s, 0)), MachineError);
  EXPECT_THROW(recorder.finish(), MachineError);  // frames are missing
}

}  // namespace
}  // namespace condyle
