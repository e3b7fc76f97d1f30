// The flat surface that closes the built-in patient's neck is found, and vanishes in pictures.
#include "render/face/neck_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/render/face/opened_patient.h"
#include "tests/render/scene_fixture.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

TEST(NeckCut, IsTheLowerEndOfAClosedNeck) {
  const OpenedPatient& p = opened_patient();
  const auto& triangles = p.face->mesh.triangles;
  const auto& rim = p.prepared.lining()->rim;
  const auto found = find_neck_cut(p.rest, triangles, rim);
  ASSERT_TRUE(found);
  const auto lower = [](const Vector3f& a, const Vector3f& b) { return a.z() < b.z(); };
  EXPECT_EQ(*found, std::min_element(p.rest.begin(), p.rest.end(), lower)->z());
  EXPECT_FALSE(find_neck_cut(p.rest, triangles, {}));
}

TEST(NeckCut, IsNotFoundInANeckThatIsOpenBelow) {
  const OpenedPatient& p = opened_patient();
  const auto& rim = p.prepared.lining()->rim;
  const float low = *find_neck_cut(p.rest, p.face->mesh.triangles, rim);
  std::vector<Eigen::Vector3i> open = p.face->mesh.triangles;
  std::erase_if(open, [&](const Eigen::Vector3i& t) {
    return p.rest[static_cast<std::size_t>(t[0])].z() < low + 25;
  });
  EXPECT_FALSE(find_neck_cut(p.rest, open, rim));
}

TEST(NeckCut, IsNotFoundNearTheChin) {
  const OpenedPatient& p = opened_patient();
  const auto& rim = p.prepared.lining()->rim;
  float mouth = 1e9f;
  for (const int v : rim) mouth = std::min(mouth, p.rest[static_cast<std::size_t>(v)].z());
  const auto cropped_below = [&](float height) {
    std::vector<Vector3f> cropped = p.rest;
    for (Vector3f& v : cropped) v.z() = std::max(v.z(), height);
    return find_neck_cut(cropped, p.face->mesh.triangles, rim);
  };
  EXPECT_EQ(cropped_below(mouth - 120), mouth - 120);
  EXPECT_FALSE(cropped_below(mouth - 100));
}

using NeckPictures = WithContext;

TEST_F(NeckPictures, ANeckVanishesTowardsItsCut) {
  const Case& patient = opened_patient().scene.patient;
  SceneRenderer renderer(patient.parts);
  PictureSettings settings;
  settings.width = settings.height = 240;
  const Part& face = *patient.find(Role::face);
  const auto by_height = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.z() < b.z();
  };
  Camera below = front_camera();
  below.target = *std::min_element(face.mesh.vertices.begin(), face.mesh.vertices.end(), by_height);
  below.direction = {0, 0, -1};
  below.up = {0, -1, 0};
  const auto picture = [&](double opacity) {
    settings.skin_opacity = opacity;
    return renderer.picture(below, settings);
  };
  SceneRenderer empty(std::span<const Part>{});
  for (const int samples : {1, 4}) {
    SCOPED_TRACE(samples);
    settings.samples = samples;
    const auto expect_alike = [](const Pixel& a, const Pixel& b) {
      EXPECT_NEAR(a.r, b.r, 2);
      EXPECT_NEAR(a.g, b.g, 2);
      EXPECT_NEAR(a.b, b.b, 2);
    };
    expect_alike(pixel(picture(1), 120, 120), pixel(empty.picture(below, settings), 120, 120));
    expect_alike(pixel(picture(0.4), 120, 120), pixel(picture(0), 120, 120));  // bones
  }
  settings.transparent = true;  // nothing to vanish into
  EXPECT_EQ(pixel(picture(1), 120, 120).a, 255);
}

}  // namespace
}  // namespace condyle
