#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/error.h"
#include "engine/mesh_io/json_depth.h"
#include "engine/mesh_io/mesh_files.h"
#include "engine/mesh_io/readers.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Eigen::Affine3d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr std::size_t max_json_bytes = std::size_t{16} << 20;

/// The parts of glTF 2.0 that hold a surface: scene, nodes, meshes, accessors, one binary chunk.
class GlbReader {
 public:
  GlbReader(const fs::path& file, std::string_view content) : file_(file) { split(content); }

  TriMesh read() {
    check_extensions();
    const json nodes = gltf_.value("nodes", json::array());
    if (!nodes.is_array() || nodes.empty())
      refuse("nodes", "there are none; the file shows nothing");
    std::vector<char> visited(nodes.size(), 0);
    for (const std::size_t root : roots(nodes)) visit(nodes, root, Affine3d::Identity(), visited);
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& item, const std::string& problem) const {
    throw InputError(file_, item, problem);
  }

  std::uint32_t word(std::string_view bytes, std::size_t at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  }

  void split(std::string_view content) {
    if (content.size() < 20 || content.substr(0, 4) != "glTF")
      refuse("", "is not a GLB file (it begins like " + looks_like(content) +
                     "); give it the right extension, or export it as binary glTF");
    if (const auto version = word(content, 4); version != 2)
      refuse("header", fmt::format("glTF version {} is not read; export it as version 2", version));
    if (const auto length = word(content, 8); length != content.size())
      refuse(
          "header",
          fmt::format("promises {} bytes, but the file has {}: it is {}; export or copy it again",
                      length, content.size(), length > content.size() ? "cut short" : "damaged"));
    std::string_view rest = content.substr(12), text;
    for (int chunk = 0; rest.size() >= 8; ++chunk) {
      const std::size_t length = word(rest, 0);
      const std::uint32_t type = word(rest, 4);
      if (length > rest.size() - 8)
        refuse(fmt::format("chunk {}", chunk),
               fmt::format("promises {} bytes, but {} follow: the file is damaged", length,
                           rest.size() - 8));
      if (chunk == 0 && type != 0x4E4F534A)
        refuse("chunk 0", "is not the JSON chunk: the file is damaged");
      if (chunk == 0) text = rest.substr(8, length);
      if (chunk == 1 && type == 0x004E4942) bytes_ = rest.substr(8, length);
      rest.remove_prefix(8 + length);
    }
    if (text.size() > max_json_bytes)
      refuse("chunk 0",
             fmt::format("has {} bytes of JSON; at most {} are read", text.size(), max_json_bytes));
    if (json_depth(text) > max_json_depth)
      refuse("chunk 0", "nests its JSON too deep: the file is damaged");
    gltf_ = json::parse(text.begin(), text.end(), nullptr, false);
    if (!gltf_.is_object()) refuse("chunk 0", "is not valid JSON: the file is damaged");
  }

  void check_extensions() const {
    const json required = gltf_.value("extensionsRequired", json::array());
    for (const auto& name : required) {
      if (name == "KHR_mesh_quantization" || name == "KHR_texture_transform" ||
          name == "KHR_materials_unlit" || name == "KHR_texture_basisu" ||
          name == "EXT_texture_webp")
        continue;
      refuse_extension(name.is_string() ? name.get<std::string>() : name.dump());
    }
  }
  [[noreturn]] void refuse_extension(const std::string& name) const {
    if (name == "KHR_draco_mesh_compression")
      refuse("",
             "is compressed with Draco (KHR_draco_mesh_compression), which is not read; export it "
             "again without compression");
    if (name.find("meshopt") != std::string::npos)
      refuse("", "is compressed (" + name +
                     "), which is not read; export it again without compression");
    refuse("", "needs the glTF extension " + name.substr(0, 60) +
                   ", which is not read; export it without it");
  }

