// The window's picture at rest is drawn column by column, so that it can be cancelled.
#include "render/window/picture/view_picture.h"

#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using ViewPictures = WithContext;

TEST_F(ViewPictures, ColumnsLeaveNoSeamInWhatIsSeenThrough) {
  const std::vector<Part> parts = {make_part("skull", Role::skull, ball({0, 0, 0}, 30)),
                                   make_part("face", Role::face, ball({0, 0, 0}, 38))};
  SceneRenderer renderer(parts);
  RenderRequest request;
  request.camera = front_camera();
  request.settings.width = 1390;
  request.settings.height = 950;
  request.settings.skin_opacity = 0.4;
  request.quality.samples = 4;
  request.moving = false;
  ViewPicture view;
  const auto nothing = [](bool) {};
  int asked = 0;
  const auto columns = view.draw(renderer, request, nothing, [&] { return ++asked < 0; });
  const auto whole = view.draw(renderer, request, nothing);
  ASSERT_TRUE(columns && whole);
  EXPECT_GT(asked, 0);
  int different = 0;
  for (std::size_t i = 0; i < whole->rgba.size(); ++i)
    different += columns->rgba[i] != whole->rgba[i];
  EXPECT_EQ(different, 0);
  EXPECT_FALSE(view.draw(renderer, request, nothing, [] { return true; }));
}

}  // namespace
}  // namespace condyle
