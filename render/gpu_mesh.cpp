#include "render/gpu_mesh.h"

#include <algorithm>
#include <cstdint>

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

constexpr int piece_triangles = 2048;

/// Every third bit from the ten low ones of x: for a curve through space that stays close.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

/// The triangles along a Morton curve through their centres.
std::vector<Eigen::Vector3i> along_a_curve(std::span<const Eigen::Vector3f> positions,
                                           std::span<const Eigen::Vector3i> triangles) {
  Eigen::AlignedBox3f box;
  for (const auto& p : positions) box.extend(p);
  const float scale = box.isEmpty() ? 0 : 1023 / std::max(box.sizes().maxCoeff(), 1e-6f);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& t = triangles[i];
    const Eigen::Vector3f q =
        scale * ((positions[t[0]] + positions[t[1]] + positions[t[2]]) / 3 - box.min());
    std::uint32_t key = 0;
    for (int k = 0; k < 3; ++k)
      key |= spread_bits(static_cast<std::uint32_t>(std::clamp(q[k], 0.f, 1023.f))) << k;
    order[i] = {key, static_cast<std::uint32_t>(i)};
  }
  std::sort(order.begin(), order.end());
  std::vector<Eigen::Vector3i> sorted;
  sorted.reserve(triangles.size());
  for (const auto& [key, i] : order) sorted.push_back(triangles[i]);
  return sorted;
}

}  // namespace

GpuMesh::GpuMesh(std::span<const Eigen::Vector3f> positions,
                 std::span<const Eigen::Vector3i> triangles, bool moving)
    : triangles_(along_a_curve(positions, triangles)),
      usage_(moving ? GL_STREAM_DRAW : GL_STATIC_DRAW) {
  const int count = static_cast<int>(triangles.size());
  for (int first = 0; first < count; first += piece_triangles)
    pieces_.push_back({first, std::min(piece_triangles, count - first), {}});
  glBindVertexArray(array_);
  send(GL_ELEMENT_ARRAY_BUFFER, indices_, std::span<const Eigen::Vector3i>(triangles_),
       GL_STATIC_DRAW);
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
  for (auto& piece : pieces_) {
    piece.box.setEmpty();
    for (int t = 0; t < piece.triangle_count; ++t)
      for (const int v : triangles_[static_cast<std::size_t>(piece.first_triangle + t)])
        piece.box.extend(positions[v]);
  }
}

void GpuMesh::send_colors(std::span<const Bytes> colors) {
  send(GL_ARRAY_BUFFER, colors_, colors, usage_);
}

void GpuMesh::send_extras(std::span<const Bytes> extras) {
  send(GL_ARRAY_BUFFER, extras_, extras, GL_STATIC_DRAW);
}

void GpuMesh::send_rest(std::span<const Eigen::Vector3f> positions) {
  glBindVertexArray(array_);
  send(GL_ARRAY_BUFFER, rest_, positions, GL_STATIC_DRAW);
  floats(5, rest_);
  glBindVertexArray(0);
}

void GpuMesh::send_values(std::span<const float> values) {
  glBindVertexArray(array_);
  if (values.empty()) {
    glDisableVertexAttribArray(4);
  } else {
    send(GL_ARRAY_BUFFER, values_, values, GL_STREAM_DRAW);
    glEnableVertexAttribArray(4);
    glVertexAttribPointer(4, 1, GL_FLOAT, GL_FALSE, 0, nullptr);
  }
  glBindVertexArray(0);
}

void GpuMesh::draw() const {
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * triangles_.size()), GL_UNSIGNED_INT,
                 nullptr);
}

void GpuMesh::draw(const Piece& piece) const {
  glBindVertexArray(array_);
  glDrawElements(
      GL_TRIANGLES, 3 * piece.triangle_count, GL_UNSIGNED_INT,
      reinterpret_cast<const void*>(sizeof(Eigen::Vector3i) * std::size_t(piece.first_triangle)));
}

void GpuMesh::send_cover(std::span<const Eigen::Vector3i> triangles) {
  cover_count_ = static_cast<GLsizei>(3 * triangles.size());
  glBindVertexArray(0);
  send(GL_ELEMENT_ARRAY_BUFFER, cover_, triangles, GL_STATIC_DRAW);
}

void GpuMesh::draw_cover() const {
  if (cover_count_ == 0) return;
  glBindVertexArray(array_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, cover_);
  glDrawElements(GL_TRIANGLES, cover_count_, GL_UNSIGNED_INT, nullptr);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
}

GpuLines::GpuLines() {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, ends_);
  constexpr GLsizei stride = 6 * sizeof(float);
  for (const GLuint place : {0u, 1u}) {
    glEnableVertexAttribArray(place);
    glVertexAttribPointer(place, 3, GL_FLOAT, GL_FALSE, stride,
                          reinterpret_cast<const void*>(place * 3 * sizeof(float)));
    glVertexAttribDivisor(place, 1);
  }
  floats(2, colors_);
  glVertexAttribDivisor(2, 1);
  glBindVertexArray(0);
}

void GpuLines::send(std::span<const Eigen::Vector3f> ends,
                    std::span<const Eigen::Vector3f> colors) {
  count_ = static_cast<GLsizei>(colors.size());
  condyle::send(GL_ARRAY_BUFFER, ends_, ends, GL_STREAM_DRAW);
  condyle::send(GL_ARRAY_BUFFER, colors_, colors, GL_STREAM_DRAW);
}

void GpuLines::draw() const {
  glBindVertexArray(array_);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count_);
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
