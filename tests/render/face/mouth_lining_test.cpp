// The mouth is lined, and a section through it hollow, where the face has a rim between the lips.
#include "render/face/mouth_lining.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numbers>
#include <utility>

#include "render/face/cheek_thickness.h"
#include "render/face/skin_folds.h"
#include "render/mesh/vertex_normals.h"
#include "render/scene/mouth_cavity.h"
#include "tests/render/face/opened_patient.h"
#include "tests/render/scene_fixture.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

using MouthSection = WithContext;

/// A round head with a mouth 36 mm wide cut into it, and a small ball for the teeth of each jaw.
std::vector<Part> head_with_mouth(bool open = true) {
  TriMesh face = ball({0, 0, 0}, 60, 64);
  if (open)
    std::erase_if(face.triangles, [&](const Eigen::Vector3i& t) {
      const Eigen::Vector3d p =
          (face.vertices[t[0]] + face.vertices[t[1]] + face.vertices[t[2]]) / 3;
      return p.y() < 0 && std::hypot(p.x() / 18, p.z() / 7) < 1;
    });
  return {make_part("face", Role::face, face),
          make_part("upper_teeth", Role::upper_teeth, ball({0, -38, 6}, 16, 16)),
          make_part("lower_teeth", Role::lower_teeth, ball({0, -38, -6}, 16, 16))};
}

TEST(MouthLining, ClosesTheFaceAtTheRimAndNowhereElse) {
  const auto parts = head_with_mouth();
  const auto lining = line_mouth(parts);
  ASSERT_TRUE(lining);
  ASSERT_GT(lining->rim.size(), 20u);
  ASSERT_FALSE(is_closed_surface(parts[0].mesh.triangles));
  // Together, the lining's first vertices being those of the rim.
  auto all = parts[0].mesh.triangles;
  const int n = static_cast<int>(lining->rim.size()),
            own = static_cast<int>(parts[0].mesh.vertices.size());
  for (Eigen::Vector3i t : lining->triangles) {
    for (int& v : t) v = v < n ? lining->rim[static_cast<std::size_t>(v)] : own + v;
    all.push_back(t);
  }
  EXPECT_TRUE(is_closed_surface(all));
  auto fanned = parts[0].mesh.triangles;
  const auto fan = rim_fan(*lining);
  fanned.insert(fanned.end(), fan.begin(), fan.end());
  EXPECT_TRUE(is_closed_surface(fanned));
}

TEST(MouthLining, StaysBehindLipsThatComeForwardAndYieldsToThoseThatGoBack) {
  const auto parts = head_with_mouth();
  const auto lining = line_mouth(parts);
  ASSERT_TRUE(lining);
  const std::size_t n = lining->rim.size();
  for (const float back : {-4.0f, 4.0f}) {
    std::vector<Eigen::Vector3f> rim(lining->rest.begin(),
                                     lining->rest.begin() + std::ssize(lining->rim));
    for (auto& p : rim) p.y() += back;
    const auto now = places_now(*lining, rim, {});
    float most = 0;
    for (std::size_t v = n; v < now.size(); ++v)
      most = std::max(most, std::abs(now[v].y() - lining->rest[v].y()));
    if (back < 0) {
      EXPECT_LT(most, 1e-4f);
    } else {
      EXPECT_GT(most, 0.5f);
    }
  }
}

