#include <fmt/format.h>
#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include "engine/core/error.h"
#include "engine/gltf/gltf_scene.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

float linear(float srgb) {
  return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

std::vector<double> numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
std::vector<double> numbers(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

tinygltf::Value values_of(const std::map<std::string, std::string>& texts) {
  tinygltf::Value::Object object;
  for (const auto& [key, text] : texts) object[key] = tinygltf::Value(text);
  return tinygltf::Value(object);
}

/// Fills a glTF model; all numbers are in its one buffer.
class GlbWriter {
 public:
  explicit GlbWriter(const GltfScene& scene) : scene_(scene) {
    model_.asset.version = "2.0";
    model_.asset.generator = scene.generator;
    if (!scene.extras.empty()) model_.asset.extras = values_of(scene.extras);
    model_.buffers.emplace_back();
  }

  std::string write() {
    check();
    add_nodes();
    if (scene_.motion) add_motion(*scene_.motion);
    std::ostringstream out;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model_, out, false, true))
      throw MachineError("the GLB file could not be composed");
    return std::move(out).str();
  }

 private:
  [[noreturn]] static void refuse(const std::string& item, std::size_t count, std::size_t wanted) {
    throw InputError(fmt::format("{}: {} values, but {} are needed", item, count, wanted));
  }

  void check() const {
    for (const GltfNode& node : scene_.nodes) {
      if (!node.surface) continue;
      const GltfSurface& surface = *node.surface;
      const std::size_t count = surface.vertices.size();
      if (!surface.normals.empty() && surface.normals.size() != count)
        refuse(node.name + " normals", surface.normals.size(), count);
      if (!surface.colors.empty() && surface.colors.size() != count)
        refuse(node.name + " colors", surface.colors.size(), count);
      for (const auto& target : surface.targets)
        if (target.size() != count) refuse(node.name + " targets", target.size(), count);
      const std::size_t keys = scene_.motion ? scene_.motion->key_times_s.size() : 0;
      if (!surface.targets.empty() && surface.targets.size() + 1 != keys)
        refuse(node.name + " targets", surface.targets.size(), keys == 0 ? 0 : keys - 1);
    }
    if (!scene_.motion) return;
    for (const GltfTrack& track : scene_.motion->tracks)
      if (track.poses.size() != scene_.motion->times_s.size())
        refuse("track", track.poses.size(), scene_.motion->times_s.size());
  }

  /// Appends plain values to the buffer, aligned; returns their view.
  template <class T>
  int add_view(const std::vector<T>& values, int target) {
    auto& bytes = model_.buffers.front().data;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = values.size() * sizeof(T);
    view.target = target;
    const auto* first = reinterpret_cast<const unsigned char*>(values.data());
    bytes.insert(bytes.end(), first, first + view.byteLength);
    model_.bufferViews.push_back(std::move(view));
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  /// The same; returns an accessor of all of them.
  template <class T>
  int add_accessor(const std::vector<T>& values, int component, int type, std::size_t count,
                   int target, bool normalized = false) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(values, target);
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    accessor.normalized = normalized;
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  /// Points with their bounds, which glTF requires.
  int add_points(const std::vector<Vector3f>& points, bool bounded) {
    std::vector<float> values;
    values.reserve(3 * points.size());
    Eigen::AlignedBox3f box;
    for (const Vector3f& p : points) {
      values.insert(values.end(), {p.x(), p.y(), p.z()});
      box.extend(p);
    }
    const int index = add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3,
                                   points.size(), TINYGLTF_TARGET_ARRAY_BUFFER);
    if (bounded && !points.empty()) {
      auto& accessor = model_.accessors[static_cast<std::size_t>(index)];
      accessor.minValues = numbers(box.min().cast<double>().eval());
      accessor.maxValues = numbers(box.max().cast<double>().eval());
    }
    return index;
  }

  int add_colors(const std::vector<Vector3f>& colors) {
    std::vector<std::uint16_t> values;
    values.reserve(4 * colors.size());
    for (const Vector3f& color : colors) {
      for (int k = 0; k < 3; ++k)
        values.push_back(static_cast<std::uint16_t>(
            std::lround(65535 * std::clamp(linear(color[k]), 0.f, 1.f))));
      values.push_back(65535);
    }
    return add_accessor(values, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4,
                        colors.size(), TINYGLTF_TARGET_ARRAY_BUFFER, true);
  }

  template <class T>
  int add_indices(const std::vector<Eigen::Vector3i>& triangles, int component) {
    std::vector<T> values;
    values.reserve(3 * triangles.size());
    for (const auto& t : triangles)
      for (int k = 0; k < 3; ++k) values.push_back(static_cast<T>(t[k]));
    return add_accessor(values, component, TINYGLTF_TYPE_SCALAR, values.size(),
                        TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  }
  int add_triangles(const GltfSurface& surface) {
    if (surface.vertices.size() < 65535)
      return add_indices<std::uint16_t>(surface.triangles, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
    return add_indices<std::uint32_t>(surface.triangles, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
  }

  /// Displacements, of which only those of vertices that move are stored.
  int add_target(const std::vector<Vector3f>& target) {
    std::vector<std::uint32_t> moved;
    std::vector<float> values;
    Eigen::AlignedBox3f box(Vector3f::Zero().eval());
    for (std::size_t v = 0; v < target.size(); ++v) {
      if (target[v].isZero(0)) continue;
      moved.push_back(static_cast<std::uint32_t>(v));
      values.insert(values.end(), {target[v].x(), target[v].y(), target[v].z()});
      box.extend(target[v]);
    }
    if (moved.empty() || 2 * moved.size() > target.size()) return add_points(target, true);
    tinygltf::Accessor accessor;
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = TINYGLTF_TYPE_VEC3;
    accessor.count = target.size();
    accessor.minValues = numbers(box.min().cast<double>().eval());
    accessor.maxValues = numbers(box.max().cast<double>().eval());
    accessor.sparse.isSparse = true;
    accessor.sparse.count = static_cast<int>(moved.size());
    accessor.sparse.indices.bufferView = add_view(moved, 0);
    accessor.sparse.indices.byteOffset = 0;
    accessor.sparse.indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.sparse.values.bufferView = add_view(values, 0);
    accessor.sparse.values.byteOffset = 0;
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  int add_mesh(const std::string& name, const GltfSurface& surface) {
    tinygltf::Material material;
    material.name = name;
    material.doubleSided = surface.two_sided;
    material.pbrMetallicRoughness.baseColorFactor = {
        linear(surface.color.x()), linear(surface.color.y()), linear(surface.color.z()), 1.0};
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.roughnessFactor = surface.roughness;
    model_.materials.push_back(std::move(material));

    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = static_cast<int>(model_.materials.size()) - 1;
    primitive.attributes["POSITION"] = add_points(surface.vertices, true);
    if (!surface.normals.empty())
      primitive.attributes["NORMAL"] = add_points(surface.normals, false);
    if (!surface.colors.empty()) primitive.attributes["COLOR_0"] = add_colors(surface.colors);
    primitive.indices = add_triangles(surface);
    for (const auto& target : surface.targets)
      primitive.targets.push_back({{"POSITION", add_target(target)}});
    tinygltf::Mesh mesh;
    mesh.name = name;
    mesh.weights.assign(surface.targets.size(), 0.0);
    mesh.primitives.push_back(std::move(primitive));
    model_.meshes.push_back(std::move(mesh));
    return static_cast<int>(model_.meshes.size()) - 1;
  }

  /// The root, node 0, and the scene's nodes after it.
  void add_nodes() {
    constexpr double metres = 0.001, half = 0.70710678118654752440;
    tinygltf::Node root;
    root.name = "patient";
    root.rotation = {-half, 0, 0, half};  // (left, back, up) becomes (left, up, front)
    root.scale = {metres, metres, metres};
    model_.nodes.push_back(std::move(root));
    for (const GltfNode& each : scene_.nodes) {
      tinygltf::Node node;
      node.name = each.name;
      node.translation = numbers(each.pose.t);
      node.rotation = numbers(each.pose.R);
      if (!each.extras.empty()) node.extras = values_of(each.extras);
      if (each.surface) node.mesh = add_mesh(each.name, *each.surface);
      const int index = static_cast<int>(model_.nodes.size());
      model_.nodes.push_back(std::move(node));
      model_.nodes[static_cast<std::size_t>(each.parent + 1)].children.push_back(index);
    }
    tinygltf::Scene scene;
    scene.nodes = {0};
    model_.scenes.push_back(std::move(scene));
    model_.defaultScene = 0;
  }

  int add_times(const std::vector<double>& times_s) {
    std::vector<float> values(times_s.begin(), times_s.end());
    const int index =
        add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, values.size(), 0);
    auto& accessor = model_.accessors[static_cast<std::size_t>(index)];
    accessor.minValues = {values.front()};
    accessor.maxValues = {values.back()};
    return index;
  }

  void add_channel(tinygltf::Animation& animation, int node, const char* path, int times,
                   int values) {
    tinygltf::AnimationSampler sampler;
    sampler.input = times;
    sampler.output = values;
    sampler.interpolation = "LINEAR";
    animation.samplers.push_back(std::move(sampler));
    tinygltf::AnimationChannel channel;
    channel.sampler = static_cast<int>(animation.samplers.size()) - 1;
    channel.target_node = node + 1;
    channel.target_path = path;
    animation.channels.push_back(std::move(channel));
  }

  void add_motion(const GltfMotion& motion) {
    tinygltf::Animation animation;
    animation.name = motion.name;
    if (!motion.tracks.empty() && !motion.times_s.empty()) {
      const int times = add_times(motion.times_s);
      for (const GltfTrack& track : motion.tracks) {
        std::vector<float> turns, shifts;
        Eigen::Quaterniond before = track.poses.front().R;
        for (const Pose& pose : track.poses) {
          Eigen::Quaterniond turn = pose.R;
          if (turn.dot(before) < 0) turn.coeffs() = -turn.coeffs();  // the short way round
          before = turn;
          for (const double c : numbers(turn)) turns.push_back(static_cast<float>(c));
          for (const double c : numbers(pose.t)) shifts.push_back(static_cast<float>(c));
        }
        add_channel(animation, track.node, "translation", times,
                    add_accessor(shifts, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3,
                                 track.poses.size(), 0));
        add_channel(animation, track.node, "rotation", times,
                    add_accessor(turns, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4,
                                 track.poses.size(), 0));
      }
    }
    add_weights(animation, motion);
    if (!animation.channels.empty()) model_.animations.push_back(std::move(animation));
  }

  /// At each key its own target has the weight 1, at the first key none.
  void add_weights(tinygltf::Animation& animation, const GltfMotion& motion) {
    const std::size_t keys = motion.key_times_s.size();
    if (keys < 2) return;
    std::vector<float> weights(keys * (keys - 1), 0.f);
    for (std::size_t k = 1; k < keys; ++k) weights[k * (keys - 1) + k - 1] = 1;
    int times = -1, values = -1;
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n) {
      if (!scene_.nodes[n].surface || scene_.nodes[n].surface->targets.empty()) continue;
      if (times < 0) {
        times = add_times(motion.key_times_s);
        values = add_accessor(weights, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR,
                              weights.size(), 0);
      }
      add_channel(animation, static_cast<int>(n), "weights", times, values);
    }
  }

  const GltfScene& scene_;
  tinygltf::Model model_;
};

}  // namespace

std::string glb_bytes(const GltfScene& scene) { return GlbWriter(scene).write(); }

}  // namespace condyle
