#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace condyle {

/// One-dimensional map from a number on a surface to a colour, of fixed range, with what its legend
/// says.
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
  std::vector<Stop> stops;                         // rising; straight in between
  Eigen::Vector3f beyond = {0.62f, 0.62f, 0.62f};  // from the last stop on; the first holds below
  std::vector<float> lines;                        // drawn as dark lines, four at most
  std::vector<float> ticks;
  std::vector<Band> bands;

  float low() const { return stops.front().value; }
  float high() const { return stops.back().value; }
};

Eigen::Vector3f color_of(const ColourMap& map, float value);

/// Bands of a map of signed distance, mm.
struct DistanceBands {
  double near_mm = 2;       // end of the map: farther off is drawn grey
  double close_mm = 0.5;    // where "near" begins to be "close"; below near_mm
  double contact_mm = 0.1;  // to either side: touching
  double deepest_mm = 1;    // overlaps beyond have one colour
};

/// Signed distance to what a surface may meet, mm: red inside, the darker the deeper; white where
/// they touch; blue apart, paler the farther; grey beyond. The bands are told apart by lightness as
/// well as by hue, with every kind of colour vision. source: after ColorBrewer RdBu.
ColourMap distance_colours(const DistanceBands& bands = {});

/// Length of a way, mm, from 0 to most_mm: dark blue to yellow, rising in lightness, so that it is
/// read with every kind of colour vision and without colour; dark red beyond. source:
/// viridis.
ColourMap displacement_colours(double most_mm);

}  // namespace condyle