  /// A whole number of an object, in [0, limit).
  std::size_t index(const json& object, const char* key, const std::string& item,
                    std::size_t limit) const {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number_integer())
      refuse(item, fmt::format("has no number \"{}\"", key));
    const double value = found->get<double>();
    if (!(value >= 0 && value < static_cast<double>(limit)))
      refuse(item,
             fmt::format("its \"{}\" is {}; it must be from 0 to below {}", key, value, limit));
    return static_cast<std::size_t>(value);
  }
  std::size_t index_or(const json& object, const char* key, const std::string& item,
                       std::size_t limit, std::size_t otherwise) const {
    return object.contains(key) ? index(object, key, item, limit) : otherwise;
  }
  const json& entry(const char* list, std::size_t i) const {
    const auto found = gltf_.find(list);
    if (found == gltf_.end() || !found->is_array() || i >= found->size() ||
        !(*found)[i].is_object())
      refuse(fmt::format("{} {}", list, i), "is spoken of, but is not there");
    return (*found)[i];
  }
  std::size_t count_of(const char* list) const {
    const auto found = gltf_.find(list);
    return found != gltf_.end() && found->is_array() ? found->size() : 0;
  }

  std::vector<std::size_t> list_of(const json& object, const char* key, const std::string& item,
                                   std::size_t limit) const {
    std::vector<std::size_t> result;
    const auto found = object.find(key);
    if (found == object.end()) return result;
    if (!found->is_array()) refuse(item, fmt::format("its \"{}\" is no list", key));
    for (const auto& value : *found) {
      if (!value.is_number_integer() ||
          !(value.get<double>() >= 0 && value.get<double>() < static_cast<double>(limit)))
        refuse(item, fmt::format("its \"{}\" speaks of {}, but there are {}", key,
                                 value.dump().substr(0, 40), limit));
      result.push_back(value.get<std::size_t>());
    }
    return result;
  }

  std::vector<std::size_t> roots(const json& nodes) const {
    if (count_of("scenes") > 0) {
      const std::size_t scene = index_or(gltf_, "scene", "scene", count_of("scenes"), 0);
      return list_of(entry("scenes", scene), "nodes", fmt::format("scenes {}", scene),
                     nodes.size());
    }
    std::vector<char> is_child(nodes.size(), 0);
    for (std::size_t n = 0; n < nodes.size(); ++n)
      for (const auto child :
           list_of(entry("nodes", n), "children", fmt::format("nodes {}", n), nodes.size()))
        is_child[child] = 1;
    std::vector<std::size_t> result;
    for (std::size_t n = 0; n < nodes.size(); ++n)
      if (!is_child[n]) result.push_back(n);
    return result;
  }

  std::optional<std::vector<double>> numbers(const json& object, const char* key, std::size_t count,
                                             const std::string& item) const {
    const auto found = object.find(key);
    if (found == object.end()) return std::nullopt;
    std::vector<double> values;
    if (found->is_array() && found->size() == count)
      for (const auto& value : *found)
        if (value.is_number() && std::abs(value.get<double>()) <= 1e9)
          values.push_back(value.get<double>());
    if (values.size() != count)
      refuse(item, fmt::format("its \"{}\" is not {} finite numbers", key, count));
    return values;
  }

  Affine3d placement(const json& node, const std::string& item) const {
    Affine3d place = Affine3d::Identity();
    if (const auto m = numbers(node, "matrix", 16, item)) {
      place.matrix() = Eigen::Map<const Eigen::Matrix4d>(m->data());
      if (!place.matrix().row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1)))
        refuse(item, "its \"matrix\" is not affine");
      return place;
    }
    if (const auto t = numbers(node, "translation", 3, item))
      place.translate(Vector3d((*t)[0], (*t)[1], (*t)[2]));
    if (const auto r = numbers(node, "rotation", 4, item)) {
      const Eigen::Quaterniond q((*r)[3], (*r)[0], (*r)[1], (*r)[2]);
      if (!(q.norm() > 1e-6)) refuse(item, "its \"rotation\" is a zero quaternion");
      place.rotate(q.normalized());
    }
    if (const auto s = numbers(node, "scale", 3, item))
      place.scale(Vector3d((*s)[0], (*s)[1], (*s)[2]));
    return place;
  }

  /// Traverses the tree with an explicit stack: a deep file must not overflow the program's stack.
  void visit(const json& nodes, std::size_t root, const Affine3d& start,
             std::vector<char>& visited) {
    std::vector<std::pair<std::size_t, Affine3d>> waiting = {{root, start}};
    while (!waiting.empty()) {
      const auto [n, parent] = waiting.back();
      waiting.pop_back();
      const std::string item = fmt::format("nodes {}", n);
      if (visited[n]++) refuse(item, "hangs in two places; the nodes must form a tree");
      const json& node = entry("nodes", n);
      const Affine3d place = parent * placement(node, item);
      if (node.contains("mesh")) add_mesh(index(node, "mesh", item, count_of("meshes")), place);
      const auto children = list_of(node, "children", item, nodes.size());
      for (std::size_t c = children.size(); c-- > 0;) waiting.emplace_back(children[c], place);
    }
  }

  void add_mesh(std::size_t m, const Affine3d& place) {
    const json& mesh = entry("meshes", m);
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array())
      refuse(fmt::format("meshes {}", m), "has no primitives");
    for (std::size_t p = 0; p < primitives->size(); ++p)
      add_primitive((*primitives)[p], fmt::format("meshes {} primitive {}", m, p), place);
  }

  /// A range of values in the binary chunk, checked to lie within it.
  struct View {
    const char* data;
    std::size_t count, stride, components;
    int type;
    bool normalized;
  };

  View view_of(std::size_t a, std::size_t components, const char* shape,
               const std::string& user) const {
    const std::string item = fmt::format("{}, accessors {}", user, a);
    const json& accessor = entry("accessors", a);
    if (accessor.contains("sparse")) refuse(item, "is sparse, which is not read; export it again");
    const auto kind = accessor.find("type");
    if (kind == accessor.end() || !kind->is_string()) refuse(item, "has no \"type\"");
    if (*kind == "VEC4" && components == 3 && std::string_view(shape) == "colour")
      components = 4;
    else if (*kind != (components == 1 ? "SCALAR" : "VEC3"))
      refuse(item, fmt::format("has the wrong type for a {}", shape));
    View view{};
    view.components = components;
    view.type = static_cast<int>(index(accessor, "componentType", item, 1 << 20));
    view.normalized = accessor.contains("normalized") && accessor["normalized"] == true;
    const std::size_t sizes[] = {1, 1, 2, 2, 0, 4, 4};
    const std::size_t size = view.type >= 5120 && view.type <= 5126 ? sizes[view.type - 5120] : 0;
    if (size == 0) refuse(item, fmt::format("has the unknown component type {}", view.type));
    view.count = index(accessor, "count", item, std::size_t{1} << 40);
    const std::size_t b = index(accessor, "bufferView", item, count_of("bufferViews"));
    const json& buffer = entry("bufferViews", b);
    const std::string buffer_item = fmt::format("bufferViews {}", b);
    const json& store = entry("buffers", index(buffer, "buffer", buffer_item, count_of("buffers")));
    if (store.contains("uri"))
      refuse(buffer_item, "its data is in another file; save everything in one .glb file");
    constexpr std::size_t most = std::size_t{1} << 31;
    const std::size_t offset = index_or(buffer, "byteOffset", buffer_item, most, 0);
    const std::size_t length = index(buffer, "byteLength", buffer_item, most);
    if (offset > bytes_.size() || length > bytes_.size() - offset)
      refuse(buffer_item,
             fmt::format("reaches to byte {}, but the file has {} bytes of data: it is damaged",
                         offset + length, bytes_.size()));
    view.stride = index_or(buffer, "byteStride", buffer_item, 1024, 0);
    if (view.stride == 0) view.stride = size * components;
    const std::size_t inner = index_or(accessor, "byteOffset", item, most, 0);
    const double needed = view.count == 0 ? 0
                                          : static_cast<double>(inner) +
                                                static_cast<double>(view.count - 1) *
                                                    static_cast<double>(view.stride) +
                                                static_cast<double>(size * components);
    if (needed > static_cast<double>(length))
      refuse(item, fmt::format(
                       "states {} values, which need {:.0f} bytes, but has {}: the file is damaged",
                       view.count, needed, length));
    view.data = bytes_.data() + offset + inner;
    return view;
  }

  static double value(const View& view, std::size_t i, std::size_t component) {
    const char* at = view.data + i * view.stride;
    const auto get = [&]<class T>(T read, double full) {
      std::memcpy(&read, at + component * sizeof(T), sizeof(T));
      return view.normalized ? std::max(static_cast<double>(read) / full, -1.0)
                             : static_cast<double>(read);
    };
    switch (view.type) {
      case 5120:
        return get(std::int8_t{}, 127);
      case 5121:
        return get(std::uint8_t{}, 255);
      case 5122:
        return get(std::int16_t{}, 32767);
      case 5123:
        return get(std::uint16_t{}, 65535);
      case 5125:
        return get(std::uint32_t{}, 4294967295.0);
      default:
        return get(float{}, 1);
    }
  }

  void add_primitive(const json& primitive, const std::string& item, const Affine3d& place) {
    if (!primitive.is_object()) refuse(item, "is no object");
    if (const auto extensions = primitive.find("extensions"); extensions != primitive.end())
      for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
        if (extensions->contains(name)) refuse_extension(name);
    const std::size_t mode = index_or(primitive, "mode", item, 7, 4);
    if (mode < 4) return;  // points and lines are no surface
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object())
      refuse(item, "has no attributes");
    const View places =
        view_of(index(*attributes, "POSITION", item, count_of("accessors")), 3, "place", item);
    const std::size_t first = mesh_.vertices.size();
    check_count(file_, "vertices", static_cast<double>(first + places.count), max_mesh_vertices);
    for (std::size_t i = 0; i < places.count; ++i) {
      const Vector3d v(value(places, i, 0), value(places, i, 1), value(places, i, 2));
      const Vector3d p = place * v;
      if (!sound_point(v) || !sound_point(p))
        refuse_point(file_, fmt::format("{}, vertex {}", item, i), sound_point(v) ? p : v);
      mesh_.vertices.push_back(p);
    }
    add_colors(*attributes, item, first, places.count);
    add_triangles(primitive, item, mode, first, places.count, place.linear().determinant() < 0);
  }

  void add_colors(const json& attributes, const std::string& item, std::size_t first,
                  std::size_t count) {
    if (!attributes.contains("COLOR_0") || mesh_.colors.size() != first) {
      mesh_.colors.clear();
      return;
    }
    const View view =
        view_of(index(attributes, "COLOR_0", item, count_of("accessors")), 3, "colour", item);
    if (view.count != count)
      refuse(item, fmt::format("has {} colours for {} vertices", view.count, count));
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::Vector3f color;
      for (std::size_t k = 0; k < 3; ++k) {
        // The format's colours are linear light, ours sRGB.
        const double c = value(view, i, k);
        if (!(c >= 0 && c <= 1))
          refuse(item, fmt::format("vertex {} has the colour {}, outside 0 to 1", i, c));
        color[static_cast<int>(k)] =
            static_cast<float>(c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055);
      }
      mesh_.colors.push_back(color);
    }
  }

  void add_triangles(const json& primitive, const std::string& item, std::size_t mode,
                     std::size_t first, std::size_t vertices, bool mirrored) {
    std::optional<View> view;
    if (primitive.contains("indices"))
      view = view_of(index(primitive, "indices", item, count_of("accessors")), 1, "index", item);
    if (view && view->type == 5126) refuse(item, "has indices that are not integers");
    const std::size_t count = view ? view->count : vertices;
    const std::size_t triangles = mode == 4 ? count / 3 : count < 3 ? 0 : count - 2;
    if (mode == 4 && count % 3 != 0)
      refuse(item,
             fmt::format("has {} indices, which is no multiple of 3: the file is damaged", count));
    check_count(file_, "triangles", static_cast<double>(mesh_.triangles.size() + triangles),
                max_mesh_triangles);
    const auto corner = [&](std::size_t i) {
      const double n = view ? value(*view, i, 0) : static_cast<double>(i);
      if (!(n >= 0 && n < static_cast<double>(vertices)))
        refuse(item, fmt::format("index {} speaks of vertex {}, but there are {}", i, n, vertices));
      return static_cast<int>(first + static_cast<std::size_t>(n));
    };
    for (std::size_t t = 0; t < triangles; ++t) {
      Eigen::Vector3i triangle;
      if (mode == 4)
        triangle = {corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)};
      else if (mode == 5)
        triangle = {corner(t), corner(t + 1 + t % 2), corner(t + 2 - t % 2)};
      else
        triangle = {corner(0), corner(t + 1), corner(t + 2)};
      if (mirrored) std::swap(triangle[1], triangle[2]);
      mesh_.triangles.push_back(triangle);
    }
  }

  const fs::path& file_;
  json gltf_;
  std::string_view bytes_;
  TriMesh mesh_;
};

}  // namespace

TriMesh read_glb(const fs::path& file, std::string_view content) {
  try {
    return GlbReader(file, content).read();
  } catch (const json::exception& error) {
    throw InputError(file, "chunk 0", std::string("has unexpected JSON: ") + error.what());
  }
}

}  // namespace condyle
