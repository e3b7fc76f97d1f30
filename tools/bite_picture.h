#pragma once

#include "render/image/image.h"
#include "sim/frame/body_poses.h"
#include "sim/occlusion/occlusion.h"

namespace condyle {

/// Both arches in a bite, opened like a book and coloured by the gap between them; `at`: poses of
/// all bodies in it. Needs a current OpenGL context.
Image bite_picture(const Case& patient, const Bite& bite, const BodyPoses& at, double film_mm,
                   int threads);

}  // namespace condyle
