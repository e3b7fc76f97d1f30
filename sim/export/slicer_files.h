#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "sim/case/landmarks.h"

namespace condyle {

/// An ITK transform file (.tfm) that 3D Slicer applies as `X`: a point p of the moved body at rest
/// lies at X p. LPS, mm. The file holds the inverse of X, as ITK's convention for resampling and
/// Slicer's for transform files is ("from parent").
std::string itk_transform(const Pose& X);

/// Points and lines of 3D Slicer's module Markups.
struct SlicerMarkup {
  enum class Kind { points, line, angle } kind = Kind::points;
  std::string name;
  struct Point {
    std::string label;
    Eigen::Vector3d place;  // LPS, mm
  };
  std::vector<Point> points;  // a line has two, an angle three, its vertex in the middle
};

/// Length of a line in mm, angle in degrees; 0 for points.
double measured(const SlicerMarkup& markup);

/// A file .mrk.json by the schema of version 1.0.0, in LPS and mm. Lines and angles state their
/// measured value.
std::string slicer_markups(const std::vector<SlicerMarkup>& markups);

/// The landmarks as one list of points with readable labels.
SlicerMarkup landmark_markup(const Landmarks& landmarks, const std::string& name);

}  // namespace condyle
