#pragma once

#include <filesystem>

#include "sim/case/case.h"

namespace condyle {

/// Reads the muscles of facial expression into the case. Where the file does not say what their
/// ends are attached to, each fibre is turned so that it ends at the mouth, or in the skin, and
/// begins on the cranium or the mandible; the corner's muscles are led to the modiolus, those of
/// the lips to the skin of these, and fibres that form a loop are joined. `axes_to_lps`: of the
/// file's millimetres. throws: InputError, also for points outside the skin or far below it, and
/// for fibres that begin far from the bone that they name.
void import_face_muscles(const std::filesystem::path& file, const Eigen::Matrix3d& axes_to_lps,
                         Case& patient);

}  // namespace condyle
