#include <gtest/gtest.h>

#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "engine/mesh_io/mesh_files.h"
#include "tests/engine/mesh_io/samples.h"

namespace condyle {
namespace {

using test::arbitrary_pose;
using test::single_precision;
using test::TempFolder;

const TriMesh& ball() {
  static const TriMesh mesh = single_precision(test::moved(test::sphere(3, 40), arbitrary_pose(1)));
  return mesh;
}

void expect_same(const TriMesh& a, const TriMesh& b) {
  EXPECT_EQ(a.triangles, b.triangles);
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t i = 0; i < a.vertices.size(); ++i) ASSERT_EQ(a.vertices[i], b.vertices[i]);
}

TEST(ReadMesh, EveryFormatRoundTripsBitIdentically) {
  const TempFolder folder;
  for (const auto& [name, content] :
       {std::pair("a.ply", test::ascii_ply(ball())),
        std::pair("l.PLY", test::binary_ply(ball(), false)),
        std::pair("b.ply", test::binary_ply(ball(), true)), std::pair("o.obj", test::obj(ball())),
        std::pair("g.glb", test::glb(ball()))}) {
    SCOPED_TRACE(name);
    expect_same(read_mesh(folder.write(name, content)), ball());
  }
}

TEST(ReadMesh, StlComesWeldedInBothForms) {
  const TempFolder folder;
  TriMesh soup = test::unwelded(ball());
  weld(soup);
  expect_same(read_mesh(folder.write("a.stl", test::ascii_stl(ball()))), soup);
  expect_same(read_mesh(folder.write("b.stl", test::binary_stl(ball()))), soup);
  EXPECT_TRUE(inspect(soup).closed());
  // Some programs begin binary files with the word of text files.
  std::string solid = test::binary_stl(ball());
  solid.replace(0, 5, "solid");
  expect_same(read_mesh(folder.write("c.stl", solid)), soup);
}

TEST(ReadMesh, OwnFilesKeepEveryBitAndColour) {
  const TempFolder folder;
  TriMesh mesh = test::moved(test::sphere(2, 40), arbitrary_pose(2));
  write_ply(mesh, folder.path() / "plain.ply");
  EXPECT_EQ(mesh_hash(read_mesh(folder.path() / "plain.ply")), mesh_hash(mesh));
  std::mt19937 random(3);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    mesh.colors.emplace_back(static_cast<float>(random() % 256) / 255.0f, 0.0f, 1.0f);
  write_ply(mesh, folder.path() / "bytes.ply");
  EXPECT_EQ(mesh_hash(read_mesh(folder.path() / "bytes.ply")), mesh_hash(mesh));
  mesh.colors[3] = {0.1234567f, 0.5f, 0.25f};
  write_ply(mesh, folder.path() / "floats.ply");
  EXPECT_EQ(mesh_hash(read_mesh(folder.path() / "floats.ply")), mesh_hash(mesh));
  EXPECT_LT(std::filesystem::file_size(folder.path() / "bytes.ply"),
            std::filesystem::file_size(folder.path() / "floats.ply"));
}

TEST(ReadMesh, WrittenStlIsTheSameSurface) {
  const TempFolder folder;
  write_stl(ball(), folder.path() / "s.stl");
  const TriMesh back = read_mesh(folder.path() / "s.stl");
  EXPECT_EQ(back.triangles.size(), ball().triangles.size());
  EXPECT_TRUE(inspect(back).closed());
  EXPECT_NEAR(signed_volume(back), signed_volume(ball()), 1e-6);
}

TEST(ReadMesh, LineEndsSpacesAndOtherElementsDoNotMatter) {
  const TempFolder folder;
  const auto with_crlf = [](std::string text) {
    std::string out;
    for (const char c : text) out += c == '\n' ? std::string("\r\n") : std::string(1, c);
    return out;
  };
  expect_same(read_mesh(folder.write("crlf.ply", with_crlf(test::ascii_ply(ball())))), ball());
  expect_same(read_mesh(folder.write("crlf.obj", with_crlf(test::obj(ball())))), ball());
  EXPECT_EQ(
      read_mesh(folder.write("crlf.stl", with_crlf(test::ascii_stl(ball())))).triangles.size(),
      ball().triangles.size());
  // Normals, quality, a list in the vertices, an element of another kind, faces before vertices.
  const std::string odd =
      "ply\nformat ascii 1.0\nobj_info x\nelement camera 1\nproperty float a\nelement face 1\n"
      "property uchar flags\nproperty list uchar uint vertex_index\nproperty list uchar float "
      "texcoord\n"
      "element vertex 3\nproperty double quality\nproperty double z\nproperty double y\nproperty "
      "list "
      "uchar short n\nproperty double x\nend_header\n7\n9 3 0 1 2 2 0.5 0.5\n1 2 3 0 4\n\n1 5 6 2 "
      "8 9 7\n1 0 0 "
      "1 3 0\n";
  const TriMesh mesh = read_mesh(folder.write("odd.ply", odd));
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.vertices[0], Eigen::Vector3d(4, 3, 2));
  EXPECT_EQ(mesh.vertices[1], Eigen::Vector3d(7, 6, 5));
}

