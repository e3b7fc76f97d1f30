// The built-in patient blinks: its lids hide the eyeballs, and no skin enters them.
#include "render/life/living_face.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/mesh/triangle_tree.h"
#include "render/face/lashes.h"
#include "sim/phantom/phantom.h"
#include "tests/render/face/opened_patient.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Part& part_of(const Case& patient, Role role) {
  for (const Part& part : patient.parts)
    if (part.role == role) return part;
  throw std::runtime_error("the built-in patient lacks a part");
}

class LivingPatient : public testing::Test {
 protected:
  static const Case& patient() {
    static const Case built_in = builtin_patient();
    return built_in;
  }
  const Part& face_ = part_of(patient(), Role::face);
  const Part& eyes_ = part_of(patient(), Role::eyes);
  std::vector<Vector3f> rest_ = floats(face_.mesh);
  const std::optional<Vector3d> nose_tip_ = patient().landmarks.find("pronasale");
  LivingFace living_{patient().parts, rest_, face_.mesh.triangles, nose_tip_};

  std::vector<Vector3f> moved(const LifeSigns& signs) const {
    auto places = rest_;
    living_.move_face({}, signs, false, places);
    return places;
  }
  /// Shifts of the lashes of a part.
  std::vector<Vector3f> lashes_of(std::size_t part, const LifeSigns& signs) const {
    auto places = rest_;
    living_.move_lids(signs, false, places);
    return living_.lash_shifts(places)[part];
  }
  TriMesh skin_of(const LifeSigns& signs) const {
    TriMesh skin = face_.mesh;
    const auto places = moved(signs);
    for (std::size_t v = 0; v < places.size(); ++v) skin.vertices[v] = places[v].cast<double>();
    return skin;
  }
  /// Lines of sight that meet an eyeball first, one per 0.25 mm2 seen from the front and turned.
  int seen(const LifeSigns& signs, double turn) const {
    const TriMesh skin = skin_of(signs);
    auto balls = floats(eyes_.mesh);
    std::vector<Vector3f> normals(balls.size(), Vector3f::UnitZ());
    for (std::size_t i = 0; i < patient().parts.size(); ++i)
      if (&patient().parts[i] == &eyes_)
        living_.move_eyes(i, signs, lashes_of(i, signs), balls, normals);
    TriMesh eyes{{}, part_lashes(eyes_.mesh).eyes, {}};
    for (const auto& p : balls) eyes.vertices.push_back(p.cast<double>());
    const TriangleTree skin_tree(skin), eye_tree(eyes);
    const Vector3d ahead(std::sin(turn), std::cos(turn), 0), aside(ahead.y(), -ahead.x(), 0);
    int count = 0;
    for (double x = -50; x <= 50; x += 0.5)
      for (double z = 0; z <= 28; z += 0.5) {
        const Vector3d from = Vector3d(0, -80, z) + x * aside - 100 * ahead;
        const auto eye = eye_tree.ray_cast(from, ahead);
        if (!eye) continue;
        const auto hit = skin_tree.ray_cast(from, ahead);
        count += !hit || hit->distance > eye->distance;
      }
    return count;
  }
};

TEST_F(LivingPatient, ClosedLidsHideBothEyeballsFromTheFrontAndThreeQuarters) {
  EXPECT_EQ(living_.shortfall(), "");
  for (const double turn : {-0.7, 0.0, 0.7}) {
    const int open = seen({}, turn), half = seen({.lids = {0.5, 0.5}}, turn);
    EXPECT_GT(open, 700) << turn;
    EXPECT_GT(half, 0.2 * open);
    EXPECT_LT(half, 0.75 * open);
    for (const double gaze : {-0.12, 0.0, 0.12})
      EXPECT_EQ(seen({.lids = {1, 1}, .gaze_left = gaze}, turn), 0) << turn << " " << gaze;
  }
}

TEST_F(LivingPatient, AnExpressionClosesTheEyesOfItsSidesAndMovesNothingElse) {
  const auto seen_by = [&](const LidClosure& lids) {
    return seen({.lids = lids, .alive = false}, 0);
  };
  const int open = seen_by({}), left = seen_by({1, 0}), right = seen_by({0, 1});
  EXPECT_EQ(seen_by({1, 1}), 0);
  EXPECT_NEAR(left, open / 2, 0.05 * open) << "the right eye shows";
  EXPECT_EQ(left + right, open);
  const LifeSigns wink{.lids = {1, 0}, .alive = false};
  EXPECT_EQ(moved({.alive = false}), rest_);
  const auto places = moved(wink);
  int closed = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (places[v] == rest_[v]) continue;
    ++closed;
    EXPECT_GT(rest_[v].x(), 10) << "the patient's left";
    EXPECT_LT((rest_[v] - Vector3f(32, -75, 14)).norm(), 40);
  }
  EXPECT_GT(closed, 100);
  // Eyeballs do not turn; the lashes of the upper lid go with it.
  const auto eyes_at_rest = floats(eyes_.mesh);
  auto eyes = eyes_at_rest;
  std::vector<Vector3f> normals(eyes.size(), Vector3f::UnitZ());
  for (std::size_t i = 0; i < patient().parts.size(); ++i)
    if (&patient().parts[i] == &eyes_)
      living_.move_eyes(i, wink, lashes_of(i, wink), eyes, normals);
  const auto radii = lash_radii(eyes_.mesh);
  int lashes = 0;
  for (std::size_t v = 0; v < eyes.size(); ++v)
    if (eyes[v] != eyes_at_rest[v]) {
      EXPECT_GT(radii[v], 0);
      EXPECT_GT(eyes_at_rest[v].x(), 0);
      ++lashes;
    }
  EXPECT_GT(lashes, 100);
}

