#pragma once

#include <filesystem>

#include "engine/volume/volume.h"

// The formats of read_volume(), with its errors. Only for this module.
namespace condyle {

Volume read_nrrd(const std::filesystem::path& file);
Volume read_meta_image(const std::filesystem::path& file);
Volume read_nifti(const std::filesystem::path& file);

}  // namespace condyle
