#pragma once

#include <filesystem>

#include "engine/dicom/ct_folder.h"

namespace condyle {

/// The volume of a folder with a DICOM series, or of a file in NRRD, MetaImage or NIfTI-1 format,
/// in Hounsfield units, LPS. throws: InputError, as CtFolder and read_volume().
CtVolume ct_volume(const std::filesystem::path& what, const CtRequest& request = {},
                   const Progress& progress = {});

/// Whether the file holds DICOM.
bool is_dicom_file(const std::filesystem::path& file);

/// Whether the path is a folder without case.json, in which a file holds DICOM: one of the first
/// thousand.
bool holds_dicom(const std::filesystem::path& path);

}  // namespace condyle
