#include "render/framebuffer.h"
#include "render/occlusion_culling.h"
#include "render/shaders.h"
#include "render/vertex_normals.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using Culling = WithContext;

struct Sent {
  std::vector<Eigen::Vector3f> positions, normals;
  GpuMesh mesh;

  static std::vector<Eigen::Vector3f> floats(const TriMesh& mesh) {
    std::vector<Eigen::Vector3f> all;
    for (const auto& v : mesh.vertices) all.push_back(v.cast<float>());
    return all;
  }
  explicit Sent(const TriMesh& source)
      : positions(floats(source)), mesh(positions, source.triangles, false) {
    vertex_normals(positions, source.triangles, normals);
    mesh.send_shape(positions, normals);
    mesh.send_colors(std::vector<GpuMesh::Bytes>(positions.size(), {255, 255, 255, 255}));
    mesh.send_extras(std::vector<GpuMesh::Bytes>(positions.size()));
  }
};

/// A wall in front of the lower half of a ball, then the ball: white where the ball is seen.
Image half_hidden_ball(bool leave_out_hidden, int* triangles_drawn) {
  TriMesh wall;
  wall.vertices = {{-60, -60, -60}, {60, -60, -60}, {60, -60, 3}, {-60, -60, 3}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Sent front(wall), back(ball({0, 0, 0}, 30));
  EXPECT_GT(back.mesh.pieces().size(), 3u);
  const Framebuffer target(200, 200, 1);
  const ShaderSource source = depth_shaders();
  GlProgram program("white", source.vertex,
                    "#version 330 core\nout vec4 c; void main() { c = vec4(1); }");
  const Eigen::Matrix4f view_projection =
      projection_matrix(front_camera(), 1, 100, 1000) * view_matrix(front_camera());
  OcclusionCulling culling;
  target.bind();
  glEnable(GL_DEPTH_TEST);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  program.use();
  program.set("model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
  program.set("view_projection", view_projection);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  front.mesh.draw();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  culling.start();
  const int answers = culling.ask(back.mesh, view_projection);
  program.use();
  // How many triangles really went through.
  GLuint count = 0;
  glGenQueries(1, &count);
  glBeginQuery(GL_PRIMITIVES_GENERATED, count);
  if (leave_out_hidden)
    culling.draw(back.mesh, answers);
  else
    back.mesh.draw();
  glEndQuery(GL_PRIMITIVES_GENERATED);
  GLint triangles = 0;
  glGetQueryObjectiv(count, GL_QUERY_RESULT, &triangles);
  glDeleteQueries(1, &count);
  *triangles_drawn = triangles;
  glDisable(GL_DEPTH_TEST);
  return target.read();
}

TEST_F(Culling, LeavesOutHiddenPiecesAndChangesNoPixel) {
  int all = 0, some = 0;
  const Image plain = half_hidden_ball(false, &all), culled = half_hidden_ball(true, &some);
  EXPECT_EQ(plain.rgba, culled.rgba);
  EXPECT_GT(blob_of(plain).area, 1000);
  EXPECT_LT(some, 0.8 * all);
  EXPECT_GT(some, 0.3 * all);
}

TEST_F(Culling, PiecesHoldEveryTriangleOnceInsideTheirBoxes) {
  const TriMesh source = ball({4, 5, 6}, 30);
  const Sent sent(source);
  int next = 0;
  for (const auto& piece : sent.mesh.pieces()) {
    EXPECT_EQ(piece.first_triangle, next);
    EXPECT_LE(piece.box.diagonal().norm(), 104.f);
    next += piece.triangle_count;
  }
  EXPECT_EQ(next, static_cast<int>(source.triangles.size()));
}

}  // namespace
}  // namespace condyle
