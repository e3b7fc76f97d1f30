// Files are read back by tinygltf and by our own reader of surfaces.
#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <numbers>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/temporary_path.h"
#include "engine/gltf/gltf_scene.h"
#include "engine/gltf/shape_keys.h"
#include "engine/mesh/measure.h"
#include "engine/mesh_io/mesh_files.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// A tetrahedron of 10, 20 and 30 mm along left, back and up.
GltfSurface tetrahedron() {
  GltfSurface surface;
  surface.vertices = {{0, 0, 0}, {10, 0, 0}, {0, 20, 0}, {0, 0, 30}};
  surface.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5f, 0.5f, 0.5f}};
  surface.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return surface;
}

Pose turned(double angle, const Vector3d& shift) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3d(1, 2, 3).normalized())), shift};
}

tinygltf::Model read(const std::string& bytes) {
  tinygltf::Model model;
  tinygltf::TinyGLTF loader;
  std::string error, warning;
  EXPECT_TRUE(loader.LoadBinaryFromMemory(&model, &error, &warning,
                                          reinterpret_cast<const unsigned char*>(bytes.data()),
                                          static_cast<unsigned>(bytes.size())))
      << error;
  EXPECT_EQ(error + warning, "");
  return model;
}

std::vector<float> floats(const tinygltf::Model& model, int view, std::size_t count) {
  const auto& place = model.bufferViews.at(static_cast<std::size_t>(view));
  std::vector<float> values(count);
  EXPECT_LE(count * 4, place.byteLength);
  std::memcpy(values.data(), model.buffers.at(0).data.data() + place.byteOffset, count * 4);
  return values;
}

std::vector<float> values_of(const tinygltf::Model& model, int accessor) {
  const auto& each = model.accessors.at(static_cast<std::size_t>(accessor));
  return floats(model, each.bufferView,
                each.count * static_cast<std::size_t>(tinygltf::GetNumComponentsInType(
                                 static_cast<unsigned>(each.type))));
}

const tinygltf::AnimationChannel& channel_of(const tinygltf::Animation& animation,
                                             const std::string& path) {
  for (const auto& channel : animation.channels)
    if (channel.target_path == path) return channel;
  throw std::runtime_error("no channel " + path);
}

}  // namespace

TEST(Glb, AStillSurfaceLiesWhereItsNodesPutIt) {
  GltfScene scene{.generator = "test", .nodes = {}};
  const Pose pose = turned(0.7, {5, -60, 12});
  scene.nodes.push_back({.name = "jaw", .pose = pose});
  scene.nodes.push_back({.name = "bone", .parent = 0, .surface = tetrahedron()});
  const TemporaryPath folder("glb");
  make_folder(folder.path());
  write_file(folder.path() / "a.glb", glb_bytes(scene));
  const TriMesh read_back = read_mesh(folder.path() / "a.glb");
  ASSERT_EQ(read_back.vertices.size(), 4u);
  ASSERT_EQ(read_back.triangles.size(), 4u);
  // Metres, x left, y up, z to the front: of single precision.
  for (std::size_t v = 0; v < 4; ++v) {
    const Vector3d p = pose * scene.nodes[1].surface->vertices[v].cast<double>();
    EXPECT_LT((read_back.vertices[v] - 0.001 * Vector3d(p.x(), p.z(), -p.y())).norm(), 1e-7);
  }
  EXPECT_GT(signed_volume(read_back), 0);  // still faces outward
  ASSERT_EQ(read_back.colors.size(), 4u);
  EXPECT_NEAR(read_back.colors[3].x(), 0.5f, 0.003f);
}

