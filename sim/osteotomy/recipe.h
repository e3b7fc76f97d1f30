#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/osteotomy/osteotomy.h"
#include "sim/osteotomy/surgical_anatomy.h"

namespace condyle {

/// What a recipe places an osteotomy with.
struct Site {
  SurgicalAnatomy anatomy;
  std::map<std::string, double> values;  // of all parameters
  double kerf_mm = 0;

  double operator[](const std::string& parameter) const { return values.at(parameter); }
};

/// The bones on which an osteotomy is placed.
enum class Jaw { lower, upper, skull };

/// A named osteotomy. `place` fills cuts and segments, and adds notes to the anatomy's.
struct Recipe {
  std::string name;
  Jaw jaw;
  std::vector<OsteotomyParameter> parameters;
  PlacedOsteotomy (*place)(Site& site);
  double kerf_mm = 0;  // default
};

Recipe genioplasty_recipe();
Recipe sagittal_split_recipe();
Recipe le_fort_1_recipe();
Recipe vertical_ramus_recipe();
Recipe inverted_l_recipe();
Recipe body_recipe();
Recipe segmental_resection_recipe();
Recipe le_fort_2_recipe();
Recipe le_fort_3_recipe();
Recipe vault_strip_recipe();
Recipe vault_panels_recipe();
Recipe barrel_staves_recipe();
Recipe bandeau_recipe();

/// The cuts that a step draws itself, on a bone of this name.
PlacedOsteotomy place_surfaces(const CutStep& step, const std::string& part);

}  // namespace condyle
