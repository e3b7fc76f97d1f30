// Bellies of the built-in patient's muscles.
#include "render/recording/muscle_bellies.h"

#include <gtest/gtest.h>

#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"
#include "render/recording/muscle_looks.h"
#include "sim/muscles/default_muscles.h"
#include "sim/phantom/phantom.h"

namespace condyle {
namespace {

TriMesh mesh_of(const FibreBody& body) {
  TriMesh mesh;
  for (const auto& p : body.positions) mesh.vertices.push_back(p.cast<double>());
  mesh.triangles = body.triangles;
  return mesh;
}

class Bellies : public testing::Test {
 protected:
  static const Case& patient() {
    static const Case built = builtin_patient();
    return built;
  }
  static const MuscleBellies& bellies() {
    static const MuscleBellies made(muscles_of(patient()), patient());
    return made;
  }
  static std::size_t index(const std::string& name) {
    const auto& all = bellies().muscles();
    std::size_t i = 0;
    while (i < all.size() && all[i].name != name) ++i;
    return i;
  }
  static FrameState rest() {
    FrameState frame;
    frame.poses = BodyPoses(std::vector<Pose>(2));
    return frame;
  }
};

TEST_F(Bellies, ReachFromOriginToInsertionWithTheVolumeOfTheirStrength) {
  ASSERT_EQ(bellies().muscles().size(), 34u);
  for (std::size_t m = 0; m < 34; ++m) {
    const Muscle& muscle = bellies().muscles()[m];
    const TriMesh mesh = mesh_of(bellies().body(m, {}, rest()));
    const TriangleTree tree(mesh);
    EXPECT_LT(tree.nearest(muscle.origin).distance, 0.01) << muscle.name;
    EXPECT_LT(tree.nearest(muscle.insertion).distance, 0.01) << muscle.name;
    const double length = (muscle.insertion - muscle.origin).norm();
    const double full = belly_area_mm2(muscle.max_force_N) * length;
    const double volume = signed_volume(mesh);  // positive: its triangles face outwards
    EXPECT_GT(volume, 0.45 * full) << muscle.name;
    EXPECT_LT(volume, full) << muscle.name;
  }
}

TEST_F(Bellies, KeepTheirVolumeAsTheJawOpens) {
  FrameState open = rest();
  std::vector<Pose> poses(2);
  poses[1].R = Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitX());
  open.poses = BodyPoses(poses);
  for (const char* name : {"lsm", "rat", "lmp", "rad"}) {
    const std::size_t m = index(name);
    ASSERT_LT(m, 34u) << name;
    const double before = signed_volume(mesh_of(bellies().body(m, {}, rest()))),
                 after = signed_volume(mesh_of(bellies().body(m, {}, open)));
    EXPECT_NEAR(after, before, 0.12 * before) << name;
  }
}

TEST_F(Bellies, OfTheMasseterCoverTheRamus) {
  for (const char* name : {"lsm", "rsm", "ldm", "rdm"}) {
    const std::size_t m = index(name);
    ASSERT_LT(m, 34u) << name;
    const PlaceLabel label = bellies().label(m, bellies().body(m, {}, rest()));
    const Eigen::Vector3d middle = label.place.cast<double>();
    for (const Part& part : patient().parts)
      if (part.role == Role::mandible || part.role == Role::skull) {
        EXPECT_GT(TriangleTree(part.mesh).signed_distance(middle), 1) << name << " " << part.name;
      }
    EXPECT_EQ(label.words.front(), name[0] == 'l' ? 'L' : 'R');
  }
}

TEST_F(Bellies, AreBrighterWhenExcitedAndHiddenOnesAreLeftOut) {
  FrameState frame = rest();
  Motion motion;
  for (const Muscle& muscle : bellies().muscles()) motion.muscle_names.push_back(muscle.name);
  frame.muscles.resize(motion.muscle_names.size());
  const std::size_t m = index("lsm"), ring = bellies().body(m, motion, frame).colors.size() / 2;
  const float idle = bellies().body(m, motion, frame).colors[ring].sum();
  frame.muscles[m].excitation = 1;
  EXPECT_GT(bellies().body(m, motion, frame).colors[ring].sum(), idle + 0.3f);
  std::vector<double> opacity(34, 0);
  opacity[m] = 0.5;
  Overlays shown;
  add_muscles(bellies(), motion, frame, opacity, true, shown);
  ASSERT_EQ(shown.bodies.size(), 1u);
  EXPECT_EQ(shown.bodies.begin()->second.opacity, 0.5f);
  EXPECT_EQ(shown.labels.size(), 1u);
  EXPECT_EQ(shown.key.size(), 1u);
}

}  // namespace
}  // namespace condyle
