#pragma once

#include <filesystem>
#include <memory>

#include "sim/tissue/tissue.h"

namespace condyle {

/// build_tissue(), kept in a folder: the same bits, read where this build of the program made the
/// same model before. Damaged files are made again. Nothing is kept in an empty folder.
std::shared_ptr<const TissueModel> stored_tissue(const std::filesystem::path& cache,
                                                 const Case& patient,
                                                 const TissueSettings& settings = {},
                                                 const Progress& progress = {});

}  // namespace condyle
