// The relief of the lips' red is furrows from lip to lip; that of the skin beside them is not. The
// tongue of a lining has papillae.
#include <algorithm>
#include <cmath>

#include "render/scene/mouth_cavity.h"
#include "tests/render/face/opened_patient.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using LipPictures = WithContext;
using MouthPictures = WithContext;

/// The built-in patient, its lips seen from close by.
struct LipFace {
  const OpenedPatient& p = opened_patient();
  SceneRenderer renderer{p.scene.patient.parts};

  /// Roughness across the face over that along it, so high above the lower end of the rim.
  double ratio(double above_mm) {
    double low = 1e9, front = 1e9;
    for (const int v : p.prepared.lining()->rim)
      low = std::min<double>(low, p.rest[static_cast<std::size_t>(v)].z());
    for (const auto& v : p.rest)
      if (std::abs(v.x()) < 5 && std::abs(v.z() - low - above_mm) < 1)
        front = std::min<double>(front, v.y());
    Camera camera = front_camera(10);
    camera.target = {0, front, low + above_mm};
    auto settings = mask_settings(100);
    settings.shadows = false;
    const auto [across, along] = roughness(renderer.picture(camera, settings));
    EXPECT_GT(along, 100);
    return across / along;
  }
};

TEST_F(LipPictures, FurrowsOfTheRedRunFromLipToLip) {
  LipFace face;
  const double lip = face.ratio(-1), chin = face.ratio(-16);
  RecordProperty("lip", std::to_string(lip));
  RecordProperty("chin", std::to_string(chin));
  EXPECT_GT(lip, 3);
  EXPECT_LT(chin, 1.5);
  EXPECT_GT(chin, 0.5);
}

// Skin like glass lacks furrows and shadows, which would appear at once.
TEST_F(LipPictures, ReliefAndShadowsComeGraduallyAsTheSkinGetsOpaque) {
  LipFace face;
  Camera camera = front_camera(60);
  camera.target = {0, -105, -50};
  const auto at = [&](double opacity) {
    auto settings = mask_settings(160);
    settings.skin_opacity = opacity;
    return face.renderer.picture(camera, settings);
  };
  const auto largest = [](const Image& a, const Image& b) {
    int most = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i)
      most = std::max(most, std::abs(a.rgba[i] - b.rgba[i]));
    return most;
  };
  const int step = largest(at(0.4999), at(0.5001)), whole = largest(at(0.4999), at(0.75));
  RecordProperty("step", step);
  EXPECT_LE(step, 2);
  EXPECT_GT(whole, 20);
}

TEST_F(MouthPictures, ATongueOfTheMouthsLiningHasPapillaeThatCoarsePicturesLack) {
  const OpenedPatient& p = opened_patient();
  auto parts = p.scene.patient.parts;
  std::erase_if(parts, [](const Part& part) { return part.role == Role::tongue; });
  SceneRenderer renderer(parts);
  renderer.update(opened_patient().frame("open 40"));
  Camera camera = front_camera(16);
  camera.direction = Eigen::Vector3d(0, -1, 0.4).normalized();
  camera.target = {0, -60, -82};
  auto settings = mask_settings(160);
  settings.shadows = false;
  const auto rough = roughness(renderer.picture(camera, settings));
  settings.coarse = true;
  const auto smooth = roughness(renderer.picture(camera, settings));
  EXPECT_GT(rough.first, 5 * smooth.first);
  EXPECT_GT(rough.second, 5 * smooth.second);
}

TEST_F(MouthPictures, OnlyALiningWithATongueIsRough) {
  for (const bool with_tongue : {false, true}) {
    std::vector<const Part*> parts;
    for (const Part* part : opened_patient().parts)
      if (with_tongue || part->role != Role::tongue) parts.push_back(part);
    std::vector<Part> own;
    for (const Part* part : parts) own.push_back(*part);
    const auto lining = line_mouth(own);
    ASSERT_TRUE(lining);
    const auto drawables = make_drawables(parts, &*lining);
    const auto face = std::find_if(drawables.begin(), drawables.end(),
                                   [](const Drawable& d) { return d.part->role == Role::face; });
    MouthCavity cavity(*lining, *face);
    const Drawable& made = cavity.place(face->mesh, {});
    EXPECT_EQ(made.papillae, !with_tongue);
    int dull = 0, wet = 0;
    for (const auto& extra : made.extras) dull += extra[1] > 200, wet += extra[1] < 50;
    EXPECT_EQ(dull > 0, !with_tongue);
    EXPECT_GT(wet, 50);
  }
}

}  // namespace
}  // namespace condyle
