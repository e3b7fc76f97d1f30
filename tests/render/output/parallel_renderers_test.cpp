#include "render/output/parallel_renderers.h"

#include <epoxy/egl.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "engine/core/error.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

std::vector<Part> mandible_and_face() {
  return {make_part("mandible", Role::mandible, ball({0, -20, 0}, 20)),
          make_part("face", Role::face, ball({0, 0, 30}, 30))};
}

FrameState moved_by(int i) {
  FrameState frame;
  frame.poses[mandible_body].t = {0.7 * i, 0, -1.3 * i};
  for (const auto& v : ball({0, 0, 30}, 30).vertices)
    frame.face.push_back((v + Eigen::Vector3d(0, 0, v.z() < 20 ? -0.5 * i : 0)).cast<float>());
  return frame;
}

PictureSettings small_settings(int samples) {
  PictureSettings settings;
  settings.width = 320;
  settings.height = 240;
  settings.samples = samples;
  return settings;
}

std::vector<Image> drawn(ParallelRenderers& drawers, int pictures, int samples) {
  std::vector<Image> images;
  for (int i = 0; i < pictures; ++i)
    drawers.add([&images, i, samples](SceneRenderer& renderer, int) {
      renderer.update(moved_by(i));
      const Image image = renderer.picture(front_camera(), small_settings(samples));
      return [&images, image] { images.push_back(image); };
    });
  drawers.finish();
  return images;
}

TEST(ParallelRenderers, DeliverThePicturesOfOneRendererInOrder) {
  const auto parts = mandible_and_face();
  constexpr int pictures = 7;
  for (const int samples : {1, 4}) {
    std::vector<Image> expected, found;
    {
      ParallelRenderers one(parts, 1);
      EXPECT_EQ(one.count(), 1);
      expected = drawn(one, pictures, samples);
    }
    {
      ParallelRenderers two(parts, 2);
      const bool card = two.driver().find("llvmpipe") == std::string::npos;
      EXPECT_EQ(two.count(), card || std::thread::hardware_concurrency() < 2 ? 1 : 2);
      found = drawn(two, pictures, samples);
    }
    ASSERT_EQ(expected.size(), pictures);
    ASSERT_EQ(found.size(), pictures);
    for (int i = 0; i < pictures; ++i)
      EXPECT_TRUE(test::same_bytes(found[i], expected[i])) << i << ", " << samples << " samples";
    EXPECT_TRUE(test::unlike(expected[0], expected[1], 0));
  }
}

TEST(ParallelRenderers, DrawOnDisplaysThatNoOtherContextUses) {
  const auto parts = mandible_and_face();
  ParallelRenderers two(parts, 2), later(parts, 2);
  if (two.driver().find("llvmpipe") == std::string::npos) return;  // a card draws one at a time
  EXPECT_EQ(later.count(), 1) << "both displays are in use";
  EGLDisplay displays[2] = {EGL_NO_DISPLAY, EGL_NO_DISPLAY};
  std::atomic<int> drawing = 0;
  for (int i = 0; i < two.count(); ++i)
    two.add([&](SceneRenderer&, int drawer) {
      displays[drawer] = eglGetCurrentDisplay();
      // Both threads draw at this moment.
      for (++drawing; drawing < two.count();) std::this_thread::yield();
      return [] {};
    });
  two.finish();
  EXPECT_NE(displays[0], EGL_NO_DISPLAY);
  EXPECT_NE(displays[0], displays[1]);
}

TEST(ParallelRenderers, SlowAndQuickPicturesAreDeliveredInTheirOrder) {
  const auto parts = mandible_and_face();
  ParallelRenderers drawers(parts);
  std::vector<int> order;
  for (int i = 0; i < 6; ++i)
    drawers.add([&order, i](SceneRenderer&, int) {
      std::this_thread::sleep_for(std::chrono::milliseconds(i % 2 == 0 ? 40 : 0));
      return [&order, i] { order.push_back(i); };
    });
  drawers.finish();
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4, 5}));
}

TEST(ParallelRenderers, DeliverPicturesBeforeAFailedOne) {
  const auto parts = mandible_and_face();
  ParallelRenderers drawers(parts);
  std::vector<int> order;
  const auto give = [&] {
    for (int i = 0; i < 8; ++i)
      drawers.add([&order, i](SceneRenderer&, int) -> ParallelRenderers::Deliver {
        // The one before is slower.
        if (i == 3) throw MachineError("the disk is full");
        std::this_thread::sleep_for(std::chrono::milliseconds(i == 2 ? 200 : 0));
        return [&order, i] { order.push_back(i); };
      });
    drawers.finish();
  };
  EXPECT_THROW(give(), MachineError);
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2}));
}

TEST(ParallelRenderers, EndOnlyWhenAllIsDelivered) {
  const auto parts = mandible_and_face();
  std::vector<int> order;
  {
    ParallelRenderers drawers(parts);
    for (int i = 0; i < 4; ++i)
      drawers.add([&order, i](SceneRenderer&, int) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        return [&order, i] { order.push_back(i); };
      });
  }
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3}));
}

TEST(ParallelRenderers, RethrowTheErrorOfAPicture) {
  const auto parts = mandible_and_face();
  for (const bool late : {false, true}) {
    ParallelRenderers drawers(parts);
    const auto give = [&] {
      for (int i = 0; i < 10; ++i)
        drawers.add([i, late](SceneRenderer&, int) -> ParallelRenderers::Deliver {
          if (i == 3 && !late) throw MachineError("the disk is full");
          return [i, late] {
            if (i == 3 && late) throw MachineError("the disk is full");
          };
        });
      drawers.finish();
    };
    EXPECT_THROW(give(), MachineError) << late;
  }
}

}  // namespace
}  // namespace condyle
