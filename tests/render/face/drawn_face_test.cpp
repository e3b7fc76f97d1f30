// Openings that a segmentation leaves in a face are not seen through, and a coarse face is smooth.
#include "render/face/drawn_face.h"

#include <Eigen/Geometry>
#include <filesystem>

#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "engine/mesh_io/mesh_files.h"
#include "render/image/colour_map.h"
#include "sim/frame/face_openings.h"
#include "tests/render/scene_fixture.h"
#include "tests/support/places.h"

namespace condyle {
namespace {

using DrawnFacePicture = WithContext;

const Eigen::Vector3d eye_at = {32, 0, 35}, nostril_at = {8, 0, -8}, lips_at = {0, 0, -19};

/// A head: a ball with a nose, and holes for an eye and a nostril on each side, with rims displaced
/// by `off`.
TriMesh head_with_openings(const Eigen::Vector3d& off = {0, 0, 0}, int rings = 100) {
  TriMesh face = ball({0, 0, 20}, 75, rings);
  // The nose: what is near the middle is drawn forward, more so above, where it ends below.
  for (auto& p : face.vertices)
    if (p.y() < 0) {
      const double side = std::exp(-std::pow(p.x() / 14, 2));
      const double height =
          p.z() > 0 ? std::exp(-std::pow(p.z() / 25, 2)) : std::exp(-std::pow(p.z() / 9, 2));
      p.y() -= 22 * side * height;
    }
  std::erase_if(face.triangles, [&](const Eigen::Vector3i& t) {
    const Eigen::Vector3d p =
        (face.vertices[t[0]] + face.vertices[t[1]] + face.vertices[t[2]]) / 3 - off;
    const auto within = [&](const Eigen::Vector3d& middle, double wide, double high) {
      return std::hypot((std::abs(p.x()) - middle.x()) / wide, (p.z() - middle.z()) / high) < 1;
    };
    return p.y() < 0 && (within(eye_at, 15, 9) || within(nostril_at, 5, 4));
  });
  return face;
}

int count(const std::vector<FaceOpening>& openings, FaceOpening::Kind kind) {
  return static_cast<int>(
      std::count_if(openings.begin(), openings.end(),
                    [&](const FaceOpening& opening) { return opening.kind == kind; }));
}

TEST(FaceOpenings, AreRecognizedByPositionAndShape) {
  const auto openings = find_openings(head_with_openings());
  EXPECT_EQ(openings.size(), 4u);
  EXPECT_EQ(count(openings, FaceOpening::Kind::eye), 2);
  EXPECT_EQ(count(openings, FaceOpening::Kind::nostril), 2);
  for (const auto& opening : openings) {
    EXPECT_NEAR(opening.outward.norm(), 1, 1e-9);
    EXPECT_LT(opening.outward.y(), 0);
  }
  // Holes in the forehead or the cheeks are not closed.
  for (const double up : {45.0, -70.0})
    EXPECT_TRUE(find_openings(head_with_openings({0, 0, up})).empty()) << up;
}

TEST(FaceOpenings, OfANoseAreNotAChildsMouth) {
  TriMesh face = head_with_openings();
  std::erase_if(face.triangles, [&](const Eigen::Vector3i& t) {
    const Eigen::Vector3d p =
        (face.vertices[t[0]] + face.vertices[t[1]] + face.vertices[t[2]]) / 3 - lips_at;
    return p.y() < 0 && std::hypot(p.x() / 14, p.z() / 1.5) < 1;
  });
  ASSERT_EQ(inspect(face).boundary.size(), 5u);
  const auto openings = find_openings(face);
  EXPECT_EQ(openings.size(), 4u);
  for (const auto& opening : openings)
    EXPECT_GT((opening.middle - lips_at).cwiseProduct(Eigen::Vector3d(1, 0, 1)).norm(), 10);
}

TEST(FaceOpenings, AreFoundWithAnyObjectInFrontOfTheNose) {
  const auto found = [](const TriMesh& face) { return find_openings(face).size(); };
  TriMesh chin = head_with_openings();
  for (auto& p : chin.vertices)
    if (p.y() < 0)
      p.y() -= 70 * std::exp(-std::pow(p.x() / 20, 2) - std::pow((p.z() + 50) / 10, 2));
  EXPECT_EQ(found(chin), 4u);
  // One vertex of noise, also one that is of no triangle.
  TriMesh noise = head_with_openings();
  const auto near = std::min_element(
      noise.vertices.begin(), noise.vertices.end(), [](const auto& a, const auto& b) {
        return (a - Eigen::Vector3d(20, -70, 0)).norm() < (b - Eigen::Vector3d(20, -70, 0)).norm();
      });
  near->y() -= 90;
  EXPECT_EQ(found(noise), 4u);
  TriMesh stray = head_with_openings();
  stray.vertices.emplace_back(60, -300, 90);
  EXPECT_EQ(found(stray), 4u);
}

TEST(DrawnFace, ClosesEyesAndNostrilsAndFollowsTheirRims) {
  const TriMesh face = head_with_openings();
  ASSERT_EQ(inspect(face).boundary.size(), 4u);
  const DrawnFace drawn(face, {}, {.8f, .6f, .5f});
  ASSERT_TRUE(drawn.changed());
  EXPECT_TRUE(inspect(drawn.mesh()).closed());
  ASSERT_EQ(drawn.mesh().colors.size(), drawn.mesh().vertices.size());
  const auto open = [&](const std::vector<Eigen::Vector3d>& eyes) {
    return inspect(DrawnFace(face, eyes, {.8f, .6f, .5f}).mesh()).boundary.size();
  };
  // On a head of radius 75 about (0, 0, 20).
  const Eigen::Vector3d left(32, -60, 35), right(-32, -60, 35);
  EXPECT_EQ(open({left, right}), 2u);
  EXPECT_EQ(open({left}), 1u);
  EXPECT_EQ(open({{0, 80, 35}}), 0u);

  std::vector<Eigen::Vector3f> there;
  const Eigen::Vector3f shift(1, -2, 3);
  for (const auto& v : face.vertices) there.push_back(v.cast<float>() + shift);
  const auto moved = drawn.places(there);
  ASSERT_EQ(moved.size(), drawn.mesh().vertices.size());
  for (std::size_t v = 0; v < moved.size(); ++v)
    EXPECT_NEAR((moved[v] - drawn.mesh().vertices[v].cast<float>() - shift).norm(), 0, 1e-3f) << v;
  for (const float value : drawn.values(std::vector<float>(face.vertices.size(), 7.f)))
    EXPECT_NEAR(value, 7, 1e-3f);
}

TEST(DrawnFace, ClosesFineRimsByFewVertices) {
  const TriMesh face = head_with_openings({0, 0, 0}, 400);
  for (const auto& opening : find_openings(face)) ASSERT_GT(opening.rim.size(), 64u);
  const DrawnFace drawn(face, {}, {.8f, .6f, .5f});
  EXPECT_TRUE(inspect(drawn.mesh()).closed());
  EXPECT_LE(drawn.mesh().vertices.size() - face.vertices.size(), 4u * (5 * 64 + 1));
}

TEST(DrawnFace, IsTheFaceItselfWhereThatIsFineAndWhole) {
  const TriMesh fine = ball({0, 0, 0}, 60, 120);
  EXPECT_FALSE(DrawnFace(fine, {}, {1, 1, 1}).changed());
  const std::vector<Part> parts = {make_part("face", Role::face, fine)};
  const PreparedParts prepared(parts);
  EXPECT_EQ(&prepared.drawn(parts[0]), &parts[0]);
  EXPECT_EQ(prepared.face_of(parts[0]), nullptr);
}

TEST(DrawnFace, OfACoarseOneIsSmoothAndNearIt) {
  const TriMesh coarse = ball({0, 0, 0}, 60, 24);
  const DrawnFace drawn(coarse, {}, {1, 1, 1});
  ASSERT_GT(drawn.mesh().triangles.size(), 10 * coarse.triangles.size());
  EXPECT_TRUE(inspect(drawn.mesh()).closed());
  EXPECT_TRUE(drawn.mesh().colors.empty());
  for (const auto& p : drawn.mesh().vertices) EXPECT_NEAR(p.norm(), 59.7, 0.3);
}

TEST(DrawnFace, LidsMeetInADarkLineFromCornerToCorner) {
  const TriMesh face = head_with_openings();
  const Eigen::Vector3f skin(.8f, .6f, .5f);
  const TriMesh drawn = DrawnFace(face, {}, skin).mesh();
  const auto eyes = find_openings(face);
  for (const double from_middle : {-0.5, 0.0, 0.5})
    for (const auto& eye : eyes) {
      if (eye.kind != FaceOpening::Kind::eye) continue;
      // Down across the eye: skin, the line below its middle, skin.
      double darkest = 1, at = 0, above = 0, below = 0;
      for (std::size_t v = 0; v < drawn.vertices.size(); ++v) {
        const Eigen::Vector3d p = drawn.vertices[v] - eye.middle;
        if (p.y() > 20 || std::abs(p.x() - from_middle * eye_at.x() * 0.45) > 2 ||
            std::abs(p.z()) > 15)
          continue;
        const double light = drawn.colors[v].x() / skin.x();
        if (light < darkest) darkest = light, at = p.z();
        if (p.z() > 2) above = std::max(above, light);
        if (p.z() < -8) below = std::max(below, light);
      }
      EXPECT_LT(darkest, 0.65) << from_middle;
      EXPECT_LT(at, -0.5);
      EXPECT_GT(at, -8);
      EXPECT_NEAR(above, 1, 0.02);
      EXPECT_NEAR(below, 1, 0.02);
    }
}

TEST(DrawnFace, HasBrowsOverBothEyesThatItClosesUnlessItsColoursAreKnown) {
  std::vector<Part> parts = {make_part("face", Role::face, head_with_openings())};
  // Darkest pixel in a range above an eye's centre.
  const auto light = [&](double side, double up) {
    const PreparedParts prepared(parts);
    const TriMesh& face = prepared.drawn(parts[0]).mesh;
    float darkest = 1;
    for (std::size_t v = 0; v < face.vertices.size(); ++v) {
      const auto& p = face.vertices[v];
      if (p.y() < 0 && std::abs(p.x() - side * eye_at.x()) < 4 &&
          std::abs(p.z() - eye_at.z() - up) < 2)
        darkest = std::min(darkest, face.colors[v].x());
    }
    return darkest;
  };
  for (const double side : {-1, 1}) {
    EXPECT_LT(light(side, 19), 0.6f);
    EXPECT_GT(light(side, 28), 0.75f);
    EXPECT_GT(light(side, 11), 0.75f);
  }
  parts[0].mesh.colors.assign(parts[0].mesh.vertices.size(), {.8f, .6f, .5f});
  for (const double side : {-1, 1}) EXPECT_NEAR(light(side, 19), 0.8f, 0.01f);
}

TEST(DrawnFace, OfARealHeadHasNoHolesAndLiesNearIt) {
  const auto file =
      test::source_folder() / ".." / "shared" / "data" / "case-badin" / "face_skin.ply";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "real anatomy absent";
  const TriMesh face = read_mesh(file);
  EXPECT_EQ(find_openings(face).size(), 4u);
  const DrawnFace drawn(face, {}, {.8f, .6f, .5f});
  // The mouth and the outer edge stay.
  EXPECT_EQ(inspect(face).boundary.size(), 6u);
  EXPECT_EQ(inspect(drawn.mesh()).boundary.size(), 2u);
  const TriangleTree tree(drawn.mesh());
  std::vector<double> off;
  for (const auto& v : face.vertices) off.push_back((tree.nearest(v).point - v).norm());
  std::sort(off.begin(), off.end());
  // Far apart only where the measured surface itself has corners: at the edges of the mask.
  EXPECT_LT(off[off.size() / 2], 0.2);
  EXPECT_LT(off[off.size() * 9 / 10], 0.5);
  EXPECT_LT(off.back(), 2.7);
}

TEST_F(DrawnFacePicture, IsNotSeenThroughAtEyesAndNostrils) {
  const std::vector<Part> parts = {make_part("face", Role::face, head_with_openings())};
  SceneRenderer renderer(parts);
  FrameState frame;
  for (const auto& v : parts[0].mesh.vertices) frame.face.push_back(v.cast<float>());
  const auto settings = mask_settings(300);
  for (const bool moved : {false, true}) {
    if (moved) renderer.update(frame);
    const Image image = renderer.picture(front_camera(150), settings);
    for (const double side : {-1.0, 1.0}) {
      const Pixel lid = pixel(image, static_cast<int>(150 + 2 * side * eye_at.x()),
                              static_cast<int>(150 - 2 * eye_at.z()));
      const Pixel cheek = pixel(image, static_cast<int>(150 + 2 * side * eye_at.x()), 160);
      EXPECT_EQ(lid.a, 255);
      // Skin in the light.
      EXPECT_GT(lid.r, 0.6 * cheek.r);
      EXPECT_LT(lid.r, 1.4 * cheek.r);
    }
  }
  // A nostril is dark; nothing is behind it either.
  const Image image = renderer.picture(front_camera(150), settings);
  for (const double side : {-1.0, 1.0}) {
    const Pixel hole = pixel(image, static_cast<int>(150 + 2 * side * nostril_at.x()),
                             static_cast<int>(150 - 2 * nostril_at.z()));
    EXPECT_EQ(hole.a, 255);
    EXPECT_LT(hole.r, 90);
  }
}

TEST_F(DrawnFacePicture, OneUnknownValueIsOneBeyondTheMap) {
  const std::vector<Part> parts = {make_part("face", Role::face, ball({0, 0, 0}, 40, 16))};
  SceneRenderer renderer(parts);
  const ColourMap map = distance_colours({.near_mm = 5, .deepest_mm = 2});
  renderer.set_colour_map(map);
  std::vector<float> values(parts[0].mesh.vertices.size(), 1.f);
  const auto front = std::min_element(parts[0].mesh.vertices.begin(), parts[0].mesh.vertices.end(),
                                      [](const auto& a, const auto& b) { return a.y() < b.y(); });
  const auto picture = [&](float value) {
    values[static_cast<std::size_t>(front - parts[0].mesh.vertices.begin())] = value;
    renderer.color_part("face", values);
    return renderer.picture(front_camera(), mask_settings()).rgba;
  };
  const auto beyond = picture(static_cast<float>(map.high()) + 2);
  EXPECT_NE(beyond, picture(1));
  EXPECT_EQ(beyond, picture(std::nanf("")));
  EXPECT_EQ(beyond, picture(1e30f));
}

TEST_F(DrawnFacePicture, OfTwoFacesEachHasItsOwnValues) {
  const TriMesh other = ball({0, -60, -90}, 20, 8);
  const std::vector<Part> parts = {make_part("face", Role::face, head_with_openings()),
                                   make_part("other", Role::face, other)};
  const PreparedParts prepared(parts);
  EXPECT_NE(prepared.face_of(prepared.drawn(parts[0])), nullptr);
  EXPECT_EQ(prepared.face_of(prepared.drawn(parts[1])), nullptr);
  SceneRenderer renderer(parts);
  renderer.set_colour_map(distance_colours({.near_mm = 5, .deepest_mm = 2}));
  const auto picture = [&] { return renderer.picture(front_camera(250), mask_settings()).rgba; };
  const auto plain = picture();
  renderer.color_part("other", std::vector<float>(other.vertices.size(), 1.f));
  EXPECT_NE(picture(), plain);
  renderer.color_part("other", {});
  EXPECT_EQ(picture(), plain);
}

}  // namespace
}  // namespace condyle
