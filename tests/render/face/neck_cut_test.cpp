// The flat surface that closes the built-in patient's neck is found, and vanishes in pictures.
#include "render/face/neck_cut.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string>
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
  std::vector<Eigen::Vector3i> open = p.face->mesh.triangles;
  const float low = *find_neck_cut(p.rest, open, rim);
  const auto corner = [&](const Eigen::Vector3i& t, int k) -> const Vector3f& {
    return p.rest[static_cast<std::size_t>(t[k])];
  };
  std::erase_if(open, [&](const Eigen::Vector3i& t) {
    const Vector3f n =
        (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).normalized();
    return corner(t, 0).z() < low + 45 && n.z() < -0.8f;
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

/// Pictures of the built-in patient, moved up by so much, from below the end of its neck.
class NeckPicture {
 public:
  explicit NeckPicture(double up_mm) : parts_(opened_patient().scene.patient.parts) {
    double low = 1e9;
    for (Part& part : parts_)
      for (auto& v : part.mesh.vertices) {
        v.z() += up_mm;
        if (part.role == Role::face && v.z() < low) low = v.z(), below_.target = v;
      }
    below_.direction = {0, 0, -1};
    below_.up = {0, -1, 0};
    front_.target = below_.target + Eigen::Vector3d(0, 0, 60);
    settings_.width = settings_.height = 240;
    renderer_.emplace(parts_);
  }
  Image below(double opacity, int samples) { return picture(below_, opacity, samples); }
  Image front(double opacity, int samples) { return picture(front_, opacity, samples); }
  Image background(int samples) {
    settings_.samples = samples;
    return SceneRenderer(std::span<const Part>{}).picture(below_, settings_);
  }
  Image without_background() {
    settings_.transparent = true;
    return below(1, 1);
  }

 private:
  Image picture(const Camera& camera, double opacity, int samples) {
    settings_.skin_opacity = opacity;
    settings_.samples = samples;
    return renderer_->picture(camera, settings_);
  }
  std::vector<Part> parts_;
  Camera below_ = front_camera(), front_ = front_camera(150);
  PictureSettings settings_;
  std::optional<SceneRenderer> renderer_;
};

void expect_alike(const Pixel& a, const Pixel& b) {
  EXPECT_NEAR(a.r, b.r, 2);
  EXPECT_NEAR(a.g, b.g, 2);
  EXPECT_NEAR(a.b, b.b, 2);
}

TEST_F(NeckPictures, VanishTowardsTheCut) {
  NeckPicture neck(0);
  for (const int samples : {1, 4}) {
    SCOPED_TRACE(samples);
    expect_alike(pixel(neck.below(1, samples), 120, 120),
                 pixel(neck.background(samples), 120, 120));
    expect_alike(pixel(neck.below(0.4, samples), 120, 120),  // bones
                 pixel(neck.below(0, samples), 120, 120));
  }
  EXPECT_EQ(pixel(neck.without_background(), 120, 120).a, 255);  // nothing to vanish into
}

TEST_F(NeckPictures, AreTheSameAtAnyHeight) {
  const Image here = NeckPicture(0).front(1, 1);
  for (const double up_mm : {-1000.0, 800.0, 1000.0}) {
    NeckPicture moved(up_mm);
    for (const int samples : {1, 4}) {
      SCOPED_TRACE(std::to_string(up_mm) + ", " + std::to_string(samples));
      EXPECT_TRUE(test::alike(here, moved.front(1, samples), 0.02));
    }
  }
}

TEST_F(NeckPictures, ShowNoInnerSideThroughIt) {
  NeckPicture neck(0);
  EXPECT_TRUE(test::alike(neck.front(0.3, 1), neck.front(0.3, 4), 0.004));
}

}  // namespace
}  // namespace condyle
