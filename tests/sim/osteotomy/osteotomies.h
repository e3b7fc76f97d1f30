#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "sim/osteotomy/osteotomy.h"
#include "tests/support/builtin.h"
#include "tests/support/real_cases.h"

namespace condyle::test {

inline const Part& part_named(const Case& patient, const std::string& name) {
  for (const auto& part : patient.parts)
    if (part.name == name) return part;
  throw std::runtime_error("no part " + name);
}

/// An osteotomy and its pieces.
struct Operated {
  PlacedOsteotomy placed;
  CutResult result;

  /// Volumes of the pieces by segment; of the rest by "".
  std::map<std::string, std::vector<double>> volumes() const {
    std::map<std::string, std::vector<double>> by_name;
    for (const auto& piece : result.pieces) {
      const int segment = segment_of(placed, piece);
      by_name[segment < 0 ? "" : placed.segments[segment].name].push_back(piece.volume_mm3);
    }
    return by_name;
  }
  /// Cut faces of all pieces.
  TriMesh walls() const {
    TriMesh walls;
    for (const auto& piece : result.pieces) {
      const int offset = static_cast<int>(walls.vertices.size());
      walls.vertices.insert(walls.vertices.end(), piece.mesh.vertices.begin(),
                            piece.mesh.vertices.end());
      for (std::size_t t = 0; t < piece.wall.size(); ++t)
        if (piece.wall[t] >= 0) walls.triangles.push_back(piece.mesh.triangles[t].array() + offset);
    }
    return walls;
  }
  const Piece& piece(const std::string& segment) const {
    for (const auto& p : result.pieces) {
      const int found = segment_of(placed, p);
      if (found >= 0 && placed.segments[found].name == segment) return p;
    }
    throw std::runtime_error("no piece " + segment);
  }
};

inline Operated operate(const Case& patient, const CutStep& step) {
  Operated done{place_osteotomy(patient, step), {}};
  done.result = cut_bone(part_named(patient, done.placed.part).mesh, done.placed.cuts);
  return done;
}

inline CutStep named(const std::string& osteotomy, std::map<std::string, double> parameters = {},
                     double kerf_mm = 0.6) {
  CutStep step;
  step.osteotomy = osteotomy;
  step.parameters = std::move(parameters);
  step.kerf_mm = kerf_mm;
  return step;
}

/// Every cut goes through, every piece is closed, and each segment is one piece: no other names.
inline void expect_parted(const Operated& done, const std::vector<std::string>& segments) {
  for (std::size_t i = 0; i < done.placed.cuts.size(); ++i) {
    EXPECT_TRUE(done.result.outcomes[i].meets_bone) << done.placed.cuts[i].name;
    EXPECT_TRUE(done.result.outcomes[i].through) << done.placed.cuts[i].name;
    EXPECT_TRUE(done.result.outcomes[i].windows.empty()) << done.placed.cuts[i].name;
  }
  EXPECT_TRUE(done.result.crossings.empty());
  for (const auto& piece : done.result.pieces) EXPECT_TRUE(inspect(piece.mesh).closed());
  const auto volumes = done.volumes();
  EXPECT_EQ(volumes.size(), segments.size());
  for (const auto& name : segments) {
    ASSERT_TRUE(volumes.contains(name)) << '"' << name << '"';
    EXPECT_EQ(volumes.at(name).size(), 1u) << '"' << name << '"';
  }
}

/// The whole patient turned and moved.
inline Case turned(Case patient, const Pose& X) {
  for (auto& part : patient.parts)
    for (auto& p : part.mesh.vertices) p = X * p;
  for (auto& [name, p] : patient.landmarks.points) p = X * p;
  for (auto& canal : patient.canals)
    for (auto& p : canal.points) p = X * p;
  return patient;
}

}  // namespace condyle::test
