#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/case/case.h"

namespace condyle {

struct PartGeometry {
  std::string name;
  std::uint64_t hash = 0;  // of vertices and triangles, not of colours

  bool operator==(const PartGeometry&) const = default;
};

/// What a plan remembers of its case, to recognise it: surfaces of bone, teeth and face, and the
/// landmarks, from which cuts and moves are placed.
struct CaseGeometry {
  std::string name;
  std::vector<PartGeometry> parts;  // in the order of the case
  Landmarks landmarks;

  bool operator==(const CaseGeometry& other) const;
};

CaseGeometry geometry_of(const Case& patient);

/// Hash of surfaces and landmarks, without the name of the case: 16 hexadecimal digits.
std::string geometry_hash(const CaseGeometry& geometry);

enum class CaseMatch { same, landmarks_edited, other_case };

/// How a case differs from the one that a plan was made for.
struct CaseComparison {
  CaseMatch match = CaseMatch::same;
  std::vector<std::string> differences;  // "pogonion moved by 1.2 mm", "mandible has another shape"
};

/// Names of cases do not matter; a part of another name or shape makes it another case.
CaseComparison compare_geometry(const CaseGeometry& planned, const CaseGeometry& present);

}  // namespace condyle