TEST(MouthLining, StaysBehindTheSkinOfARealSmile) {
  auto patient = test::case_badin(test::Faced::yes);
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  OpenedPatient real(std::move(*patient));
  ASSERT_NE(real.prepared.lining(), nullptr);
  const MouthLining& lining = *real.prepared.lining();
  ASSERT_FALSE(lining.cut);
  const SkinFolds folds(real.rest, real.normals, real.face->mesh.triangles, lining.rim);
  const CheekThickness cheeks(real.rest, real.normals, lining.rim, real.parts);
  for (const char* words : {"smile 0.5", "smile 1"}) {
    const FrameState frame = real.frame(words);
    auto places = real.drawn(frame);
    folds.apply(places);
    cheeks.apply(places);
    std::vector<Eigen::Vector3f> rim;
    for (const int v : lining.rim) rim.push_back(places[static_cast<std::size_t>(v)]);
    const auto now = places_now(lining, rim, frame.poses[real.scene.patient.jaw.lower_arch]);
    std::vector<Eigen::Vector3f> inner;  // of the lining's triangles, without those at the rim
    for (const auto& t : lining.triangles)
      for (const auto& [a, b] : {std::pair{0.5f, 0.5f}, {0.5f, 0.f}, {0.f, 0.5f}, {0.33f, 0.33f}})
        if (t.minCoeff() >= std::ssize(rim))
          inner.push_back(a * now[static_cast<std::size_t>(t[0])] +
                          b * now[static_cast<std::size_t>(t[1])] +
                          (1 - a - b) * now[static_cast<std::size_t>(t[2])]);
    TriMesh shown{{}, lining.face, {}};
    for (const auto& p : places) shown.vertices.push_back(p.cast<double>());
    const TriangleTree skin(shown);
    // Seen from the front, at the sides of the mouth: beyond `deepest_mm` the mouth is open.
    constexpr double side_mm = 20, far_mm = 60, deepest_mm = 3;
    double nearest = far_mm;  // behind the skin; negative where it is pierced
    int covered = 0;
    for (const auto& p : inner) {
      const Eigen::Vector3d in = Eigen::Vector3d::UnitY();
      const auto hit = skin.ray_cast(p.cast<double>() - far_mm * in, in, far_mm + deepest_mm);
      if (std::abs(p.x()) < side_mm || !hit) continue;
      nearest = std::min(nearest, far_mm - hit->distance);
      ++covered;
    }
    EXPECT_GT(covered, 500) << words;
    EXPECT_GT(nearest, 0.4) << words;  // 0.7; another course of frames differs by tenths
  }
}

TEST(MouthLining, FollowsTheLipsInFrontAndItsJawBehindThem) {
  const auto parts = head_with_mouth();
  const auto lining = line_mouth(parts);
  ASSERT_TRUE(lining);
  std::vector<Eigen::Vector3f> rim(lining->rest.begin(),
                                   lining->rest.begin() + std::ssize(lining->rim));
  const auto still = places_now(*lining, rim, {});
  for (std::size_t v = 0; v < still.size(); ++v)
    EXPECT_NEAR((still[v] - lining->rest[v]).norm(), 0, 1e-4f) << v;

  Pose X_CM;
  X_CM.t = {0, 0, -25};
  for (auto& p : rim) p.y() -= 4;
  const auto now = places_now(*lining, rim, X_CM);
  for (std::size_t v = 0; v < rim.size(); ++v) EXPECT_EQ(now[v], rim[v]);
  const std::size_t back = lining->rest.size() - 1 - lining->rim.size();
  int with_skull = 0, with_jaw = 0;
  for (std::size_t v = back; v + 1 < now.size(); ++v) {
    const Eigen::Vector3f displacement = now[v] - lining->rest[v];
    EXPECT_NEAR(displacement.z(), -25 * lining->jaw[v], 1e-3f);
    EXPECT_NEAR(displacement.y(), 0, 1e-3f);
    with_skull += displacement.z() > -0.5f;
    with_jaw += displacement.z() < -24.5f;
    EXPECT_EQ(lining->rest[v].z() > lining->mid_z + 0.5f, lining->jaw[v] < 0.46f) << v;
  }
  EXPECT_GT(with_skull, 5);
  EXPECT_GT(with_jaw, 5);
}

