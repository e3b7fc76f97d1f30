// A real opening of the built-in patient, written as GLB and read back by tinygltf.
#include "render/page/moving_patient.h"

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "render/page/patient_page.h"
#include "sim/phantom/phantom.h"
#include "sim/simulator/simulator.h"

namespace condyle {
namespace {

struct Opening {
  Scene scene;
  std::vector<FrameState> frames;
};

/// The first half of the opening at 30 frames per second.
const Opening& opening() {
  static const Opening made = [] {
    SimulatorSettings settings;
    settings.face = true;
    settings.step_s = 1.0 / 60;
    Opening result{make_scene(builtin_patient({}, {}), settings), {}};
    Playback playback(result.scene,
                      make_motion("opening", result.scene.patient, result.scene.contacts),
                      settings);
    for (int i = 0; i <= 45; ++i) result.frames.push_back(playback.at(i / 30.0));
    return result;
  }();
  return made;
}

class ReadGlb {
 public:
  explicit ReadGlb(const std::string& bytes) {
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    EXPECT_TRUE(loader.LoadBinaryFromMemory(&model, &error, &warning,
                                            reinterpret_cast<const unsigned char*>(bytes.data()),
                                            static_cast<unsigned>(bytes.size())))
        << error;
  }
  int node(const std::string& name) const {
    for (std::size_t n = 0; n < model.nodes.size(); ++n)
      if (model.nodes[n].name == name) return static_cast<int>(n);
    return -1;
  }
  /// All values of an accessor, sparse ones filled with zeros.
  std::vector<float> values(int index) const {
    const auto& accessor = model.accessors.at(static_cast<std::size_t>(index));
    const auto width = static_cast<std::size_t>(
        tinygltf::GetNumComponentsInType(static_cast<unsigned>(accessor.type)));
    std::vector<float> all(accessor.count * width, 0.f);
    if (!accessor.sparse.isSparse) {
      std::memcpy(all.data(), bytes(accessor.bufferView), all.size() * 4);
      return all;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(accessor.sparse.count); ++i) {
      std::uint32_t at = 0;
      std::memcpy(&at, bytes(accessor.sparse.indices.bufferView) + 4 * i, 4);
      std::memcpy(&all.at(width * at), bytes(accessor.sparse.values.bufferView) + 4 * width * i,
                  4 * width);
    }
    return all;
  }
  std::pair<std::vector<float>, std::vector<float>> track(int node, const std::string& path) const {
    for (const auto& channel : model.animations.at(0).channels)
      if (channel.target_node == node && channel.target_path == path) {
        const auto& sampler =
            model.animations[0].samplers.at(static_cast<std::size_t>(channel.sampler));
        return {values(sampler.input), values(sampler.output)};
      }
    return {};
  }

  tinygltf::Model model;

 private:
  const unsigned char* bytes(int view) const {
    return model.buffers[0].data.data() +
           model.bufferViews.at(static_cast<std::size_t>(view)).byteOffset;
  }
};

}  // namespace

TEST(MovingPatient, TheJawsTrackHasThePoseOfEachFrame) {
  const auto& [scene, frames] = opening();
  const ReadGlb glb(
      glb_bytes(moving_patient(scene.patient.bodies, scene.patient.parts, frames).scene));
  const auto [times, turns] = glb.track(glb.node("mandible"), "rotation");
  const auto shifts = glb.track(glb.node("mandible"), "translation").second;
  ASSERT_EQ(times.size(), frames.size());
  double largest = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    EXPECT_NEAR(times[f], frames[f].time_s, 1e-6);
    const Pose& X = frames[f].poses[mandible_body];
    const Eigen::Quaterniond q(turns[4 * f + 3], turns[4 * f], turns[4 * f + 1], turns[4 * f + 2]);
    // Of a point 100 mm away: single precision.
    EXPECT_LT(100 * (q.toRotationMatrix() - X.R.toRotationMatrix()).norm(), 1e-3);
    EXPECT_LT((Eigen::Vector3d(shifts[3 * f], shifts[3 * f + 1], shifts[3 * f + 2]) - X.t).norm(),
              1e-4);
    largest = std::max(largest, rotation_angle(X));
  }
  EXPECT_GT(largest, 0.4);  // the loop has seen an opening
  EXPECT_EQ(glb.node("cranium"), 1);
  EXPECT_TRUE(glb.track(glb.node("cranium"), "rotation").first.empty());
}

