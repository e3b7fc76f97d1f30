#include "engine/mesh_io/texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh/triangle_tree.h"
#include "engine/mesh_io/mesh_files.h"
#include "engine/mesh_io/picture_files.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb/stb_image.h>

namespace condyle {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uint32_t max_side = 16384;
constexpr std::size_t max_texture_bytes = std::size_t{1} << 30;

/// Width and height from a PNG's header; absent if it is not a PNG.
std::optional<std::array<std::uint32_t, 2>> png_sides(std::string_view bytes) {
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n") || bytes.size() < 24) return {};
  const auto number = [&](std::size_t at) {
    std::uint32_t n = 0;
    for (std::size_t i = at; i < at + 4; ++i) n = n << 8 | static_cast<unsigned char>(bytes[i]);
    return n;
  };
  return std::array{number(16), number(20)};
}

const stbi_uc* data_of(std::string_view bytes) {
  return reinterpret_cast<const stbi_uc*>(bytes.data());
}
int size_of(std::string_view bytes) {
  return static_cast<int>(std::min<std::size_t>(bytes.size(), INT32_MAX));
}

/// Refuses what is no picture, or a very large one, before its pixels are decoded.
void check_picture(const fs::path& file, std::string_view bytes) {
  const auto check_sides = [&](std::uint32_t width, std::uint32_t height) {
    if (width > max_side || height > max_side)
      throw InputError(file, "picture",
                       fmt::format("is too large: {}x{}; at most {} pixels a side, make it smaller",
                                   width, height, max_side));
  };
  if (const auto sides = png_sides(bytes)) check_sides((*sides)[0], (*sides)[1]);
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(data_of(bytes), size_of(bytes), &width, &height, &channels))
    throw InputError(file, "picture", "is no JPEG or PNG picture, or is damaged");
  check_sides(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
}

[[noreturn]] void refuse_damaged(const fs::path& file) {
  throw InputError(file, "picture", std::string("is damaged (") + stbi_failure_reason() + ")");
}

ColourPicture decode(const fs::path& file, std::string_view bytes) {
  check_picture(file, bytes);
  ColourPicture picture;
  int channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data_of(bytes), size_of(bytes), &picture.width, &picture.height,
                            &channels, 3),
      stbi_image_free);
  if (!pixels) refuse_damaged(file);
  picture.rgb.assign(pixels.get(), pixels.get() + std::size_t{3} * picture.width * picture.height);
  return picture;
}

void lay_picture(const fs::path& file, std::string_view bytes, Texture& texture) {
  ColourPicture picture = decode(file, bytes);
  texture.width = picture.width;
  texture.height = picture.height;
  texture.rgb = std::move(picture.rgb);
}

/// The one textured surface of a GLB that read_mesh has accepted.
class GlbTexture {
 public:
  explicit GlbTexture(std::string_view content) {
    if (content.size() < 28) return;
    const std::size_t size = number_at(content, 12);
    if (content.size() < 28 + size) return;
    gltf_ = json::parse(content.substr(20, size), nullptr, false);
    bytes_ = content.substr(28 + size);
  }

