#include "render/gpu_mesh.h"

namespace condyle {
namespace {

template <class T>
void send(GLenum target, GLuint buffer, std::span<const T> values, GLenum usage) {
  glBindBuffer(target, buffer);
  glBufferData(target, static_cast<GLsizeiptr>(values.size_bytes()), values.data(), usage);
}

void floats(GLuint place, GLuint buffer) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glEnableVertexAttribArray(place);
  glVertexAttribPointer(place, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
}

void bytes(GLuint place, GLuint buffer) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glEnableVertexAttribArray(place);
  glVertexAttribPointer(place, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0, nullptr);
}

}  // namespace

GpuMesh::GpuMesh(std::span<const Eigen::Vector3i> triangles, bool moving)
    : index_count_(static_cast<GLsizei>(3 * triangles.size())),
      usage_(moving ? GL_STREAM_DRAW : GL_STATIC_DRAW) {
  glBindVertexArray(array_);
  send(GL_ELEMENT_ARRAY_BUFFER, indices_, triangles, GL_STATIC_DRAW);
  floats(0, positions_);
  floats(1, normals_);
  bytes(2, colors_);
  bytes(3, extras_);
  glBindVertexArray(0);
}

void GpuMesh::send_shape(std::span<const Eigen::Vector3f> positions,
                         std::span<const Eigen::Vector3f> normals) {
  send(GL_ARRAY_BUFFER, positions_, positions, usage_);
  send(GL_ARRAY_BUFFER, normals_, normals, usage_);
}

void GpuMesh::send_look(std::span<const Bytes> colors, std::span<const Bytes> extras) {
  send(GL_ARRAY_BUFFER, colors_, colors, usage_);
  send(GL_ARRAY_BUFFER, extras_, extras, usage_);
}

void GpuMesh::draw() const {
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

GpuPoints::GpuPoints() {
  glBindVertexArray(array_);
  floats(0, points_);
  glBindVertexArray(0);
}

void GpuPoints::send(std::span<const Eigen::Vector3f> points) {
  count_ = static_cast<GLsizei>(points.size());
  condyle::send(GL_ARRAY_BUFFER, points_, points, GL_STREAM_DRAW);
}

void GpuPoints::draw() const {
  glBindVertexArray(array_);
  glDrawArrays(GL_POINTS, 0, count_);
}

}  // namespace condyle