TEST_F(LivingPatient, ALidClosesOnItsSideWhereverTheOriginIs) {
  for (const double shift : {150.0, -150.0})
    for (const bool both : {true, false}) {
      std::vector<Part> parts = {face_, eyes_};
      for (Part& part : parts)
        for (auto& p : part.mesh.vertices) p.x() += shift;
      const TriMesh& eyes = parts[1].mesh;
      const auto is_right = [&](const Eigen::Vector3i& t) {
        return eyes.vertices[static_cast<std::size_t>(t[0])].x() < shift;
      };
      if (!both) std::erase_if(parts[1].mesh.triangles, is_right);
      const auto rest = floats(parts[0].mesh);
      const LivingFace living(parts, rest, parts[0].mesh.triangles, std::nullopt);
      EXPECT_EQ(living.lids_shortfall(), both ? "" : "no right eyeball was found");
      /// Vertices left and right of the middle of the face that move.
      const auto moved = [&](const LidClosure& lids) {
        auto places = rest;
        living.move_lids({.lids = lids, .alive = false}, false, places);
        std::pair<int, int> count;
        for (std::size_t v = 0; v < places.size(); ++v)
          if (places[v] != rest[v]) ++(rest_[v].x() > 0 ? count.first : count.second);
        return count;
      };
      const auto by_left = moved({1, 0}), by_right = moved({0, 1});
      EXPECT_GT(by_left.first, 50) << shift;
      EXPECT_EQ(by_left.second, 0) << shift;
      EXPECT_EQ(by_right.first, 0) << shift;
      if (both) {
        EXPECT_GT(by_right.second, 50) << shift;
      } else {
        EXPECT_EQ(by_right.second, 0) << "it has no right eyeball";
      }
    }
}

TEST_F(LivingPatient, ClosedLidsCoverTheCaruncleWithoutAStep) {
  // The deepest step between lines of sight 0.25 mm apart, nasal of the left eye's lashes.
  const auto step = [&](const LifeSigns& signs) {
    const TriMesh skin = skin_of(signs);
    const TriangleTree tree(skin);
    double most = 0;
    for (double x = 16; x <= 21; x += 0.25) {
      std::optional<double> before;
      for (double z = 9; z <= 20; z += 0.25) {
        const auto hit = tree.ray_cast(Vector3d(x, -150, z), Vector3d::UnitY(), 90);
        if (hit && before) most = std::max(most, std::abs(hit->distance - *before));
        before = hit ? std::optional(hit->distance) : std::nullopt;
        if (signs.lids.left == 1) {
          EXPECT_TRUE(hit) << x << " " << z;
        }
      }
    }
    return most;
  };
  EXPECT_GT(step({}), 2);
  EXPECT_LT(step({.lids = {1, 1}}), 0.75);
}

TEST_F(LivingPatient, AClosedLidHasACreaseAboveItsPlate) {
  const LivingEyes eyes(eyes_.mesh);
  const TriMesh skin = skin_of({.lids = {1, 1}});
  const TriangleTree tree(skin);
  for (const Eyeball& ball : eyes.eyeballs()) {
    const Vector3d centre = ball.centre.cast<double>();
    const auto away = [&](double up_deg) {
      const double up = up_deg * M_PI / 180;
      const Vector3d out(0, -std::cos(up), std::sin(up));
      const auto hit = tree.ray_cast(centre + 30 * out, -out, 30);
      return hit ? 30 - hit->distance : 0;
    };
    // How far the skin lies below the mean of what is 10 degrees above and below it.
    const auto sagging = [&](double up_deg) {
      return (away(up_deg - 10) + away(up_deg + 10)) / 2 - away(up_deg);
    };
    EXPECT_GT(sagging(18), 0.3);
  }
}