  /// The picture's bytes, or none; fills surface and corners.
  std::string_view read(Texture& texture) const {
    if (!gltf_.is_object() || gltf_.value("meshes", json::array()).size() != 1) return {};
    for (const auto& node : gltf_.value("nodes", json::array()))
      for (const char* moved : {"matrix", "translation", "rotation", "scale"})
        if (node.contains(moved)) return {};
    const auto& primitives = gltf_["meshes"][0]["primitives"];
    if (primitives.size() != 1) return {};
    const auto& primitive = primitives[0];
    const auto& attributes = primitive["attributes"];
    if (primitive.value("mode", 4) != 4 || !attributes.contains("TEXCOORD_0") ||
        !primitive.contains("material") || !primitive.contains("indices"))
      return {};
    const auto& material = gltf_["materials"].at(primitive["material"].get<std::size_t>());
    if (!material.contains("pbrMetallicRoughness") ||
        !material["pbrMetallicRoughness"].contains("baseColorTexture"))
      return {};
    const auto& base = material["pbrMetallicRoughness"]["baseColorTexture"];
    if (base.contains("extensions") || base.value("texCoord", 0) != 0) return {};
    const auto& source = gltf_["textures"].at(base["index"].get<std::size_t>());
    if (!source.contains("source")) return {};
    const auto& image = gltf_["images"].at(source["source"].get<std::size_t>());
    if (!image.contains("bufferView")) return {};

    const auto places = floats(attributes["POSITION"].get<std::size_t>(), 3);
    const auto uv = floats(attributes["TEXCOORD_0"].get<std::size_t>(), 2);
    const auto corners = indices(primitive["indices"].get<std::size_t>());
    if (places.empty() || places.size() / 3 != uv.size() / 2 || corners.size() % 3 != 0) return {};
    for (std::size_t i = 0; i < places.size(); i += 3)
      texture.surface.vertices.emplace_back(places[i], places[i + 1], places[i + 2]);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      for (std::size_t k = i; k < i + 3; ++k) {
        if (corners[k] >= texture.surface.vertices.size()) return {};
        texture.corners.emplace_back(uv[2 * corners[k]], uv[2 * corners[k] + 1]);
      }
      texture.surface.triangles.emplace_back(static_cast<int>(corners[i]),
                                             static_cast<int>(corners[i + 1]),
                                             static_cast<int>(corners[i + 2]));
    }
    return view(image["bufferView"].get<std::size_t>(), 0);
  }

 private:
  static std::size_t number_at(std::string_view content, std::size_t at) {
    std::uint32_t n = 0;
    std::memcpy(&n, content.data() + at, sizeof n);
    return n;
  }

  std::string_view view(std::size_t which, std::size_t offset) const {
    const auto& described = gltf_["bufferViews"].at(which);
    const std::size_t first = described.value("byteOffset", std::size_t{0});
    const std::size_t size = described["byteLength"].get<std::size_t>();
    if (first > bytes_.size() || size > bytes_.size() - first || offset > size) return {};
    return bytes_.substr(first + offset, size - offset);
  }

  std::vector<float> floats(std::size_t which, std::size_t width) const {
    const auto& accessor = gltf_["accessors"].at(which);
    if (accessor["componentType"] != 5126 || !accessor.contains("bufferView")) return {};
    const auto& described = gltf_["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
    const std::size_t stride = described.value("byteStride", 4 * width);
    const std::size_t count = accessor["count"].get<std::size_t>();
    const std::string_view data = view(accessor["bufferView"].get<std::size_t>(),
                                       accessor.value("byteOffset", std::size_t{0}));
    if (count == 0 || stride < 4 * width || data.size() < 4 * width ||
        (count - 1) > (data.size() - 4 * width) / stride)
      return {};
    std::vector<float> values(count * width);
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(&values[i * width], data.data() + i * stride, 4 * width);
    return values;
  }

  std::vector<std::size_t> indices(std::size_t which) const {
    const auto& accessor = gltf_["accessors"].at(which);
    const int type = accessor["componentType"].get<int>();
    const std::size_t width = type == 5125 ? 4 : type == 5123 ? 2 : type == 5121 ? 1 : 0;
    const std::size_t count = accessor["count"].get<std::size_t>();
    if (width == 0 || !accessor.contains("bufferView")) return {};
    const std::string_view data = view(accessor["bufferView"].get<std::size_t>(),
                                       accessor.value("byteOffset", std::size_t{0}));
    if (count > data.size() / width) return {};
    std::vector<std::size_t> values(count);
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t n = 0;
      std::memcpy(&n, data.data() + i * width, width);
      values[i] = n;
    }
    return values;
  }

  json gltf_;
  std::string_view bytes_;
};

/// Name of the picture that an OBJ's material refers to; fills surface and corners.
fs::path read_obj_texture(const fs::path& file, const std::string& content, Texture& texture) {
  std::istringstream lines(content);
  std::vector<Eigen::Vector2f> places;
  fs::path materials;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "mtllib") {
      std::getline(words >> std::ws, line);
      materials = file.parent_path() / line.substr(0, line.find_last_not_of(" \r\t") + 1);
    } else if (key == "v") {
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      words >> p.x() >> p.y() >> p.z();
      texture.surface.vertices.push_back(p);
    } else if (key == "vt") {
      Eigen::Vector2f p = Eigen::Vector2f::Zero();
      words >> p.x() >> p.y();
      places.emplace_back(p.x(), 1 - p.y());  // counted from the bottom
    } else if (key == "f") {
      std::vector<std::pair<long, long>> polygon;
      for (std::string corner; words >> corner;) {
        long v = 0, t = 0;
        if (std::sscanf(corner.c_str(), "%ld/%ld", &v, &t) != 2) return {};
        if (v < 0) v += static_cast<long>(texture.surface.vertices.size()) + 1;
        if (t < 0) t += static_cast<long>(places.size()) + 1;
        if (v < 1 || t < 1 || v > static_cast<long>(texture.surface.vertices.size()) ||
            t > static_cast<long>(places.size()))
          return {};
        polygon.emplace_back(v - 1, t - 1);
      }
      for (std::size_t i = 2; i < polygon.size(); ++i) {
        const std::pair<long, long> fan[] = {polygon[0], polygon[i - 1], polygon[i]};
        texture.surface.triangles.emplace_back(static_cast<int>(fan[0].first),
                                               static_cast<int>(fan[1].first),
                                               static_cast<int>(fan[2].first));
        for (const auto& corner : fan)
          texture.corners.push_back(places[static_cast<std::size_t>(corner.second)]);
      }
    }
  }
  std::error_code missing;
  if (materials.empty() || !fs::is_regular_file(materials, missing)) return {};
  std::istringstream mtl(read_file(materials, 1 << 20));
  for (std::string line; std::getline(mtl, line);) {
    std::istringstream words(line);
    std::string key, name;
    words >> key;
    // Options may precede the name, which is last.
    if (key == "map_Kd")
      while (words >> key) name = key;
    if (name.empty()) continue;
    const fs::path picture = materials.parent_path() / name;
    return fs::is_regular_file(picture, missing) ? picture : fs::path();
  }
  return {};
}