// The file's face, between its keys as a viewer shows it, is measured against every frame.
TEST(MovingPatient, TheFaceIsWithin03MillimetresOfEveryFrame) {
  const auto& [scene, frames] = opening();
  const MovingPatient moving = moving_patient(scene.patient.bodies, scene.patient.parts, frames);
  const ReadGlb glb(glb_bytes(moving.scene));
  const int node = glb.node("face");
  ASSERT_GT(node, 0);
  const auto& primitive =
      glb.model.meshes
          .at(static_cast<std::size_t>(glb.model.nodes[static_cast<std::size_t>(node)].mesh))
          .primitives.at(0);
  const auto rest = glb.values(primitive.attributes.at("POSITION"));
  std::vector<std::vector<float>> targets;
  for (const auto& target : primitive.targets) targets.push_back(glb.values(target.at("POSITION")));
  const auto [times, weights] = glb.track(node, "weights");
  ASSERT_EQ(times.size(), targets.size() + 1);
  EXPECT_EQ(moving.keys, times.size());

  std::map<std::tuple<float, float, float>, std::size_t> number;
  for (std::size_t v = 0; v < frames[0].face.size(); ++v)
    number[{frames[0].face[v].x(), frames[0].face[v].y(), frames[0].face[v].z()}] = v;
  double worst = 0, farthest = 0;
  std::size_t found = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    std::size_t k = 0;
    while (k + 2 < times.size() && times[k + 1] < frames[f].time_s) ++k;
    const double s = (frames[f].time_s - times[k]) / (times[k + 1] - times[k]);
    for (std::size_t v = 0; v < rest.size() / 3; ++v) {
      const auto known = number.find({rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]});
      if (known == number.end()) continue;
      ++found;
      Eigen::Vector3d shown(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]);
      for (std::size_t t = 0; t < targets.size(); ++t) {
        const double weight =
            (1 - s) * weights[k * targets.size() + t] + s * weights[(k + 1) * targets.size() + t];
        for (int c = 0; c < 3; ++c)
          shown[c] += weight * targets[t][3 * v + static_cast<std::size_t>(c)];
      }
      const Eigen::Vector3d truth = frames[f].face[known->second].cast<double>();
      worst = std::max(worst, (shown - truth).norm());
      farthest = std::max(
          farthest,
          (frames[f].face[known->second] - frames[0].face[known->second]).cast<double>().norm());
    }
  }
  EXPECT_GT(found, 9 * frames.size() * (rest.size() / 3) / 10);
  EXPECT_GT(farthest, 30);
  EXPECT_LT(worst, 0.3);
  EXPECT_NEAR(worst, moving.key_error_mm, 0.021);  // as stated, up to shifts that are left out
  EXPECT_LT(moving.keys, frames.size() / 2);
}

TEST(MovingPatient, OneFrameIsAPoseWithoutAnimation) {
  const auto& [scene, frames] = opening();
  const ReadGlb glb(glb_bytes(
      moving_patient(scene.patient.bodies, scene.patient.parts, std::span(&frames[30], 1)).scene));
  EXPECT_TRUE(glb.model.animations.empty());
  const auto& jaw = glb.model.nodes.at(static_cast<std::size_t>(glb.node("mandible")));
  const Pose& X = frames[30].poses[mandible_body];
  for (int k = 0; k < 3; ++k) EXPECT_EQ(jaw.translation[static_cast<std::size_t>(k)], X.t[k]);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(jaw.rotation[static_cast<std::size_t>(k)], X.R.coeffs()[k]);
}

TEST(PatientPage, TextsCannotEndTheirElements) {
  PatientPage page{.title = "<img src=x onerror=alert(1)>",
                   .glb = "glTF",
                   .times_s = {0},
                   .opening_mm = {0},
                   .phases = {{"</script><script>alert(1)</script>", 0, 1}},
                   .program = "Condyle",
                   .date = "2026-01-01",
                   .hashes = {{"Case", "<0>"}}};
  const std::string html = patient_page(page);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_EQ(html.find("alert(1)</script>"), std::string::npos);
  EXPECT_EQ(html.find("<0>"), std::string::npos);
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(html.find("http://"), std::string::npos);
  EXPECT_EQ(html.find("https://"), std::string::npos);
}

}  // namespace condyle
