#include "render/plan/segment_pictures.h"

#include <algorithm>
#include <array>
#include <map>

#include "render/plan/picture_grid.h"
#include "render/scene/scene_renderer.h"
#include "sim/frame/part_names.h"

namespace condyle {
namespace {

// sRGB: light tints of Okabe and Ito's colours, distinct from bone and from each other.
const std::array<Eigen::Vector3f, 8> segment_tints{{{0.47f, 0.71f, 0.87f},
                                                    {0.93f, 0.72f, 0.36f},
                                                    {0.45f, 0.76f, 0.62f},
                                                    {0.86f, 0.61f, 0.75f},
                                                    {0.88f, 0.84f, 0.45f},
                                                    {0.88f, 0.55f, 0.38f},
                                                    {0.62f, 0.62f, 0.84f},
                                                    {0.66f, 0.78f, 0.42f}}};
const Eigen::Vector3f spongy_bone{0.70f, 0.36f, 0.28f};
const Eigen::Vector3f resected_tint{0.80f, 0.45f, 0.42f};

/// The bone in one colour and its cut faces in that of spongy bone, with sharp borders.
TriMesh tinted(const TriMesh& mesh, const SurfaceOrigin* origin, const Eigen::Vector3f& tint) {
  TriMesh result{mesh.vertices, mesh.triangles,
                 std::vector<Eigen::Vector3f>(mesh.vertices.size(), tint)};
  if (!origin) return result;
  std::map<int, int> on_cut_face;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (origin->made_by[t] == 0) continue;
    for (int& v : result.triangles[t]) {
      const auto [found, is_new] = on_cut_face.emplace(v, static_cast<int>(result.vertices.size()));
      if (is_new) {
        result.vertices.push_back(mesh.vertices[v]);
        result.colors.push_back(spongy_bone);
      }
      v = found->second;
    }
  }
  return result;
}

struct TintedBones {
  std::vector<Part> parts;
  std::vector<ColourKey> keys;
};

bool is_graft(const Operated& operated, const Part& part) {
  return part.role == Role::transplant && operated.origin.contains(part.name);
}

/// Before the operation the resected bone is there, afterwards the grafts are.
TintedBones tinted_bones(const Operated& operated, bool after) {
  TintedBones bones;
  if (!after)
    for (const Resection& resection : operated.resections)
      for (Part part : resection.parts) {
        if (!collides(part.role)) continue;
        part.body = cranium_body;  // at rest, like all others
        if (!is_teeth(part.role)) {
          part.mesh = tinted(part.mesh, nullptr, resected_tint);
          bones.keys.push_back({resected_tint, readable_name(resection.segment) + ", resected"});
        }
        bones.parts.push_back(std::move(part));
      }
  std::map<BodyId, Eigen::Vector3f> tints;
  for (const Part& part : operated.patient.parts) {
    if (!collides(part.role) || (!after && is_graft(operated, part))) continue;
    bones.parts.push_back(part);
    const auto origin = operated.origin.find(part.name);
    if (origin == operated.origin.end()) continue;
    Eigen::Vector3f tint(0.90f, 0.85f, 0.75f);
    if (part.role == Role::segment || is_graft(operated, part)) {
      const auto [found, is_new] =
          tints.emplace(part.body, segment_tints[tints.size() % segment_tints.size()]);
      tint = found->second;
      if (is_new)
        bones.keys.push_back({tint, readable_name(operated.patient.bodies[part.body].name)});
    }
    bones.parts.back().mesh = tinted(part.mesh, &origin->second, tint);
  }
  return bones;
}

}  // namespace

Image segment_sheet(const Operated& operated, const SegmentPictureSettings& settings) {
  const TintedBones before_bones = tinted_bones(operated, false),
                    after_bones = tinted_bones(operated, true);
  PictureSettings picture;
  picture.width = 560;
  picture.height = 600;
  picture.backdrop = Backdrop::light;
  picture.contacts = false;
  std::vector<ColourKey> keys = after_bones.keys;
  for (const ColourKey& key : before_bones.keys)
    if (std::none_of(keys.begin(), keys.end(),
                     [&](const ColourKey& known) { return known.text == key.text; }))
      keys.push_back(key);
  PictureGrid grid{settings.title, {{}, {}}, std::move(keys), settings.lines};
  for (const bool after : {false, true}) {
    SceneRenderer renderer((after ? after_bones : before_bones).parts);
    const auto [low, high] = renderer.bounds();
    FrameState frame;
    frame.poses = after ? operated.poses : completed(operated.patient.bodies, {});
    renderer.update(frame);
    for (const std::string& view : settings.views) {
      const Camera camera =
          standard_camera(view, low, high, static_cast<double>(picture.width) / picture.height);
      grid.rows[after].push_back({renderer.picture(camera, picture),
                                  std::string(after ? "after" : "before") + ", " + view});
    }
  }
  return draw_grid(grid);
}

}  // namespace condyle
