#include "render/gl/gpu_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "engine/core/archive.h"
#include "engine/core/user_cache.h"
#include "engine/mesh/patches.h"
#include "engine/mesh/simplify.h"

namespace condyle {
namespace {

template <class T>
void send(GLenum target, GLuint buffer, std::span<const T> values, GLenum usage) {
  glBindBuffer(target, buffer);
  glBufferData(target, static_cast<GLsizeiptr>(values.size_bytes()), values.data(), usage);
}

void floats(GLuint index, GLuint buffer) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glEnableVertexAttribArray(index);
  glVertexAttribPointer(index, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
}

void bytes(GLuint index, GLuint buffer) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glEnableVertexAttribArray(index);
  glVertexAttribPointer(index, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0, nullptr);
}

constexpr int piece_triangles = 64;
// The penumbra of a shadow is about 3 mm wide, and begins farther off its surface than this.
constexpr double coarse_error_mm = 0.2;
constexpr int few_triangles = 4000;
// Below this, patches are made sooner than read.
constexpr std::size_t slow_triangles = 5000;

/// The facing directions of a piece's triangles. Degenerate triangles have none: they are not drawn
/// either.
DirectionCone cone_of(std::span<const Eigen::Vector3f> positions,
                      std::span<const Eigen::Vector3i> triangles) {
  std::array<Eigen::Vector3f, piece_triangles> normals;
  std::size_t count = 0;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const auto& t : triangles) {
    const Eigen::Vector3f& a = positions[t[0]];
    const Eigen::Vector3f n = (positions[t[1]] - a).cross(positions[t[2]] - a);
    const float length = n.norm();
    if (!(length > 0)) continue;
    normals[count] = n / length;
    sum += normals[count++];
  }
  DirectionCone cone;
  const float length = sum.norm();
  if (!(length > 0)) return cone;
  cone.axis = sum / length;
  float least = 1;
  for (std::size_t i = 0; i < count; ++i) least = std::min(least, cone.axis.dot(normals[i]));
  if (least > 0.05f) cone.sine = std::sqrt(std::max(0.f, 1 - least * least));
  return cone;
}

/// The patches that `cut` makes of a surface, kept on disk where that takes long.
template <class Cut>
Patches stored_patches(const char* kind, std::span<const Eigen::Vector3f> positions,
                       std::span<const Eigen::Vector3i> triangles, const Cut& cut) {
  if (triangles.size() < slow_triangles) return cut();
  const ResultCache results(user_cache_folder(), kind);
  const std::size_t sizes[] = {positions.size(), triangles.size()};
  const std::uint64_t inputs = word_hash(
      triangles.data(), triangles.size_bytes(),
      word_hash(positions.data(), positions.size_bytes(), word_hash(sizes, sizeof sizes)));
  Patches patches;
  if (const auto bytes = results.read(inputs)) {
    ArchiveReader reader(*bytes);
    reader(patches.triangles, patches.first);
    if (reader.complete()) return patches;
  }
  patches = cut();
  ArchiveWriter writer;
  writer(patches.triangles, patches.first);
  results.write(inputs, writer.take());
  return patches;
}

GpuMesh::Surface surface_of(Patches patches) {
  GpuMesh::Surface surface{std::move(patches.triangles), {}, {}, {}};
  for (std::size_t i = 0; i + 1 < patches.first.size(); ++i)
    surface.pieces.push_back({patches.first[i], patches.first[i + 1] - patches.first[i], {}, {}});
  return surface;
}

void find_corners(GpuMesh::Surface& surface, std::size_t points) {
  std::vector<char> used(points, 0);
  for (const auto& t : surface.triangles)
    for (const int v : t) used[static_cast<std::size_t>(v)] = 1;
  for (std::size_t i = 0; i < points; ++i)
    if (used[i]) surface.corners.push_back(static_cast<int>(i));
}

/// Computes the boxes and directions of the pieces.
void measure(GpuMesh::Surface& surface, std::span<const Eigen::Vector3f> points) {
  const std::span<const Eigen::Vector3i> all = surface.triangles;
  surface.box.setEmpty();
  for (auto& piece : surface.pieces) {
    const auto own = all.subspan(static_cast<std::size_t>(piece.first_triangle),
                                 static_cast<std::size_t>(piece.triangle_count));
    piece.box.setEmpty();
    for (const auto& t : own)
      for (const int v : t) piece.box.extend(points[static_cast<std::size_t>(v)]);
    piece.normals = cone_of(points, own);
    surface.box.extend(piece.box);
  }
}

}  // namespace

template <class T>
std::vector<T> GpuMesh::ordered(std::span<const T> values) const {
  std::vector<T> on_card;
  on_card.reserve(order_.size());
  for (const int from : order_) on_card.push_back(values[static_cast<std::size_t>(from)]);
  return on_card;
}

template <class T>
void GpuMesh::send_ordered(GLuint buffer, std::span<const T> values, GLenum usage) {
  send(GL_ARRAY_BUFFER, buffer, std::span<const T>(ordered(values)), usage);
}

