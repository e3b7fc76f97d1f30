// The back of a tongue is rough, and darker along its middle; other mucosa is smooth.
#include <cmath>

#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using TonguePictures = WithContext;

constexpr int side = 200;

Image picture_of(Role role, double samples_per_mm, int samples = 1) {
  const std::vector<Part> parts = {make_part("mucosa", role, ball({0, 0, 0}, 20))};
  SceneRenderer renderer(parts);
  auto settings = mask_settings(side);
  settings.shadows = false;
  settings.samples = samples;
  return renderer.picture(front_camera(side / samples_per_mm), settings);
}

TEST_F(TonguePictures, PapillaeMakeItRough) {
  for (const int samples : {1, 4}) {
    const auto [across, along] = roughness(picture_of(Role::tongue, 8, samples));
    const auto [smooth_across, smooth_along] = roughness(picture_of(Role::lower_gums, 8, samples));
    EXPECT_GT(across, 20 * smooth_across) << samples;
    EXPECT_GT(along, 20 * smooth_along) << samples;
  }
}

TEST_F(TonguePictures, AFurrowRunsAlongItsMiddle) {
  const Image image = picture_of(Role::tongue, 8);
  const auto green = [&](double from_mm, double to_mm) {
    double sum = 0, count = 0;
    for (int y = side / 4; y < 3 * side / 4; ++y)
      for (int x = 0; x < side; ++x)
        if (const double off = std::abs(x - side / 2 + 0.5) / 8; off >= from_mm && off < to_mm)
          sum += pixel(image, x, y).g, ++count;
    return sum / count;
  };
  EXPECT_LT(green(0, 0.5), 0.95 * green(2, 5));
}

}  // namespace
}  // namespace condyle