/// Bilinear; the picture repeats at its borders.
Eigen::Vector3f color_at(const Texture& texture, const Eigen::Vector2f& place) {
  const auto wrapped = [](int i, int n) { return ((i % n) + n) % n; };
  const float x = (place.x() - std::floor(place.x())) * static_cast<float>(texture.width) - 0.5f;
  const float y = (place.y() - std::floor(place.y())) * static_cast<float>(texture.height) - 0.5f;
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const int j : {0, 1})
    for (const int i : {0, 1}) {
      const std::size_t at = 3 * (std::size_t(wrapped(top + j, texture.height)) * texture.width +
                                  static_cast<std::size_t>(wrapped(left + i, texture.width)));
      const float fraction = (i ? x - static_cast<float>(left) : 1 - x + static_cast<float>(left)) *
                             (j ? y - static_cast<float>(top) : 1 - y + static_cast<float>(top));
      for (int k = 0; k < 3; ++k)
        sum[k] +=
            fraction * static_cast<float>(texture.rgb[at + static_cast<std::size_t>(k)]) / 255;
    }
  return sum.cwiseMax(0).cwiseMin(1);
}

}  // namespace

std::optional<Texture> read_texture(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  Texture texture;
  if (extension == ".glb") {
    const std::string content = read_file(file, max_texture_bytes);
    std::string_view picture;
    try {
      picture = GlbTexture(content).read(texture);
    } catch (const json::exception&) {
      return std::nullopt;  // the surface can be read without it
    }
    if (picture.empty()) return std::nullopt;
    lay_picture(file, picture, texture);
  } else if (extension == ".obj") {
    const fs::path picture = read_obj_texture(file, read_file(file, max_texture_bytes), texture);
    if (picture.empty() || texture.corners.empty()) return std::nullopt;
    lay_picture(picture, read_file(picture, max_texture_bytes), texture);
  } else {
    return std::nullopt;
  }
  for (const auto& corner : texture.corners)
    if (!corner.allFinite()) return std::nullopt;
  return texture;
}

ColourPicture read_colour_picture(const fs::path& file) {
  return decode(file, read_file(file, max_texture_bytes));
}

GreyPicture read_grey_picture(const fs::path& file) {
  const std::string bytes = read_file(file, max_texture_bytes);
  check_picture(file, bytes);
  if (!stbi_is_16_bit_from_memory(data_of(bytes), size_of(bytes)))
    throw InputError(file, "", "has 8 bits a pixel; depths need a PNG of 16 bits");
  GreyPicture picture;
  int channels = 0;
  const std::unique_ptr<stbi_us, void (*)(void*)> pixels(
      stbi_load_16_from_memory(data_of(bytes), size_of(bytes), &picture.width, &picture.height,
                               &channels, 1),
      stbi_image_free);
  if (!pixels) refuse_damaged(file);
  picture.values.assign(pixels.get(),
                        pixels.get() + std::size_t{1} * picture.width * picture.height);
  return picture;
}

void paint(TriMesh& mesh, const Texture& texture, const Eigen::Affine3d& to_mesh) {
  TriMesh moved = texture.surface;
  for (auto& v : moved.vertices) v = to_mesh * v;
  const TriangleTree tree(moved);
  mesh.colors.clear();
  for (const auto& v : mesh.vertices) {
    const SurfacePoint at = tree.nearest(v);
    Eigen::Vector2f place = Eigen::Vector2f::Zero();
    for (int k = 0; at.triangle >= 0 && k < 3; ++k)
      place += static_cast<float>(at.barycentric[k]) *
               texture.corners[static_cast<std::size_t>(3 * at.triangle + k)];
    mesh.colors.push_back(color_at(texture, place));
  }
}

}  // namespace condyle