/// A head whose closed lips were one surface and are cut apart: vertices of both lips coincide. The
/// order of the triangles, and so that of the rim, may be reversed.
std::vector<Part> head_with_cut_lips(bool reversed) {
  auto parts = head_with_mouth(false);
  TriMesh& face = parts[0].mesh;
  const auto at_lips = [&](int v) {
    const Eigen::Vector3d& p = face.vertices[static_cast<std::size_t>(v)];
    return p.y() < 0 && std::abs(p.z()) < 1e-6 && std::abs(p.x()) < 18;
  };
  std::map<int, int> twins;
  for (auto& t : face.triangles) {
    double height = 0;
    for (const int v : t) height += face.vertices[static_cast<std::size_t>(v)].z();
    if (height > 0) continue;
    for (int& v : t) {
      if (!twins.contains(v) && !at_lips(v)) continue;
      const auto [twin, fresh] = twins.try_emplace(v, static_cast<int>(face.vertices.size()));
      if (fresh) {
        const Eigen::Vector3d p = face.vertices[static_cast<std::size_t>(v)];
        face.vertices.push_back(p);
      }
      v = twin->second;
    }
  }
  if (reversed) {
    // Other numbers for the vertices, so that the rim is found in another order.
    const int last = static_cast<int>(face.vertices.size()) - 1;
    std::reverse(face.vertices.begin(), face.vertices.end());
    for (auto& t : face.triangles)
      for (int& v : t) v = last - v;
  }
  return parts;
}

TEST(MouthLining, LipsThatCoincideAreKnownByTheSkinBesideThem) {
  for (const bool reversed : {false, true}) {
    const auto parts = head_with_cut_lips(reversed);
    const TriMesh& face = parts[0].mesh;
    const auto lining = line_mouth(parts);
    ASSERT_TRUE(lining);
    int upper = 0, lower = 0;
    for (std::size_t i = 0; i < lining->rim.size(); ++i) {
      if (std::abs(face.vertices[static_cast<std::size_t>(lining->rim[i])].x()) > 14) continue;
      double beside = 0;
      for (const auto& t : face.triangles)
        if (t[0] == lining->rim[i] || t[1] == lining->rim[i] || t[2] == lining->rim[i])
          for (const int v : t) beside += face.vertices[static_cast<std::size_t>(v)].z();
      (beside > 0 ? upper : lower) += 1;
      EXPECT_EQ(lining->jaw[i]<0.5f, beside> 0) << i;
    }
    EXPECT_GT(upper, 3);
    EXPECT_GT(lower, 3);
  }
}

TEST(MouthLining, APatientWithoutATongueGetsOne) {
  auto parts = head_with_mouth();
  const auto made = line_mouth(parts);
  parts.push_back(make_part("tongue", Role::tongue, ball({0, -20, -8}, 8, 16)));
  const auto none = line_mouth(parts);
  ASSERT_TRUE(made && none);
  ASSERT_EQ(made->rest.size(), none->rest.size());
  float rise = 0;
  for (std::size_t v = 0; v < made->rest.size(); ++v) {
    EXPECT_EQ(none->tongue[v], 0);
    const float up = made->rest[v].z() - none->rest[v].z();
    EXPECT_GE(up, -1e-4f);
    if (made->tongue[v] > 0.7f) rise = std::max(rise, up);
  }
  EXPECT_GT(rise, 6);
}

/// The same with crowns that are part of the jaws, which extend further than the teeth.
std::vector<Part> head_with_jaws(Role upper) {
  auto parts = head_with_mouth();
  parts[1] = make_part("upper", upper, parts[1].mesh);
  parts[2] = make_part("mandible", Role::mandible, parts[2].mesh);
  const auto high = ball({0, 0, 40}, 15, 16), ramus = ball({0, 30, 0}, 25, 16);
  for (const auto& [part, more] : {std::pair(&parts[1], &high), std::pair(&parts[2], &ramus)}) {
    auto& mesh = part->mesh;
    const int own = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), more->vertices.begin(), more->vertices.end());
    for (const auto& t : more->triangles) mesh.triangles.push_back(t.array() + own);
  }
  return parts;
}