TEST(Glb, TracksAndShapesAreReadBackByTinyGltf) {
  GltfScene scene{.generator = "Condyle 1", .nodes = {}};
  scene.nodes.push_back({.name = "jaw"});
  GltfSurface face = tetrahedron();
  for (const float mm : {1.f, 2.f}) {
    face.targets.emplace_back(4, Vector3f::Zero());
    face.targets.back()[3] = {0, 0, mm};  // one vertex of four moves: stored as sparse
  }
  scene.nodes.push_back({.name = "face", .surface = face, .extras = {{"kind", "face"}}});
  GltfMotion motion{
      .name = "opening", .times_s = {0, 0.5, 1}, .tracks = {}, .key_times_s = {0, 0.25, 1}};
  // Quaternions of both signs: the file must go the short way round.
  std::vector<Pose> poses = {turned(0, {0, 0, 0}), turned(0.3, {1, 2, 3}), turned(0.6, {2, 4, 6})};
  poses[1].R.coeffs() = -poses[1].R.coeffs();
  motion.tracks.push_back({0, poses});
  scene.motion = motion;

  const tinygltf::Model model = read(glb_bytes(scene));
  EXPECT_EQ(model.asset.generator, "Condyle 1");
  ASSERT_EQ(model.nodes.size(), 3u);
  EXPECT_EQ(model.nodes[2].extras.Get("kind").Get<std::string>(), "face");
  ASSERT_EQ(model.animations.size(), 1u);
  const auto& animation = model.animations[0];
  EXPECT_EQ(animation.channels.size(), 3u);
  const auto sampler = [&](const std::string& path) {
    return animation.samplers.at(static_cast<std::size_t>(channel_of(animation, path).sampler));
  };
  EXPECT_EQ(values_of(model, sampler("rotation").input), (std::vector<float>{0, 0.5f, 1}));
  EXPECT_EQ(values_of(model, sampler("weights").input), (std::vector<float>{0, 0.25f, 1}));
  EXPECT_EQ(values_of(model, sampler("weights").output), (std::vector<float>{0, 0, 1, 0, 0, 1}));
  const auto turns = values_of(model, sampler("rotation").output),
             shifts = values_of(model, sampler("translation").output);
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Quaterniond q(turns[4 * k + 3], turns[4 * k], turns[4 * k + 1], turns[4 * k + 2]);
    EXPECT_LT((q.toRotationMatrix() - poses[k].R.toRotationMatrix()).norm(), 1e-6);
    EXPECT_LT((Vector3d(shifts[3 * k], shifts[3 * k + 1], shifts[3 * k + 2]) - poses[k].t).norm(),
              1e-6);
    if (k == 0) continue;
    float dot = 0;
    for (std::size_t c = 0; c < 4; ++c) dot += turns[4 * k + c] * turns[4 * k - 4 + c];
    EXPECT_GT(dot, 0.9f);
  }
  const auto& primitive = model.meshes.at(0).primitives.at(0);
  ASSERT_EQ(primitive.targets.size(), 2u);
  const auto& target =
      model.accessors.at(static_cast<std::size_t>(primitive.targets[1].at("POSITION")));
  ASSERT_TRUE(target.sparse.isSparse);
  EXPECT_EQ(target.sparse.count, 1);
  EXPECT_EQ(target.count, 4u);
  EXPECT_EQ(floats(model, target.sparse.values.bufferView, 3), (std::vector<float>{0, 0, 2}));
}

TEST(Glb, ListsThatDoNotAgreeAreRefused) {
  GltfScene scene{.generator = "test", .nodes = {}};
  scene.nodes.push_back({.name = "bone", .surface = tetrahedron()});
  scene.nodes[0].surface->normals.resize(3);
  try {
    glb_bytes(scene);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "bone normals: 3 values, but 4 are needed");
  }
}

// A point on a parabola: the chord over n steps of 0.1 s deviates by a n^2 h^2 / 4 at most.
TEST(ShapeKeys, KeysAreAsFewAsTheErrorPermits) {
  std::vector<std::vector<Vector3f>> shapes;
  std::vector<double> times;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.1 * i;
    times.push_back(t);
    shapes.push_back({{static_cast<float>(t * t), 0, 0}, {0, 0, 0}});
  }
  const ShapeKeys keys = choose_shape_keys(shapes, times, 0.2501);
  ASSERT_EQ(keys.frames.size(), 11u);  // chords of 1 s have an error of 0.25
  EXPECT_NEAR(keys.error_mm, 0.25, 1e-4);
  EXPECT_EQ(keys.frames.front(), 0u);
  EXPECT_EQ(keys.frames.back(), 100u);
  EXPECT_GT(choose_shape_keys(shapes, times, 0.01).frames.size(), 40u);
  for (auto& shape : shapes) shape = shapes.front();
  EXPECT_EQ(choose_shape_keys(shapes, times, 0.25).frames.size(), 1u);
}

}  // namespace condyle
