#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

#include "engine/core/error.h"
#include "engine/mesh_io/mesh_files.h"
#include "tests/engine/mesh_io/samples.h"

namespace condyle {
namespace {

using test::TempFolder;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// The message with which the file is refused; the test fails when it is read.
std::string refusal(const std::filesystem::path& file) {
  try {
    read_mesh(file);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find(file.string() + ": "), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message.substr(file.string().size() + 2);
  }
  ADD_FAILURE() << file << " was read";
  return "";
}

struct Bad {
  const char* name;
  std::string content;
  std::vector<const char*> words;  // the message must hold them all
};

class Malformed : public testing::Test {
 protected:
  void expect(const std::vector<Bad>& files) {
    for (const auto& bad : files) {
      const std::string message = refusal(folder_.write(bad.name, bad.content));
      for (const char* word : bad.words)
        EXPECT_NE(message.find(word), std::string::npos)
            << bad.name << ": " << message << "\n  lacks: " << word;
    }
  }
  TempFolder folder_;
  const TriMesh mesh_ = test::cuboid({0, 0, 0}, {1, 1, 1});
};

TEST_F(Malformed, WhatIsNoReadableFile) {
  EXPECT_NE(refusal(folder_.path() / "absent.ply").find("no such file"), std::string::npos);
  EXPECT_NE(refusal(folder_.path()).find("is a folder"), std::string::npos);
  expect({{"empty.stl", "", {"is empty (0 bytes)"}},
          {"mesh.xyz", "v 1 2 3", {"\".xyz\" is not known", ".stl, .ply, .obj and .glb"}},
          {"mesh", "v 1 2 3", {"no extension"}},
          {"scene.gltf", "{}", {"one .glb file"}}});
}

TEST_F(Malformed, ContentOfAnotherKind) {
  expect({{"stl.ply", test::ascii_stl(mesh_), {"not a PLY file", "an ASCII STL file"}},
          {"stlb.ply", test::binary_stl(mesh_), {"not a PLY file", "a binary STL file"}},
          {"ply.stl", test::ascii_ply(mesh_), {"not an STL file", "a PLY file"}},
          {"ply.obj", test::ascii_ply(mesh_), {"not an OBJ file", "a PLY file"}},
          {"obj.stl", test::obj(mesh_), {"not an STL file", "an OBJ file"}},
          {"obj.glb", test::obj(mesh_), {"not a GLB file", "an OBJ file"}},
          {"glb.obj", test::glb(mesh_), {"not an OBJ file", "a GLB file"}},
          {"text.ply", "Lorem ipsum dolor sit amet", {"not a PLY file", "some text"}},
          {"text.obj", "Lorem ipsum dolor sit amet", {"line 1", "\"Lorem\""}},
          {"text.stl", std::string(200, 'x'), {"not an STL file", "some text"}},
          {"text.glb", "Lorem ipsum dolor sit amet", {"not a GLB file"}},
          {"zip.stl", "PK\3\4" + std::string(200, 'x'), {"a ZIP archive"}},
          {"page.ply", "<html>404</html>", {"XML or HTML"}}});
}

TEST_F(Malformed, Ply) {
  const std::string text = test::ascii_ply(mesh_), bytes = test::binary_ply(mesh_, false);
  std::string nan = bytes, index = bytes;
  const std::size_t body = bytes.find("end_header\n") + 11;
  const float not_a_number = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&nan[body + 3 * 12], &not_a_number, 4);
  index[body + 8 * 12 + 3 * 13 + 1] = 99;
  expect(
      {{"cut.ply",
        bytes.substr(0, bytes.size() - 20),
        {"face 10", "12 were promised", "cut short"}},
       {"cutlist.ply", bytes.substr(0, bytes.size() - 1), {"face 11", "cut short"}},
       {"cuttext.ply", text.substr(0, text.size() - 20), {"face 9", "too few numbers"}},
       {"cuthead.ply", text.substr(0, 60), {"header", "end_header"}},
       {"more.ply", bytes + "xxxx", {"4 bytes follow"}},
       {"nan.ply", nan, {"vertex 3", "nan"}},
       {"inf.ply", replaced(text, "1 0 0\n", "1 inf 0\n"), {"vertex 1", "inf", "line 12"}},
       {"far.ply", replaced(text, "1 0 0\n", "1 4e9 0\n"), {"vertex 1", "4000000000", "1e9"}},
       {"index.ply", index, {"face 3", "vertex 99", "there are 8"}},
       {"negative.ply", replaced(text, "3 0 2 1", "3 0 -2 1"), {"face 0", "vertex -2", "line 19"}},
       {"half.ply", replaced(text, "3 0 2 1", "3 0 1.5 1"), {"face 0", "vertex 1.5"}},
       {"two.ply", replaced(text, "3 0 2 1", "2 0 2"), {"face 0", "2 corners"}},
       {"few.ply", replaced(text, "3 0 2 1", "3 0 2"), {"face 0", "too few numbers"}},
       {"many.ply", replaced(text, "3 0 2 1", "3 0 2 1 7"), {"face 0", "\"7\" after"}},
       {"word.ply", replaced(text, "1 0 0\n", "1 zero 0\n"), {"vertex 1", "\"zero\""}},
       {"none.ply", test::ascii_ply({mesh_.vertices, {}, {}}), {"no triangles (8 vertices)"}},
       {"nothing.ply", test::ascii_ply({}), {"no triangles"}},
       {"type.ply",
        replaced(text, "property float y", "property real y"),
        {"header line 6", "\"real\""}},
       {"noy.ply", replaced(text, "property float y\n", ""), {"\"y\""}},
       {"format.ply", replaced(text, "ascii", "ebcdic"), {"header line 2", "\"ebcdic\""}},
       {"minus.ply", replaced(text, "vertex 8", "vertex -8"), {"header line 4", "\"-8\""}},
       {"word2.ply", replaced(text, "comment", "remark"), {"header line 3", "\"remark\""}},
       {"huge.ply",
        replaced(bytes, "vertex 8", "vertex 4000000000"),
        {"header", "4000000000 vertices", "10000000"}},
       {"large.ply",
        replaced(bytes, "vertex 8", "vertex 9000000"),
        {"header", "9000000 vertices", "bytes follow"}},
       {"faces.ply",
        replaced(bytes, "face 12", "face 4000000000"),
        {"header", "4000000000 faces", "5000000"}},
       {"lots.ply",
        replaced(bytes, "element face 12\n",
                 "element junk 99999999999999999\nproperty char a\nelement face 12\n"),
        {"header", "junk", "bytes follow"}}});
}

TEST_F(Malformed, Stl) {
  const std::string text = test::ascii_stl(mesh_), bytes = test::binary_stl(mesh_);
  std::string nan = bytes, huge = bytes, none = bytes.substr(0, 84);
  const float infinite = std::numeric_limits<float>::infinity();
  std::memcpy(&nan[84 + 5 * 50 + 12 + 12], &infinite, 4);
  const std::uint32_t many = 4'000'000'000u, zero = 0;
  std::memcpy(&huge[80], &many, 4);
  std::memcpy(&none[80], &zero, 4);
  expect({{"cut.stl",
           bytes.substr(0, 400),
           {"header", "12 triangles", "684 bytes", "400", "cut short"}},
          {"short.stl", bytes.substr(0, 50), {"50 bytes"}},
          {"more.stl", bytes + "x", {"12 triangles", "damaged"}},
          {"huge.stl", huge, {"header", "4000000000 triangles"}},
          {"none.stl", none, {"0 triangles"}},
          {"inf.stl", nan, {"triangle 5, corner 1", "inf"}},
          {"cuttext.stl", text.substr(0, text.size() / 2), {"line", "cut short"}},
          {"nan.stl", replaced(text, "vertex 0 1 0", "vertex nan 1 0"), {"line 5", "nan"}},
          {"word.stl", replaced(text, "endloop", "endlop"), {"line 7", "\"endlop\""}},
          {"four.stl",
           replaced(text, "    endloop", "vertex 0 0 0\n    endloop"),
           {"line 7", "more than 3 corners"}},
          {"two.stl", replaced(text, "      vertex 0 0 0\n", ""), {"2 corners"}},
          {"nothing.stl", "solid a\nendsolid a\n", {"no triangles"}}});
}

TEST_F(Malformed, Obj) {
  const std::string text = test::obj(mesh_);
  expect({{"index.obj",
           replaced(text, "f 1 3 2", "f 1 3 99"),
           {"line 11, face 1", "vertex 99", "there are 8"}},
          {"zero.obj", replaced(text, "f 1 3 2", "f 0 3 2"), {"line 11", "\"0\""}},
          {"back.obj", replaced(text, "f 1 3 2", "f -9 -1 -2"), {"line 11", "-9", "there are 8"}},
          {"two.obj", replaced(text, "f 1 3 2", "f 1 3"), {"line 11", "2 corners"}},
          {"word.obj", replaced(text, "f 1 3 2", "f 1 x 2"), {"line 11", "\"x\""}},
          {"nan.obj", replaced(text, "v 1 0 0", "v 1 nan 0"), {"line 4, vertex 2", "nan"}},
          {"short.obj", replaced(text, "v 1 0 0", "v 1 0"), {"line 4", "2 numbers"}},
          {"cloud.obj", "v 1 2 3\nv 4 5 6\n", {"no triangles (2 vertices)"}},
          {"binary.obj", std::string("v 1 2 3\n\0\1\2\3", 12), {"not an OBJ file"}}});
}

TEST_F(Malformed, Glb) {
  const std::string good = test::glb(mesh_);
  const auto changed = [&](const char* from, const char* to) {
    // Same length, so that the chunks stay whole.
    std::string json = replaced(good, from, to);
    json.resize(good.size());
    return std::string(from).size() == std::string(to).size() ? json : std::string();
  };
  TriMesh far = mesh_, nan = mesh_;
  nan.vertices[6].z() = std::numeric_limits<double>::quiet_NaN();
  far.triangles[4][1] = 77;
  expect(
      {{"cut.glb", good.substr(0, good.size() - 30), {"header", "cut short"}},
       {"json.glb", changed("\"scenes\"", "\"scenes:"), {"not valid JSON"}},
       {"version.glb",
        replaced(good, std::string("glTF\2", 5), std::string("glTF\1", 5)),
        {"version 1"}},
       {"count.glb", changed("\"count\":36", "\"count\":99"), {"accessors 1", "states 99"}},
       {"type.glb", changed("5125", "5199"), {"component type 5199"}},
       {"node.glb", test::glb(mesh_, "[{\"mesh\":7}]"), {"nodes 0", "7"}},
       {"scene.glb", test::glb(mesh_, "[{\"mesh\":0}]", "[5]"), {"scenes 0", "5"}},
       {"loop.glb", test::glb(mesh_, R"([{"mesh":0,"children":[0]}])"), {"nodes 0", "two places"}},
       {"index.glb", test::glb(far), {"index 13", "vertex 77", "there are 8"}},
       {"nan.glb", test::glb(nan), {"vertex 6", "nan"}},
       {"quaternion.glb",
        test::glb(mesh_, R"([{"mesh":0,"rotation":[0,0,0,0]}])"),
        {"zero quaternion"}},
       {"nothing.glb", test::glb(mesh_, "[{}]"), {"no triangles"}},
       {"draco.glb",
        test::glb(mesh_, "[{\"mesh\":0}]", "[0]",
                  R"(,"extensionsRequired":["KHR_draco_mesh_compression"])"),
        {"Draco", "without compression"}},
       {"meshopt.glb",
        test::glb(mesh_, "[{\"mesh\":0}]", "[0]",
                  R"(,"extensionsRequired":["EXT_meshopt_compression"])"),
        {"EXT_meshopt_compression", "without compression"}},
       {"deep.glb", test::glb("{\"a\":" + std::string(3'000'000, '['), ""), {"too deep"}}});
}

/// Bytes of address space that this process has; under AddressSanitizer many terabytes.
rlim_t address_space() {
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  statm >> pages;
  return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

/// Runs in its own process with little memory: exits 0 when the file is refused as expected.
void read_in_little_memory(const std::filesystem::path& file) {
  const rlim_t most = address_space() + (300u << 20);
  const rlimit limit{most, most};
  ::setrlimit(RLIMIT_AS, &limit);
  try {
    read_mesh(file);
  } catch (const InputError&) {
    std::_Exit(0);
  } catch (...) {
    std::_Exit(2);
  }
  std::_Exit(1);
}

TEST_F(Malformed, PromisesTakeNoMemory) {
  const std::string bytes = test::binary_ply(mesh_, false), text = test::ascii_ply(mesh_);
  std::string stl = test::binary_stl(mesh_);
  const std::uint32_t many = 4'000'000'000u;
  std::memcpy(&stl[80], &many, 4);
  std::string list = bytes;
  list[bytes.find("end_header\n") + 11 + 8 * 12] = '\xff';
  const std::vector<std::filesystem::path> files = {
      folder_.write("a.ply", replaced(bytes, "vertex 8", "vertex 4000000000")),
      folder_.write("b.ply", replaced(bytes, "vertex 8", "vertex 9999999")),
      folder_.write("c.ply", replaced(text, "face 12", "face 4999999")),
      folder_.write("d.ply",
                    replaced(replaced(bytes, "list uchar", "list uint"), "face 12", "face 10")),
      folder_.write("e.ply", list),
      folder_.write("f.stl", stl),
      folder_.write(
          "g.glb",
          test::glb("{\"nodes\":[" + std::string(100, '[') + std::string(100, ']') + "]}", "")),
      folder_.write("h.glb", replaced(test::glb(mesh_), "\"count\":8,", "\"count\":9e9,"))};
  for (const auto& file : files)
    EXPECT_EXIT(read_in_little_memory(file), testing::ExitedWithCode(0), "") << file;
}

}  // namespace
}  // namespace condyle