TEST(MouthLining, IsFoundFromTheFrontsOfTheJawsWithoutSeparateTeeth) {
  const auto teeth = line_mouth(head_with_mouth());
  ASSERT_TRUE(teeth);
  for (const Role upper : {Role::maxilla, Role::skull}) {
    const auto jaws = line_mouth(head_with_jaws(upper));
    ASSERT_TRUE(jaws);
    EXPECT_EQ(jaws->rim, teeth->rim);
    EXPECT_EQ(jaws->mid_z, teeth->mid_z);
    ASSERT_EQ(jaws->rest.size(), teeth->rest.size());
    Eigen::AlignedBox3f box, with_teeth;
    for (const auto& v : jaws->rest) box.extend(v);
    for (const auto& v : teeth->rest) with_teeth.extend(v);
    // The fronts are the teeth's balls near the lips: nothing far behind or above.
    EXPECT_NEAR(box.min().x(), with_teeth.min().x(), 1);
    EXPECT_NEAR(box.max().x(), with_teeth.max().x(), 1);
    EXPECT_NEAR(box.min().y(), with_teeth.min().y(), 0.1);
    EXPECT_LT(box.max().y(), 20);
    EXPECT_GT(box.max().y(), with_teeth.max().y() - 1);
  }
}

TEST(MouthLining, FollowsAThinLipBackwardBeforeItTurnsAside) {
  const auto lining = line_mouth(head_with_jaws(Role::maxilla));
  ASSERT_TRUE(lining);
  const std::size_t n = lining->rim.size();
  for (std::size_t v = n; v < 2 * n; ++v) {
    const Eigen::Vector3f displacement = lining->rest[v] - lining->rest[v - n];
    EXPECT_GT(displacement.y(), std::abs(displacement.z())) << v;
  }
}

TEST(MouthLining, CoversAPalateWithoutGumsButLiesWithinThem) {
  // A flat palate 15 mm above the line of the lips.
  TriMesh palate;
  palate.vertices = {{-30, -35, 15}, {30, -35, 15}, {30, 5, 15}, {-30, 5, 15}};
  palate.triangles = {{0, 1, 2}, {0, 2, 3}};
  const auto highest_below = [&](Role role) {
    auto parts = head_with_jaws(Role::maxilla);
    parts.push_back(make_part("palate", role, palate));
    const auto lining = line_mouth(parts);
    float highest = 0;
    for (const auto& v : lining.value().rest)
      if (std::abs(v.x()) < 15 && v.y() > -20 && v.y() < 0) highest = std::max(highest, v.z());
    return highest;
  };
  EXPECT_NEAR(highest_below(Role::maxilla), 14, 0.1);
  EXPECT_NEAR(highest_below(Role::upper_gums), 16.5, 0.1);
}

