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

/// Signed distance to the other bone, mm, from -2 to 5: red inside, white where they touch (within
/// 0.1 mm), blue apart, grey beyond. Red and blue are told apart with every kind of colour vision.
/// source: ColorBrewer RdBu.
ColourMap distance_colours();

}  // namespace condyle
