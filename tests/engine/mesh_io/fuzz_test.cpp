#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/mesh_io/readers.h"
#include "tests/engine/mesh_io/samples.h"

namespace condyle {
namespace {

/// Changes the text slightly, as copying, disk and program errors do.
std::string mutated(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const auto spot = [&] {
    // Half of the changes in the first 300 bytes, where the header is.
    return below(random() & 1 ? text.size() : std::min<std::size_t>(text.size(), 300));
  };
  const std::size_t changes = 1 + below(4);
  for (std::size_t i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = spot();
    switch (below(9)) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        break;
      case 2:
        text.resize(at);
        break;
      case 3:
        text.erase(at, 1 + below(20));
        break;
      case 4:
        text.insert(at, text.substr(spot(), 1 + below(30)));
        break;
      case 5:
        text.insert(at, 1 + below(3), "0123456789-.e {[\n\"\\"[below(20)]);
        break;
      case 6:
        for (std::size_t k = at; k < std::min(text.size(), at + 4); ++k) text[k] = '\xff';
        break;
      case 7: {  // swaps two stretches of the same length
        const std::size_t other = spot(),
                          n = std::min({std::size_t{8}, text.size() - at, text.size() - other});
        for (std::size_t k = 0; k < n; ++k) std::swap(text[at + k], text[other + k]);
        break;
      }
      default: {  // another number instead of one
        const std::size_t digit = text.find_first_of("0123456789", at);
        const char* numbers[] = {"4294967296",           "-1", "1e308",     "nan",
                                 "99999999999999999999", "0",  "2147483648"};
        if (digit != std::string::npos) text.replace(digit, 1, numbers[below(7)]);
      }
    }
  }
  return text;
}

class Fuzz : public testing::TestWithParam<const char*> {};

/// A mutated file is read as a sound mesh, or refused with one line that names it.
TEST_P(Fuzz, IsReadSoundlyOrRefused) {
  const std::string kind = GetParam();
  const TriMesh mesh =
      test::single_precision(test::moved(test::sphere(1, 40), test::arbitrary_pose(1)));
  const std::string good = kind == "ascii.ply"    ? test::ascii_ply(mesh)
                           : kind == "little.ply" ? test::binary_ply(mesh, false)
                           : kind == "big.ply"    ? test::binary_ply(mesh, true)
                           : kind == "ascii.stl"  ? test::ascii_stl(mesh)
                           : kind == "binary.stl" ? test::binary_stl(mesh)
                           : kind == "text.obj"   ? test::obj(mesh)
                                                  : test::glb(mesh);
  const std::filesystem::path file = kind;
  ASSERT_EQ(parse_mesh(file, good).triangles.size(), mesh.triangles.size());
  std::mt19937 random(20240229);
  int read = 0, refused = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    try {
      const TriMesh found = parse_mesh(file, mutated(good, random));
      ++read;
      ASSERT_FALSE(found.triangles.empty());
      ASSERT_TRUE(found.colors.empty() || found.colors.size() == found.vertices.size());
      for (const auto& v : found.vertices) ASSERT_TRUE(v.allFinite());
      for (const auto& t : found.triangles)
        ASSERT_TRUE((t.array() >= 0).all() &&
                    (t.array() < static_cast<int>(found.vertices.size())).all());
    } catch (const InputError& error) {
      ++refused;
      const std::string message = error.what();
      ASSERT_EQ(message.find(file.string()), 0u) << message;
      ASSERT_EQ(message.find('\n'), std::string::npos) << message;
      ASSERT_LT(message.size(), file.string().size() + 400) << message;
      ASSERT_TRUE(std::all_of(message.begin(), message.end(), [](unsigned char c) {
        return c >= 32;
      })) << message;
    }
  }
  // Both happen often: the mutations neither miss the file nor ruin it all.
  EXPECT_GT(read, 40);
  EXPECT_GT(refused, 400);
}

INSTANTIATE_TEST_SUITE_P(Formats, Fuzz,
                         testing::Values("ascii.ply", "little.ply", "big.ply", "ascii.stl",
                                         "binary.stl", "text.obj", "mesh.glb"),
                         [](const auto& format) {
                           std::string name = format.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

}  // namespace
}  // namespace condyle