TEST(MouthLining, CoversABarePalateThatIsLowToo) {
  // Hardly above the lips, but well above the crowns beside it.
  TriMesh arch;
  const auto plate = [&](double from_x, double to_x, double z) {
    const int first = static_cast<int>(arch.vertices.size());
    for (const auto& [x, y] : {std::pair(from_x, -35.), {to_x, -35.}, {to_x, 5.}, {from_x, 5.}})
      arch.vertices.emplace_back(x, y, z);
    arch.triangles.insert(arch.triangles.end(),
                          {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
  };
  plate(-13, 13, 7);
  plate(-18, -13, 1.5);
  plate(13, 18, 1.5);
  auto parts = head_with_jaws(Role::maxilla);
  parts.push_back(make_part("arch", Role::maxilla, arch));
  const auto lining = line_mouth(parts);
  ASSERT_TRUE(lining);
  int palate = 0;
  for (const auto& v : lining->rest)
    if (std::abs(v.x()) < 8 && v.y() > -20 && v.y() < -6 && v.z() > 0.5f) {
      EXPECT_LT(v.z(), 7) << v.transpose();
      ++palate;
    }
  EXPECT_GT(palate, 10);
}

TEST(MouthLining, RisesBeforeCrownsHoweverNearTheLipTheyStand) {
  const double radius_mm = 4;
  auto parts = head_with_jaws(Role::maxilla);
  for (const double x : {-13, 13})
    parts.push_back(make_part("canine", Role::maxilla, ball({x, -53, 7}, radius_mm, 16)));
  const auto lining = line_mouth(parts);
  ASSERT_TRUE(lining);
  int at_crowns = 0;
  for (std::size_t v = 0; v < lining->rest.size(); ++v) {
    const auto& p = lining->rest[v];
    const double away = std::hypot(std::abs(p.x()) - 13, p.y() + 53);
    if (away > 0.8 * radius_mm || lining->jaw[v] > 0.4f || p.z() < 0) continue;
    EXPECT_GT(p.z(), 7 - std::sqrt(radius_mm * radius_mm - away * away)) << p.transpose();
    EXPECT_LT(lining->lip[v], 0.5f);
    ++at_crowns;
  }
  EXPECT_GT(at_crowns, 12);
}

TEST(MouthLining, RaggedRimsAreDrawnEven) {
  std::vector<Eigen::Vector3f> places = {{0, 0, 9}};
  std::vector<int> rim;
  for (int i = 0; i < 120; ++i) {
    const float a = static_cast<float>(2 * std::numbers::pi * i / 120), r = i % 4 < 2 ? 21.f : 19.f;
    rim.push_back(static_cast<int>(places.size()));
    places.emplace_back(r * std::cos(a), 0, r * std::sin(a));
  }
  even_rim(places, rim);
  for (const int v : rim) EXPECT_NEAR(places[static_cast<std::size_t>(v)].norm(), 20, 0.25);
  EXPECT_EQ(places[0], Eigen::Vector3f(0, 0, 9));
}

TEST_F(MouthSection, IsAtItsRimOfTheFacesColour) {
  auto parts = head_with_mouth();
  for (const auto& v : parts[0].mesh.vertices)
    parts[0].mesh.colors.emplace_back(v.z() > 0 ? 0.8f : 0.3f, 0.5f, 0.4f);
  const auto lining = line_mouth(parts);
  ASSERT_TRUE(lining);
  const std::vector<const Part*> drawn = {&parts[0]};
  const auto faces = make_drawables(drawn, &*lining);
  MouthCavity mouth(*lining, faces[0]);
  const auto& inside = mouth.place(faces[0].mesh, {});
  const std::size_t n = lining->rim.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto& skin = faces[0].colors[static_cast<std::size_t>(lining->rim[i])];
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(inside.colors[i][k], skin[k], 1);
    EXPECT_EQ(inside.extras[i][3], 255);
    // Far behind it is of one red, beside the tongue, and has nothing of the lip.
    if (lining->tongue[20 * n + i] == lining->tongue[20 * n]) {
      EXPECT_EQ(inside.colors[20 * n + i], inside.colors[20 * n]);
    }
    EXPECT_EQ(inside.extras[20 * n + i][3], 0);
  }
}

TEST(MouthLining, IsNotKnownWithoutARimOrWithoutEitherJaw) {
  EXPECT_FALSE(line_mouth(head_with_mouth(false)));
  for (const std::size_t missing : {1u, 2u})
    for (auto parts : {head_with_mouth(), head_with_jaws(Role::maxilla)}) {
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(missing));
      EXPECT_FALSE(line_mouth(parts)) << missing;
    }
}

TEST_F(MouthSection, IsFleshRoundAboutAndHollowInside) {
  const auto parts = head_with_mouth();
  SceneRenderer renderer(parts);
  auto settings = mask_settings(300);
  settings.shadows = false;
  settings.part_opacity = {{"upper_teeth", 0}, {"lower_teeth", 0}};
  settings.clip = {.point = {0.3, 0, 0}, .normal = {1, 0, 0}};
  Camera side = front_camera(150);
  side.direction = {1, 0, 0};  // the face looks to the left of the picture
  const auto at = [&](const Image& image, double y, double z) {
    return pixel(image, static_cast<int>(150 + 2 * y), static_cast<int>(150 - 2 * z));
  };
  const Image section = renderer.picture(side, settings);
  const Pixel flesh = at(section, 30, 0);
  const auto is_flesh = [&](double y, double z) {
    const Pixel p = at(section, y, z);
    return std::abs(p.r - flesh.r) + std::abs(p.g - flesh.g) + std::abs(p.b - flesh.b) < 6;
  };
  for (const double z : {-40.0, -25.0, 25.0, 40.0}) EXPECT_TRUE(is_flesh(-30, z)) << z;
  for (const double y : {5.0, 40.0}) EXPECT_TRUE(is_flesh(y, 0)) << y;
  for (const double y : {-52.0, -40.0, -30.0, -20.0}) {
    EXPECT_FALSE(is_flesh(y, 0)) << y;
    EXPECT_EQ(at(section, y, 0).a, 255) << y;  // the far cheek's lining is behind
  }
  // Viewed from the kept side, and without a section, nothing changes.
  side.direction = {-1, 0, 0};
  const Image kept = renderer.picture(side, settings);
  settings.clip->capped = false;
  EXPECT_EQ(kept.rgba, renderer.picture(side, settings).rgba);
}

