// Cheeks of a real opening of the built-in patient sink in, in pictures alone; at rest they are as
// without hollows, bit for bit.
#include "render/face/cheek_hollows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "render/face/drawn_face.h"
#include "render/mesh/vertex_normals.h"
#include "sim/phantom/phantom.h"
#include "sim/simulator/simulator.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

std::vector<Vector3f> floats(const TriMesh& mesh) {
  std::vector<Vector3f> places;
  for (const auto& p : mesh.vertices) places.push_back(p.cast<float>());
  return places;
}

/// The built-in patient at rest and at two openings, with its drawn face.
struct OpenedPatient {
  SimulatorSettings settings = [] {
    SimulatorSettings made;
    made.face = true;
    made.step_s = 1.0 / 60;
    return made;
  }();
  Scene scene = make_scene(builtin_patient({}, {}), settings);
  PreparedParts prepared{scene.patient.parts};
  const Part* face = nullptr;
  std::vector<const Part*> parts = {};
  std::vector<Vector3f> rest = {}, normals = {};
  std::optional<CheekHollows> hollows = {};

  OpenedPatient() {
    for (const Part& part : scene.patient.parts) {
      parts.push_back(&prepared.drawn(part));
      if (part.role == Role::face) face = parts.back();
    }
    rest = floats(face->mesh);
    vertex_normals(rest, face->mesh.triangles, normals);
    hollows.emplace(rest, normals, prepared.lining()->rim, parts);
  }
  FrameState frame(const std::string& words) {
    const Motion motion = make_motion(words + " over 1", scene.patient, scene.contacts);
    Playback playback(scene, motion, settings);
    return playback.at(motion.duration_s);
  }
  std::vector<Vector3f> drawn(const FrameState& frame) const {
    const DrawnFace* smoother = prepared.face_of(*face);
    return smoother ? smoother->places(frame.face) : frame.face;
  }
  /// Corner of the mouth at rest. side: 1 left, -1 right.
  Vector3f corner(float side) const {
    Vector3f best = rest[static_cast<std::size_t>(prepared.lining()->rim.front())];
    for (const int v : prepared.lining()->rim)
      if (const Vector3f& p = rest[static_cast<std::size_t>(v)]; side * p.x() > side * best.x())
        best = p;
    return best;
  }
};

OpenedPatient& opened_patient() {
  static OpenedPatient made;
  return made;
}

/// Largest displacement on a side of the face, mm.
float deepest(const std::vector<Vector3f>& smooth, const std::vector<Vector3f>& sunken,
              float side) {
  float most = 0;
  for (std::size_t v = 0; v < smooth.size(); ++v)
    if (side * opened_patient().rest[v].x() > 0)
      most = std::max(most, (sunken[v] - smooth[v]).norm());
  return most;
}

TEST(CheekHollowsTest, RestStaysBitForBit) {
  auto places = opened_patient().rest;
  EXPECT_TRUE(opened_patient().hollows->apply(places).empty());
  EXPECT_EQ(places, opened_patient().rest);
}

TEST(CheekHollowsTest, AFaceWithoutAMouthOrJawsHasNone) {
  const OpenedPatient& p = opened_patient();
  auto stretched = p.rest;
  for (auto& at : stretched) at.z() *= 1.4f;
  const auto before = stretched;
  const CheekHollows no_rim(p.rest, p.normals, {}, p.parts);
  const CheekHollows no_jaws(p.rest, p.normals, p.prepared.lining()->rim, {});
  EXPECT_TRUE(no_rim.apply(stretched).empty());
  EXPECT_TRUE(no_jaws.apply(stretched).empty());
  EXPECT_EQ(stretched, before);
  EXPECT_FALSE(p.hollows->apply(stretched).empty());
}

TEST(CheekHollowsTest, OpenedCheeksSinkInBesideTheCornersAndDeeperWithTheOpening) {
  float first = 0, before = 0;
  for (const char* words : {"open 15", "open 30", "open 40"}) {
    const auto smooth = opened_patient().drawn(opened_patient().frame(words));
    auto sunken = smooth;
    opened_patient().hollows->apply(sunken);
    const float left = deepest(smooth, sunken, 1), right = deepest(smooth, sunken, -1);
    EXPECT_NEAR(left, right, 0.3f) << words;
    RecordProperty(words, std::to_string(left));
    EXPECT_GE(left, before) << words;
    before = left;
    if (first == 0) first = left;
    for (std::size_t v = 0; v < smooth.size(); ++v) {
      if (sunken[v] == smooth[v]) continue;
      const Vector3f& p = opened_patient().rest[v];
      EXPECT_GT((p - opened_patient().corner(p.x() > 0 ? 1.f : -1.f)).norm(), 4) << p.transpose();
    }
  }
  EXPECT_LT(2 * first, before);
  EXPECT_GT(before, 1.5f);
  EXPECT_LT(before, 5);
}

TEST(CheekHollowsTest, SunkenCheeksStayClearOfJawsAndTeeth) {
  const FrameState frame = opened_patient().frame("open 40");
  const auto smooth = opened_patient().drawn(frame);
  auto sunken = smooth;
  opened_patient().hollows->apply(sunken);
  std::size_t tested = 0;
  double nearest = 1e9;
  for (const Part* part : opened_patient().parts) {
    if (!collides(part->role)) continue;
    const TriangleTree tree(part->mesh);
    const Pose X_BC = pose_of(*part, frame.poses).inverse();
    for (std::size_t v = 0; v < smooth.size(); ++v) {
      if (sunken[v] == smooth[v]) continue;
      ++tested;
      nearest = std::min(nearest, tree.nearest(X_BC * sunken[v].cast<double>()).distance);
      EXPECT_GT(tree.signed_distance(X_BC * sunken[v].cast<double>()), 0);
    }
  }
  EXPECT_GT(tested, 400u);
  EXPECT_GT(nearest, 2);
  RecordProperty("nearest", std::to_string(nearest));
}

}  // namespace
}  // namespace condyle
