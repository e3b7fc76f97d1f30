#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "render/image/image.h"
#include "sim/frame/part.h"

namespace condyle {

/// A view of a splint or guide and what it lies on. `toward_eye` and `up`: unit, cranium.
struct ApplianceView {
  std::string heading;
  std::vector<Part> parts = {};  // beside the appliance
  Eigen::Vector3d toward_eye = -Eigen::Vector3d::UnitY();
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double margin = 1.15;  // of the picture around the appliance
};

struct AppliancePicture {
  std::string title;
  std::vector<ApplianceView> views;  // in rows of two
  std::vector<std::string> lines = {};
};

/// One sheet of all views. Needs a current OpenGL context.
Image appliance_sheet(const TriMesh& appliance, const AppliancePicture& picture);

}  // namespace condyle
