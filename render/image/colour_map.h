#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace condyle {

/// One-dimensional map from a value on a surface to a colour, with a fixed range and legend texts.
struct ColourMap {
  struct Stop {
    float value;
    Eigen::Vector3f color;  // sRGB, 0 to 1
  };
  struct Band {
    float from, to;
    std::string name;
  };
  std::string title, unit;
  std::vector<Stop> stops;  // increasing; linear in between
  // above the last stop; below the first stop its colour applies
  Eigen::Vector3f beyond = {0.62f, 0.62f, 0.62f};
  std::string beyond_name = {};  // in the legend; empty: "more than", with the last stop
  std::vector<float> lines;      // values drawn as dark lines, at most four
  std::vector<float> ticks;
  std::vector<Band> bands;

  float low() const { return stops.front().value; }
  float high() const { return stops.back().value; }
};

Eigen::Vector3f color_of(const ColourMap& map, float value);

/// Bands of a map of signed distance, mm.
struct DistanceBands {
  double near_mm = 2;       // end of the map: larger distances are grey
  double close_mm = 0.5;    // limit between "near" and "close"; below near_mm
  double contact_mm = 0.1;  // on either side: touching
  double deepest_mm = 1;    // deeper overlaps have one colour
};

/// Signed distance to surfaces that a surface may touch, mm: red inside, darker with depth; white
/// at contact; blue apart, paler with distance; grey beyond. The bands differ in lightness as well
/// as in hue, for every kind of colour vision. source: after ColorBrewer RdBu.
ColourMap distance_colours(const DistanceBands& bands = {});

/// Length of a displacement, mm, from 0 to max_mm: dark blue to yellow, increasing in lightness, so
/// that it is readable with every kind of colour vision and without colour; dark red beyond.
/// source: viridis.
ColourMap displacement_colours(double max_mm);

/// Signed distance of one surface from another, mm, from -most_mm to most_mm: blue behind, white,
/// red in front, with lines at the tolerance on either side; grey where it is not known.
/// source: ColorBrewer RdBu.
ColourMap deviation_colours(double most_mm, double tolerance_mm);

}  // namespace condyle