TEST_F(LivingPatient, NoSkinThatALidMovesIsInsideAnEyeball) {
  const LivingEyes eyes(eyes_.mesh);
  ASSERT_EQ(eyes.eyeballs().size(), 2u);
  int checked = 0;
  for (double closure = 0.1; closure <= 1; closure += 0.15)
    for (const double gaze : {-0.12, 0.0, 0.12}) {
      const LifeSigns signs{.lids = {closure, closure}, .gaze_left = gaze, .gaze_up = gaze / 3};
      const auto places = moved(signs);
      for (std::size_t e = 0; e < 2; ++e) {
        const Eyeball& ball = eyes.eyeballs()[e];
        const Vector3f look = eyes.gaze_of(e, signs);
        for (std::size_t v = 0; v < places.size(); ++v) {
          const Vector3f from = places[v] - ball.centre;
          if (places[v] == rest_[v] || from.norm() > ball.radius + 2) continue;
          EXPECT_GT(from.norm(), ball.reach(from.normalized(), look));
          ++checked;
        }
      }
    }
  EXPECT_GT(checked, 1000);
}

TEST_F(LivingPatient, TheLidsEdgeDescendsAsFarAsMeasuredOnPeople) {
  // Closing way of the upper lid, 9.1 +- 2.2 mm; here of the skin at the middle of the lids' edges.
  const auto closed = moved({.lids = {1, 1}});
  const LivingEyes eyes(eyes_.mesh);
  for (const Eyeball& ball : eyes.eyeballs()) {
    float most = 0;
    for (std::size_t v = 0; v < closed.size(); ++v)
      if (std::abs(rest_[v].x() - ball.centre.x()) < 3 && (rest_[v] - ball.centre).norm() < 20)
        most = std::max(most, (closed[v] - rest_[v]).norm());
    EXPECT_GT(most, 6.9f);
    EXPECT_LT(most, 11.3f);
  }
}

TEST_F(LivingPatient, TheNecksLowerEndStaysWithTheTrunkAndTheHeadStaysItself) {
  const LifeSigns extended{.extension = 0.05};
  const auto places = moved(extended);
  const Pose still = still_in_cranium({}, extended.extension);
  float low = 0;
  for (const auto& p : rest_) low = std::min(low, p.z());
  int ends = 0, above = 0;
  for (std::size_t v = 0; v < rest_.size(); ++v) {
    if (rest_[v].z() > -90 && rest_[v].z() < -5) {
      EXPECT_EQ(places[v], rest_[v]);
      ++above;
    }
    if (rest_[v].z() > low + 0.5f) continue;
    EXPECT_LT(((still * rest_[v].cast<double>()).cast<float>() - places[v]).norm(), 0.2f);
    ++ends;
  }
  EXPECT_GT(ends, 20);
  EXPECT_GT(above, 1000);
}

TEST_F(LivingPatient, ABreathMovesTheLowerNeckAndTheNostrilsByMillimetresAtMost) {
  const auto places = moved({.breath = 1});
  const auto still = moved({});
  float neck = 0, nose = 0;
  for (std::size_t v = 0; v < rest_.size(); ++v) {
    const float mm = (places[v] - still[v]).norm();
    (rest_[v].z() < -90 ? neck : nose) = std::max(rest_[v].z() < -90 ? neck : nose, mm);
    if (rest_[v].z() > 0) {
      EXPECT_EQ(mm, 0) << "forehead, eyes";
    }
  }
  EXPECT_GT(neck, 0.8f);
  EXPECT_LT(neck, 2);
  EXPECT_GT(nose, 0.2f);
  EXPECT_LT(nose, 0.5f);
}

TEST_F(LivingPatient, TheNostrilsBreatheWhereverTheChinIs) {
  ASSERT_TRUE(nose_tip_);
  auto prognathic = rest_;  // the chin lies 30 mm before the tip of the nose
  int in_front = 0;
  for (Vector3f& p : prognathic) {
    const Vector3f off = (p - Vector3f(0, -100, -85)) / 20;
    p.y() -= 45 * std::exp(-off.squaredNorm());
    in_front += p.y() < nose_tip_->y() - 10;
  }
  ASSERT_GT(in_front, 10);
  const LivingFace living(patient().parts, prognathic, face_.mesh.triangles, nose_tip_);
  auto places = prognathic, still = prognathic;
  living.move_face({}, {.breath = 1}, false, places);
  living.move_face({}, {}, false, still);
  float nose = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    const float mm = (places[v] - still[v]).norm();
    const bool beside_nose = (rest_[v] - nose_tip_->cast<float>()).norm() < 40;
    if (beside_nose) nose = std::max(nose, mm);
    if (!beside_nose && rest_[v].z() > -88) {
      EXPECT_EQ(mm, 0) << rest_[v].transpose();
    }
  }
  EXPECT_GT(nose, 0.2f);
  const LivingFace unknown(patient().parts, rest_, face_.mesh.triangles, std::nullopt);
  EXPECT_NE(unknown.shortfall().find("pronasale"), std::string::npos);
}

}  // namespace
}  // namespace condyle
