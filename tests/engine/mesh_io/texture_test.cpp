#include "engine/mesh_io/texture.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh_io/mesh_files.h"
#include "tests/support/places.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

class Textures : public testing::Test {
 protected:
  fs::path top = fs::temp_directory_path() / ("condyle-texture-" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(top); }
  void TearDown() override { fs::remove_all(top); }

  /// A square of 2 in x and z, the left half red, the right one blue, as an OBJ with its picture.
  void write_square(const std::string& picture) {
    write_file(top / "square.obj",
               "mtllib square.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\n"
               "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    write_file(top / "square.mtl", "newmtl skin\nKd 1 1 1\nmap_Kd picture.png\n");
    write_file(top / "picture.png", picture);
  }
};

// 4 x 2 pixels: two red, two blue; the lower row half as bright.
const unsigned char red_blue[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52,
    0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xf0, 0xca, 0xea,
    0x34, 0x00, 0x00, 0x00, 0x17, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0xf8, 0xcf, 0xc0, 0x00,
    0x44, 0x60, 0xe2, 0x3f, 0x43, 0x03, 0x03, 0x08, 0x81, 0x89, 0x06, 0x00, 0x5a, 0xcc, 0x05, 0xfd,
    0x5e, 0x5d, 0xe2, 0x41, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

TEST_F(Textures, AnObjUsesItsMaterialsTextureUpright) {
  write_square(std::string(reinterpret_cast<const char*>(red_blue), sizeof red_blue));
  const auto texture = read_texture(top / "square.obj");
  ASSERT_TRUE(texture);
  EXPECT_EQ(texture->width, 4);
  EXPECT_EQ(texture->height, 2);
  EXPECT_EQ(texture->corners.size(), 3 * texture->surface.triangles.size());
  TriMesh probes;
  probes.vertices = {{-1, 0, 1}, {1, 0, 1}, {-1, 0, -1}, {1, 0, -1}};
  for (auto& p : probes.vertices) p *= 0.5 * 10;  // the file is in cm
  paint(probes, *texture, Eigen::Affine3d(10 * Eigen::Matrix3d::Identity()));
  const auto is = [&](std::size_t v, float r, float g, float b) {
    EXPECT_LT((probes.colors[v] - Eigen::Vector3f(r, g, b)).norm(), 0.02) << v;
  };
  is(0, 1, 0, 0);
  is(1, 0, 0, 1);
  is(2, .5f, 0, 0);
  is(3, 0, 0, .5f);
}

TEST_F(Textures, WithoutAPictureThereIsNoneAndADamagedOneIsNamed) {
  write_square("no picture");
  EXPECT_THROW(read_texture(top / "square.obj"), InputError);
  fs::remove(top / "picture.png");
  EXPECT_FALSE(read_texture(top / "square.obj"));
  fs::remove(top / "square.mtl");
  EXPECT_FALSE(read_texture(top / "square.obj"));
  EXPECT_EQ(read_mesh(top / "square.obj").triangles.size(), 2u);
}

TEST_F(Textures, ATextureThatIsTooLargeIsRefusedBeforeItIsRead) {
  std::string huge(reinterpret_cast<const char*>(red_blue), sizeof red_blue);
  huge[18] = 0x60;  // 24,576 pixels wide, according to its header
  huge[19] = 0;
  write_square(huge);
  try {
    read_texture(top / "square.obj");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("24576x2"), std::string::npos) << error.what();
  }
}

TEST_F(Textures, APictureTooLargeForItsReaderIsCalledLarge) {
  // Only the header matters: 20000 x 20000, 8 bits, RGB.
  std::string huge("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0N \0\0N \b\2\0\0\0", 29);
  huge.resize(100, '\0');
  write_square(huge);
  try {
    read_texture(top / "square.obj");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("too large: 20000x20000"), std::string::npos)
        << error.what();
  }
}

TEST_F(Textures, GlbAndObjOfAScanHaveTheSameColours) {
  const fs::path folder = test::source_folder() / "../shared/data/scan-leeperrysmith";
  if (!fs::exists(folder)) GTEST_SKIP() << "real anatomy absent";
  const auto glb = read_texture(folder / "LeePerrySmith.glb"),
             obj = read_texture(folder / "head_lps_mm.obj");
  ASSERT_TRUE(glb && obj);
  EXPECT_FALSE(read_texture(folder / "head_lps_mm.ply"));
  TriMesh face = read_mesh(folder / "head_lps_mm.obj"), same = face;
  paint(face, *obj, Eigen::Affine3d::Identity());
  Eigen::Matrix3d to_lps;  // x left, y superior, z anterior, in metres
  to_lps << 1000, 0, 0, 0, 0, -1000, 0, 1000, 0;
  paint(same, *glb, Eigen::Affine3d(to_lps));
  std::size_t alike = 0;
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (std::size_t v = 0; v < face.vertices.size(); ++v) {
    alike += (face.colors[v] - same.colors[v]).norm() < 0.06f;
    mean += face.colors[v] / static_cast<float>(face.colors.size());
  }
  EXPECT_GT(alike, 0.98 * static_cast<double>(face.vertices.size()));
  EXPECT_GT(mean.x(), mean.y() + 0.03f);  // skin
  EXPECT_GT(mean.y(), mean.z());
}

}  // namespace
}  // namespace condyle