TEST_F(MouthSection, OfAHeadWithATongueHasADarkAirwayBehindIt) {
  auto parts = head_with_mouth();
  parts.push_back(make_part("tongue", Role::tongue, ball({0, -25, -5}, 15)));
  SceneRenderer renderer(parts);
  auto settings = mask_settings(300);
  settings.shadows = false;
  settings.clip = {.point = {0.3, 0, 0}, .normal = {1, 0, 0}};
  Camera side = front_camera(150);
  side.direction = {1, 0, 0};
  const auto at = [&](const Image& image, double y, double z) {
    return pixel(image, static_cast<int>(150 + 2 * y), static_cast<int>(150 - 2 * z));
  };
  const Image section = renderer.picture(side, settings);
  const Pixel flesh = at(section, 40, 0), airway = at(section, -4.6, -9.2),
              tongue = at(section, -25, -5);
  EXPECT_LT(airway.r, 40);
  EXPECT_GT(flesh.r, 80);
  EXPECT_LT(flesh.r - flesh.b, 25) << "neutral";
  EXPECT_GT(tongue.r - tongue.b, 25);
  // A section beside it has none.
  settings.clip->point.x() = 20;
  EXPECT_NEAR(at(renderer.picture(side, settings), -4.6, -9.2).r, flesh.r, 12);
}

TEST_F(MouthSection, WithoutOneTheOpenMouthIsDarkRedAndNothingIsSeenThroughIt) {
  auto parts = head_with_mouth();
  std::erase_if(parts[0].mesh.triangles, [&](const Eigen::Vector3i& t) {
    return parts[0].mesh.vertices[t[0]].y() > 30;  // no nape
  });
  SceneRenderer renderer(parts);
  auto settings = mask_settings(300);
  settings.part_opacity = {{"upper_teeth", 0}, {"lower_teeth", 0}};
  const auto inside = [&](double skin) {
    settings.skin_opacity = skin;
    return pixel(renderer.picture(front_camera(150), settings), 150, 150);
  };
  const Pixel lined = inside(1);
  EXPECT_EQ(lined.a, 255);
  EXPECT_GT(lined.r, 15);
  EXPECT_LT(lined.r, 110);
  EXPECT_GT(lined.r, 1.5 * lined.g);
  EXPECT_GT(lined.r, 1.5 * lined.b);
  EXPECT_EQ(inside(0.5).a, 0);  // a translucent face shows what is behind it
}

TEST_F(MouthSection, ALipThatEndsAtItsEdgeHasNoGlintAlongIt) {
  auto parts = head_with_mouth();
  parts.push_back(make_part("tongue", Role::tongue, ball({0, -20, -8}, 8, 16)));
  SceneRenderer renderer(parts);
  auto settings = mask_settings(200);
  settings.shadows = false;
  settings.part_opacity = {{"upper_teeth", 0}, {"lower_teeth", 0}, {"tongue", 0}};
  Camera camera = front_camera(10);
  camera.target = {0, -59, -7};
  camera.direction = Eigen::Vector3d(0.1, -1, 0.5).normalized();
  const Image image = renderer.picture(camera, settings);
  // The edge runs through the middle; below is the lip's red.
  for (int x = 10; x < 200; x += 20) {
    int edge = 0, lip = 0;
    for (int y = 0; y < 200; ++y) {
      int& brightest = y < 140 ? edge : lip;
      brightest = std::max(brightest, pixel(image, x, y).g);
    }
    EXPECT_GT(edge, 60) << x;
    EXPECT_LT(edge, lip + 12) << x;
  }
}

}  // namespace
}  // namespace condyle
