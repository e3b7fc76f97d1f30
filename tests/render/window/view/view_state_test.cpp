#include "render/window/view/view_state.h"

#include <gtest/gtest.h>

namespace condyle {
namespace {

WindowScene scene_of(std::initializer_list<std::pair<const char*, Role>> parts) {
  static std::vector<Part> kept;
  kept.clear();
  for (const auto& [name, role] : parts) kept.push_back({name, role, {}, {}});
  WindowScene scene;
  scene.parts = kept;
  return scene;
}

TEST(ViewStateOpacities, WithTheSkinOffOnlyBonesAndTeethRemain) {
  const WindowScene scene = scene_of({{"face", Role::face},
                                      {"eyes", Role::eyes},
                                      {"tongue", Role::tongue},
                                      {"upper_gums", Role::upper_gums},
                                      {"skull", Role::skull},
                                      {"upper_teeth", Role::upper_teeth}});
  ViewState view;
  view.fit(scene);
  for (const double skin : {1.0, 0.3, 0.0}) {
    view.skin_opacity = skin;
    const auto opacity = part_opacities(scene, view);
    for (const char* soft : {"eyes", "tongue", "upper_gums"})
      EXPECT_EQ(opacity.at(soft), skin > 0 ? 1 : 0) << soft << skin;
    for (const char* hard : {"skull", "upper_teeth"})
      EXPECT_EQ(opacity.at(hard), 1) << hard << skin;
  }
}

TEST(ViewStateOpacities, APatientWithoutAFaceKeepsItsSoftParts) {
  const WindowScene scene = scene_of({{"tongue", Role::tongue}, {"skull", Role::skull}});
  ViewState view;
  view.fit(scene);
  view.skin_opacity = 0;
  EXPECT_EQ(part_opacities(scene, view).at("tongue"), 1);
}

}  // namespace
}  // namespace condyle
