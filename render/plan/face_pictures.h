#pragma once

#include <string>
#include <vector>

#include "render/image/image.h"
#include "sim/prediction/prediction.h"

namespace condyle {

/// A picture of the face from one standard view.
struct FacePicture {
  std::string what;  // "before", "after", "bones" or "map"
  std::string view;
  Image image;
};

/// The face before and after the operation, the planned bones under a skin of glass, and the map of
/// the displacement, each from the front, the left and three quarters. Needs a current OpenGL
/// context.
std::vector<FacePicture> face_pictures(const Prediction& prediction);

/// One sheet of those: a column for each view, rows before, after and map. Not empty.
Image face_sheet(const std::vector<FacePicture>& pictures, const std::string& title,
                 const std::vector<std::string>& lines = {});

}  // namespace condyle
