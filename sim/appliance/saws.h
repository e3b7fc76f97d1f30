#pragma once

#include <string>
#include <vector>

namespace condyle {

/// A blade that a guide's slot leads.
struct Saw {
  std::string name;
  double blade_mm = 0;  // thickness, with the set of its teeth
  std::string source;
};

/// Blades known by name, thinnest first.
const std::vector<Saw>& known_saws();

constexpr double thinnest_blade_mm = 0.1, thickest_blade_mm = 3;

/// A saw by its name, or a blade by its thickness in mm. throws: InputError for an unknown name,
/// with similar ones, and a thickness out of range.
Saw find_saw(const std::string& name_or_mm);

}  // namespace condyle
