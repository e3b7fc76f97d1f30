// The back of a tongue is rough, and darker along its middle; other mucosa is smooth.
#include <cmath>

#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using TonguePictures = WithContext;

constexpr int side = 200;
constexpr double pixels_per_mm = 8;

Image picture_of(Role role, int samples = 1, const Eigen::Vector3d& direction = {0, -1, 0},
                 bool cut = false) {
  const std::vector<Part> parts = {make_part("mucosa", role, ball({0, 0, 0}, 20))};
  SceneRenderer renderer(parts);
  auto settings = mask_settings(side);
  settings.shadows = false;
  settings.samples = samples;
  if (cut) settings.clip = ClippingPlane{{0, 0, -15}, {0, 0, -1}};
  Camera camera = front_camera(side / pixels_per_mm);
  camera.direction = direction;
  return renderer.picture(camera, settings);
}

TEST_F(TonguePictures, PapillaeMakeItRough) {
  for (const int samples : {1, 4}) {
    const auto [smooth_across, smooth_along] = roughness(picture_of(Role::lower_gums, samples));
    for (const bool cut : {false, true}) {
      const auto [across, along] = roughness(picture_of(Role::tongue, samples, {0, -1, 0}, cut));
      EXPECT_GT(across, 20 * smooth_across) << samples << cut;
      EXPECT_GT(along, 20 * smooth_along) << samples << cut;
    }
  }
}

TEST_F(TonguePictures, ItsSidesAndItsUndersideAreSmooth) {
  for (const Eigen::Vector3d& from : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -0.1, -1)}) {
    const auto [across, along] = roughness(picture_of(Role::tongue, 1, from.normalized()));
    const auto [smooth_across, smooth_along] =
        roughness(picture_of(Role::lower_gums, 1, from.normalized()));
    EXPECT_LT(across, 2 * smooth_across) << from.transpose();
    EXPECT_LT(along, 2 * smooth_along) << from.transpose();
  }
}

TEST_F(TonguePictures, ItsRootIsNotDrawnOutToStreaks) {
  const auto [across, along] =
      roughness(picture_of(Role::tongue, 1, Eigen::Vector3d(0, 1, 1).normalized()));
  EXPECT_LT(across / along, 4);
  EXPECT_GT(across / along, 0.25);
}

TEST_F(TonguePictures, AFurrowRunsAlongItsMiddle) {
  const Image image = picture_of(Role::tongue);
  const auto green = [&](double from_mm, double to_mm) {
    double sum = 0, count = 0;
    for (int y = side / 4; y < 3 * side / 4; ++y)
      for (int x = 0; x < side; ++x)
        if (const double off = std::abs(x - side / 2 + 0.5) / pixels_per_mm;
            off >= from_mm && off < to_mm)
          sum += pixel(image, x, y).g, ++count;
    return sum / count;
  };
  EXPECT_LT(green(0, 0.5), 0.95 * green(2, 5));
}

}  // namespace
}  // namespace condyle