TEST(ReadMesh, PlyColoursOfEveryTypeBecomeZeroToOne) {
  const TempFolder folder;
  for (const auto& [type, full] :
       {std::pair("uchar", "255"), std::pair("ushort", "65535"), std::pair("float", "1")}) {
    const std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
        "float z\n"
        "property {0} red\nproperty {0} green\nproperty {0} blue\nproperty {0} alpha\nelement face "
        "1\nproperty list "
        "uchar int vertex_indices\nend_header\n0 0 0 {1} 0 0 0\n1 0 0 0 {1} 0 0\n0 1 0 0 0 {1} "
        "0\n3 0 1 2\n",
        type, full);
    const TriMesh mesh = read_mesh(folder.write("c.ply", text));
    ASSERT_EQ(mesh.colors.size(), 3u);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(mesh.colors[k], Eigen::Vector3f::Unit(k));
  }
}

TEST(ReadMesh, ObjPolygonsNegativeNumbersAndContinuedLines) {
  const TempFolder folder;
  const std::string cube =
      "mtllib a.mtl\nv 0 0 0 0.5 0.25 1\nv 1 0 0 0 0 0\nv 1 1 0 0 0 0\nv 0 1 0 0 0 0\nv 0 0 1 0 0 "
      "0\nv 1 0 1 0 0 0\n"
      "v 1 1 1 0 0 0\nv 0 1 1 0 0 0\nvt 0 0\nvn 0 0 1\ng side\nusemtl m\ns 1\n"
      "f 4/1/1 3/1/1 2/1/1 1/1/1\nf 5//1 6//1 \\\n 7//1 8//1\nf 1/1 2/1 6/1 5/1\nf -6 -5 -1 -2\nf "
      "4 8 7 3\nf 1 5 8 4\n";
  TriMesh mesh = read_mesh(folder.write("cube.obj", cube));
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(mesh.colors[0], Eigen::Vector3f(0.5f, 0.25f, 1));
  // -6 -5 -1 -2 is 3 4 8 7, the same face as 4 8 7 3 reversed: swap it for 2 3 7 6.
  std::string right = cube;
  right.replace(right.find("f -6 -5 -1 -2"), 13, "f -7 -6 -2 -3");
  mesh = read_mesh(folder.write("right.obj", right));
  EXPECT_TRUE(inspect(mesh).closed());
  EXPECT_NEAR(signed_volume(mesh), 1, 1e-15);
}

TEST(ReadMesh, PolygonsKeepTheirAreaWhetherConvexOrNot) {
  const TempFolder folder;
  // An arrow head (concave quad) and a comb (concave, 8 corners), in a tilted plane.
  const std::string text = "v 0 0 0\nv 2 1 2\nv 0 2 0\nv 1 1 1\nf 1 2 3 4\n";
  EXPECT_NEAR(surface_area(read_mesh(folder.write("arrow.obj", text))), std::sqrt(2.0), 1e-12);
  const std::string comb =
      "v 0 0 0\nv 5 0 0\nv 5 4 0\nv 4 4 0\nv 4 1 0\nv 1 1 0\nv 1 4 0\nv 0 4 0\nf 1 2 3 4 5 6 7 8\n";
  const TriMesh mesh = read_mesh(folder.write("comb.obj", comb));
  EXPECT_EQ(mesh.triangles.size(), 6u);
  EXPECT_NEAR(surface_area(mesh), 11, 1e-12);
  double projected = 0;
  for (const auto& t : mesh.triangles)
    projected += 0.5 * (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                           .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                           .z();
  EXPECT_NEAR(projected, 11, 1e-12);
}

TEST(ReadMesh, GlbNodesAreTransformedAndMerged) {
  const TempFolder folder;
  const TriMesh cube = test::cuboid({0, 0, 0}, {1, 1, 1});
  // A parent turned by 90 degrees about z and moved; one child scaled, one mirrored by its matrix.
  const std::string nodes =
      R"([{"translation":[10,0,0],"rotation":[0,0,0.7071067811865476,0.7071067811865476],"children":[1,2]},)"
      R"({"mesh":0,"scale":[2,3,4]},{"mesh":0,"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,50,1]}])";
  const TriMesh mesh = read_mesh(folder.write("two.glb", test::glb(cube, nodes)));
  EXPECT_EQ(mesh.triangles.size(), 24u);
  EXPECT_TRUE(inspect(mesh).closed());
  EXPECT_NEAR(signed_volume(mesh), 24 + 1, 1e-9);  // the mirrored one faces outward too
  const Box box = bounding_box(mesh);
  EXPECT_LT((box.low - Eigen::Vector3d(7, -1, 0)).norm(), 1e-9);
  EXPECT_LT((box.high - Eigen::Vector3d(10, 2, 51)).norm(), 1e-9);
}

TEST(ReadMesh, SavingOverAFileKeepsTheOldOneOnFailure) {
  const TempFolder folder;
  EXPECT_THROW(write_ply(ball(), folder.path() / "missing" / "a.ply"), std::runtime_error);
}

}  // namespace
}  // namespace condyle
