#pragma once

#include <string>

namespace condyle {

/// "Le Fort I" of "le_fort_1", "Sagittal split" of "sagittal_split".
std::string osteotomy_label(const std::string& name);

}  // namespace condyle
