#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/pose.h"

namespace condyle {

/// A surface with one material, mm, in the frame of its node. It may change its shape: it is
/// `vertices` at the first key of the motion and vertices + targets[k] at key k + 1.
struct GltfSurface {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;  // unit, one per vertex, or empty
  std::vector<Eigen::Vector3f> colors;   // sRGB, 0 to 1, one per vertex, or empty
  std::vector<Eigen::Vector3i> triangles;
  std::vector<std::vector<Eigen::Vector3f>> targets = {};
  Eigen::Vector3f color = Eigen::Vector3f::Ones();  // sRGB; multiplies those of the vertices
  float roughness = 0.6f;                           // 0 mirror to 1 chalk
  bool two_sided = false;
};

struct GltfNode {
  std::string name;
  int parent = -1;  // index of an earlier node; -1: the root
  Pose pose = {};   // in the parent, mm
  std::optional<GltfSurface> surface = {};
  std::map<std::string, std::string> extras = {};
};

/// Poses of a node at the times of the motion.
struct GltfTrack {
  int node = 0;
  std::vector<Pose> poses;
};

struct GltfMotion {
  std::string name;
  std::vector<double> times_s;  // of the tracks, increasing
  std::vector<GltfTrack> tracks;
  std::vector<double> key_times_s = {};  // of the shapes: one more than their targets
};

/// What a GLB file shows. Coordinates are DICOM LPS in mm; the root node, which the writer adds,
/// turns and scales them to glTF's metres with y up and the face towards +z.
struct GltfScene {
  std::string generator;  // program and version
  std::vector<GltfNode> nodes;
  std::optional<GltfMotion> motion = {};
  std::map<std::string, std::string> extras = {};  // of the whole file
};

/// The bytes of the GLB file. throws: InputError for lists whose lengths do not agree.
std::string glb_bytes(const GltfScene& scene);

}  // namespace condyle
