#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>
#include <random>

#include "render/gl/framebuffer.h"
#include "render/mesh/cover_grid.h"
#include "render/mesh/vertex_normals.h"
#include "render/scene/visibility.h"
#include "render/shaders/shaders.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using Culling = WithContext;

const char* const plain_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 2) in vec4 color;
uniform mat4 model, view_projection;
out vec4 seen;
void main() {
  gl_Position = view_projection * (model * vec4(position, 1.0));
  seen = color;
}
)";
const char* const plain_fragment = R"(#version 330 core
in vec4 seen;
out vec4 result;
void main() { result = seen; }
)";

struct Sent {
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<Eigen::Vector3i> triangles;
  GpuMesh mesh;
  SurfaceEdges edges;

  static std::vector<Eigen::Vector3f> floats(const TriMesh& mesh) {
    std::vector<Eigen::Vector3f> all;
    for (const auto& v : mesh.vertices) all.push_back(v.cast<float>());
    return all;
  }
  std::vector<int> corners() const {
    std::vector<int> all(positions.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  explicit Sent(const TriMesh& source)
      : positions(floats(source)),
        triangles(source.triangles),
        mesh(positions, triangles, GpuMesh::Use::still),
        edges(triangles) {
    vertex_normals(positions, triangles, normals);
    mesh.send_shape(positions, normals);
    std::vector<GpuMesh::Bytes> colors;
    for (const auto& p : positions)
      colors.push_back(
          {static_cast<std::uint8_t>(128 + std::lround(std::clamp(p.x(), -99.f, 99.f))),
           static_cast<std::uint8_t>(128 + std::lround(std::clamp(p.y(), -99.f, 99.f))),
           static_cast<std::uint8_t>(128 + std::lround(std::clamp(p.z(), -99.f, 99.f))), 255});
    mesh.send_colors(colors);
    mesh.send_extras(std::vector<GpuMesh::Bytes>(positions.size()));
  }
};

/// A skin over a bone, viewed by a camera: the skin's front, its inner side, then the bone.
struct Shell {
  Sent skin, bone;
  Eigen::Matrix4f bone_at = Eigen::Matrix4f::Identity();

  Image picture(const Camera& camera, int side, int samples, bool all, std::size_t* drawn) {
    const Framebuffer target(side, side, samples), resolved(side, side, 1);
    GlProgram program("plain", {plain_vertex, plain_fragment});
    const Eigen::Matrix4f vp = projection_matrix(camera, 1, 100, 1000) * view_matrix(camera);
    Eigen::Vector4f eye;
    eye << (camera.target + camera.distance_mm * camera.direction.normalized()).cast<float>(), 1;
    const Viewpoint from = {vp, eye, side, side};
    cover.start(side, side, vp);
    cover.add(skin.positions, skin.corners(), skin.triangles, skin.edges,
              Eigen::Matrix4f::Identity());
    cover.finish();
    target.bind();
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_MULTISAMPLE);
    glDepthFunc(GL_LESS);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    program.use();
    program.set("view_projection", vp);
    *drawn = 0;
    const auto draw = [&](const GpuMesh& mesh, const Eigen::Matrix4f& model, Sides sides,
                          const CoverGrid* hidden) {
      glEnable(GL_CULL_FACE);
      glCullFace(sides == Sides::front ? GL_BACK : GL_FRONT);
      program.set("model", model);
      const auto& chosen = visibility.choose(mesh, mesh.fine(), model, from, sides, hidden);
      *drawn += all ? mesh.fine().triangles.size() : chosen.size();
      if (all)
        mesh.draw();
      else
        mesh.draw(chosen);
    };
    const Eigen::Matrix4f still = Eigen::Matrix4f::Identity();
    draw(skin.mesh, still, Sides::front, nullptr);
    draw(skin.mesh, still, Sides::back, &cover);
    draw(bone.mesh, bone_at, Sides::front, &cover);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    target.resolve_to(resolved.name());
    return resolved.read();
  }

  CoverGrid cover = {};
  Visibility visibility = {};
};

/// A dented, noisy ball with a round mouth of so many degrees about -y, some of it slivers.
TriMesh head(double radius_mm, double mouth_deg, unsigned seed, double noise_mm) {
  TriMesh mesh = ball({0, 0, 0}, radius_mm, 40);
  std::mt19937 random(seed);
  const auto uniform = [&] { return random() / 4294967296.0 - 0.5; };
  std::vector<char> removed;
  for (auto& v : mesh.vertices) {
    const Eigen::Vector3d d = v.normalized();
    removed.push_back(-d.y() > std::cos(mouth_deg * std::numbers::pi / 180));
    v *= 1 + 0.12 * std::sin(5 * d.x()) * std::cos(4 * d.z());
    v += noise_mm * Eigen::Vector3d(uniform(), uniform(), uniform());
  }
  std::erase_if(mesh.triangles, [&](const Eigen::Vector3i& t) {
    return removed[t[0]] && removed[t[1]] && removed[t[2]];
  });
  return mesh;
}

TEST_F(Culling, CullingChangesNoPixel) {
  // From smooth to so rough that folds hide each other; from far off, triangles are below a pixel.
  std::size_t all_drawn = 0, some_drawn = 0;
  for (const double noise_mm : {0.0, 0.6, 5.0})
    for (const double distance : {300.0, 500.0, 900.0}) {
      Shell shell{Sent(head(50, 25, 7, noise_mm)), Sent(ball({0, 3, 0}, 36))};
      shell.bone_at.topRightCorner<3, 1>() << 2, 6, -3;
      std::mt19937 random(3);
      for (int k = 0; k < 8; ++k) {
        Camera camera = front_camera(130);
        camera.distance_mm = distance;
        for (int c = 0; k > 0 && c < 3; ++c) camera.direction[c] = random() / 4294967296.0 - 0.5;
        const int samples = k % 2 ? 4 : 1, side = k % 3 ? 250 : 91;
        std::size_t all = 0, some = 0;
        const Image plain = shell.picture(camera, side, samples, true, &all);
        const Image culled = shell.picture(camera, side, samples, false, &some);
        EXPECT_TRUE(test::same_bytes(plain, culled))
            << "noise " << noise_mm << ", distance " << distance << ", view " << k;
        EXPECT_LT(some, all);
        if (noise_mm < 1) all_drawn += all, some_drawn += some;
      }
    }
  EXPECT_LT(some_drawn, 0.45 * all_drawn);
}

TEST_F(Culling, AClosedSkinHidesAllBelowIt) {
  Shell shell{Sent(ball({0, 0, 0}, 50)), Sent(ball({0, 0, 0}, 30))};
  std::size_t drawn = 0;
  shell.picture(front_camera(130), 400, 1, false, &drawn);
  const Eigen::Matrix4f vp =
      projection_matrix(front_camera(130), 1, 100, 1000) * view_matrix(front_camera(130));
  const Viewpoint from = {vp, {0, -500, 0, 1}, 400, 400};
  Visibility visibility;
  const Eigen::Matrix4f still = Eigen::Matrix4f::Identity();
  const GpuMesh& bone = shell.bone.mesh;
  EXPECT_EQ(visibility.choose(bone, bone.fine(), still, from, Sides::front, &shell.cover).size(),
            0u);
  EXPECT_GT(visibility.choose(bone, bone.fine(), still, from, Sides::front).size(), 1000u);
}

TEST_F(Culling, AHoleOfOneTriangleIsTransparent) {
  TriMesh holed = ball({0, 0, 0}, 50);
  // One triangle near the middle of the picture.
  const auto at = std::find_if(holed.triangles.begin(), holed.triangles.end(), [&](const auto& t) {
    const Eigen::Vector3d middle =
        (holed.vertices[t[0]] + holed.vertices[t[1]] + holed.vertices[t[2]]) / 3;
    return middle.y() < -49.5 && std::abs(middle.x()) < 4 && std::abs(middle.z()) < 4;
  });
  ASSERT_NE(at, holed.triangles.end());
  holed.triangles.erase(at);
  Shell shell{Sent(holed), Sent(ball({0, 0, 0}, 30))};
  std::size_t all = 0, some = 0;
  const Image plain = shell.picture(front_camera(130), 400, 1, true, &all);
  EXPECT_TRUE(test::same_bytes(plain, shell.picture(front_camera(130), 400, 1, false, &some)));
  shell.bone_at.topRightCorner<3, 1>() << 0, 400, 0;  // far off: another colour in the hole
  EXPECT_TRUE(test::unlike(plain, shell.picture(front_camera(130), 400, 1, false, &some), 0));
}

TEST_F(Culling, PiecesHoldEveryTriangleOnceInsideTheirBoxes) {
  const TriMesh source = ball({4, 5, 6}, 30);
  const Sent sent(source);
  const auto& mesh = sent.mesh;
  int next = 0;
  float sum = 0;
  for (const auto& piece : mesh.fine().pieces) {
    EXPECT_EQ(piece.first_triangle, next);
    sum += piece.box.diagonal().norm();
    for (int t = 0; t < piece.triangle_count; ++t)
      for (const int v : mesh.fine().triangles[next + t])
        EXPECT_TRUE(piece.box.contains(mesh.points()[v]));
    next += piece.triangle_count;
  }
  EXPECT_EQ(next, static_cast<int>(source.triangles.size()));
  EXPECT_LT(sum / static_cast<float>(mesh.fine().pieces.size()), 20);  // of a ball of 104 across
}

}  // namespace
}  // namespace condyle
