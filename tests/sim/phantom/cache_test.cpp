#include "sim/phantom/cache.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

class Cache : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("condyle-cache-test-" + std::to_string(::getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Case get(const std::string& name = "someone") {
    return cached_case(folder_, name, [&] {
      ++made_;
      Case one;
      one.name = name;
      Part part;
      part.name = "mandible";
      part.role = Role::mandible;
      part.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.2, 1.0 / 3}};
      part.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
      part.mesh.colors.assign(4, Eigen::Vector3f(0.1f, 0.2f, 1.0f / 3));
      one.parts = {part};
      one.landmarks.points["menton"] = {0.1, 1.0 / 7, 3};
      one.condylar_path = CondylarPath{{0, 1}, {0, 1.0 / 3}};
      one.canals = {{"canal", mandible_body, 3, {{0, 0, 0}, {0, 1.0 / 7, 1}}}};
      return one;
    });
  }

  fs::path folder_;
  int made_ = 0;
};

TEST_F(Cache, RoundTripsBitIdentically) {
  const Case first = get(), second = get();
  EXPECT_EQ(made_, 1);
  EXPECT_EQ(mesh_hash(first.parts[0].mesh), mesh_hash(second.parts[0].mesh));
  EXPECT_EQ(first.landmarks.points, second.landmarks.points);
  EXPECT_EQ(first.condylar_path->inferior_mm, second.condylar_path->inferior_mm);
  EXPECT_EQ(second.name, "someone");
}

TEST_F(Cache, AnotherNameIsAnotherCase) {
  get("one");
  EXPECT_EQ(get("two").name, "two");
  EXPECT_EQ(made_, 2);
}

TEST_F(Cache, AnyDamagedFileIsRebuilt) {
  get();
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder_))
    if (entry.is_regular_file()) files.push_back(entry.path());
  ASSERT_GE(files.size(), 4u);  // mesh, landmarks, case.json, seal
  for (const auto& file : files) {
    for (const bool cut : {true, false}) {
      const auto size = fs::file_size(file);
      if (cut) {
        fs::resize_file(file, size / 2);
      } else {
        std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
        bytes.seekg(static_cast<std::streamoff>(size / 2));
        const char old = static_cast<char>(bytes.get());
        bytes.seekp(static_cast<std::streamoff>(size / 2));
        bytes.put(static_cast<char>(old ^ 0x11));
      }
      const int before = made_;
      const Case again = get();
      EXPECT_EQ(again.landmarks.points.at("menton"), Eigen::Vector3d(0.1, 1.0 / 7, 3));
      EXPECT_EQ(again.parts[0].mesh.vertices[3].z(), 1.0 / 3);
      EXPECT_EQ(again.canals.at(0).points.at(1).y(), 1.0 / 7);
      if (cut) {
        EXPECT_EQ(made_, before + 1) << file;
      }
      get();
      EXPECT_LE(made_, before + 1) << file;  // mended
    }
  }
}

TEST_F(Cache, UnwritableFolderIsNoError) {
  std::ofstream(folder_) << "a file where the folder should be";
  EXPECT_EQ(get().name, "someone");
  EXPECT_EQ(get().name, "someone");
  EXPECT_EQ(made_, 2);
}

TEST_F(Cache, ExceptionsOfTheBuilderPropagate) {
  EXPECT_THROW(
      cached_case(folder_, "nobody", []() -> Case { throw std::runtime_error("cancelled"); }),
      std::runtime_error);
}

}  // namespace
}  // namespace condyle
