#pragma once

#include <filesystem>

#include "engine/dicom/ct_folder.h"
#include "tools/command.h"

namespace condyle {

/// Prints the series of a folder with what is known of them, or all of it as JSON; the default one
/// is marked.
void print_series(const CtFolder& folder, const std::filesystem::path& path,
                  const CommonOptions& common);

}  // namespace condyle