GpuMesh::GpuMesh(std::span<const Eigen::Vector3f> positions,
                 std::span<const Eigen::Vector3i> triangles, Use use)
    : usage_(use == Use::still ? GL_STATIC_DRAW : GL_STREAM_DRAW) {
  if (use == Use::overlay)
    fine_.triangles.assign(triangles.begin(), triangles.end());
  else
    fine_ = surface_of(stored_patches("patches", positions, triangles, [&] {
      return cut_into_patches(positions, triangles, piece_triangles);
    }));
  // Vertices in the order of their first use: without a GPU a few hundred neighbours are cached at
  // a time, and evicted ones are computed again.
  card_vertex_.assign(positions.size(), -1);
  for (auto& t : fine_.triangles)
    for (int& v : t) {
      int& index = card_vertex_[static_cast<std::size_t>(v)];
      if (index < 0) {
        index = static_cast<int>(order_.size());
        order_.push_back(v);
      }
      v = index;
    }
  find_corners(fine_, order_.size());
  describe();
}

GpuMesh GpuMesh::twin() const {
  GpuMesh other(fine_, coarse_, usage_);
  other.order_ = order_;
  other.card_vertex_ = card_vertex_;
  other.describe();
  return other;
}

/// Uploads the attributes.
void GpuMesh::describe() {
  glBindVertexArray(array_);
  send(GL_ELEMENT_ARRAY_BUFFER, indices_, std::span<const Eigen::Vector3i>(fine_.triangles),
       GL_STATIC_DRAW);
  floats(0, positions_);
  floats(1, normals_);
  bytes(2, colors_);
  bytes(3, extras_);
  glBindVertexArray(0);
}

void GpuMesh::add_coarse(std::span<const Eigen::Vector3f> positions,
                         std::span<const Eigen::Vector3i> triangles) {
  const int few = std::max(few_triangles, static_cast<int>(triangles.size()) / 4);
  if (static_cast<int>(triangles.size()) <= few) return;
  coarse_ = surface_of(stored_patches("coarse", positions, triangles, [&] {
    return cut_into_patches(positions, coarser(positions, triangles, few, coarse_error_mm),
                            piece_triangles);
  }));
  for (auto& t : coarse_.triangles)
    for (int& v : t) v = card_vertex_[static_cast<std::size_t>(v)];
  find_corners(coarse_, order_.size());
}

const GpuMesh::Surface& GpuMesh::fine() const {
  if (!fine_measured_) measure(fine_, points_);
  fine_measured_ = true;
  return fine_;
}

void GpuMesh::send_shape(std::span<const Eigen::Vector3f> positions,
                         std::span<const Eigen::Vector3f> normals) {
  points_ = ordered(positions);
  send(GL_ARRAY_BUFFER, positions_, std::span<const Eigen::Vector3f>(points_), usage_);
  send_ordered(normals_, normals, usage_);
  measure(coarse_, points_);
  fine_measured_ = false;
}

void GpuMesh::send_colors(std::span<const Bytes> colors) { send_ordered(colors_, colors, usage_); }

void GpuMesh::send_extras(std::span<const Bytes> extras) {
  send_ordered(extras_, extras, GL_STATIC_DRAW);
}

void GpuMesh::send_rest(std::span<const Eigen::Vector3f> positions) {
  glBindVertexArray(array_);
  send_ordered(rest_, positions, GL_STATIC_DRAW);
  floats(5, rest_);
  glBindVertexArray(0);
}

void GpuMesh::send_values(std::span<const float> values) {
  glBindVertexArray(array_);
  if (values.empty()) {
    glDisableVertexAttribArray(4);
  } else {
    send_ordered(values_, values, GL_STREAM_DRAW);
    use_values();
  }
  glBindVertexArray(0);
}

void GpuMesh::send_displacements_to(const GpuMesh& other) {
  assert(order_ == other.order_);
  std::vector<float> displacements(points_.size());
  for (std::size_t i = 0; i < displacements.size(); ++i)
    displacements[i] = (points_[i] - other.points_[i]).norm();
  glBindVertexArray(array_);
  send(GL_ARRAY_BUFFER, values_, std::span<const float>(displacements), GL_STREAM_DRAW);
  use_values();
  glBindVertexArray(0);
}

void GpuMesh::use_values() {
  glEnableVertexAttribArray(4);
  glVertexAttribPointer(4, 1, GL_FLOAT, GL_FALSE, 0, nullptr);
}

void GpuMesh::draw() const {
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * fine_.triangles.size()), GL_UNSIGNED_INT,
                 nullptr);
}

void GpuMesh::draw(std::span<const Eigen::Vector3i> chosen) const {
  if (chosen.empty()) return;
  glBindVertexArray(array_);
  send(GL_ELEMENT_ARRAY_BUFFER, chosen_, chosen, GL_STREAM_DRAW);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * chosen.size()), GL_UNSIGNED_INT, nullptr);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
}

void GpuMesh::send_cover(std::span<const Eigen::Vector3i> triangles) {
  cover_count_ = static_cast<GLsizei>(3 * triangles.size());
  std::vector<Eigen::Vector3i> on_card(triangles.begin(), triangles.end());
  for (auto& t : on_card)
    for (int& v : t) v = card_vertex_[static_cast<std::size_t>(v)];
  glBindVertexArray(0);
  send(GL_ELEMENT_ARRAY_BUFFER, cover_, std::span<const Eigen::Vector3i>(on_card), GL_STATIC_DRAW);
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
  for (const GLuint index : {0u, 1u}) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, 3, GL_FLOAT, GL_FALSE, stride,
                          reinterpret_cast<const void*>(index * 3 * sizeof(float)));
    glVertexAttribDivisor(index, 1);
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
