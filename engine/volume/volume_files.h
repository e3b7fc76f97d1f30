#pragma once

#include <filesystem>

#include "engine/volume/volume.h"

namespace condyle {

/// Whether the name ends as that of a volume: .nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz.
bool is_volume_file(const std::filesystem::path& file);

/// Reads a volume in NRRD, MetaImage or NIfTI-1 format. Values are rounded to whole Hounsfield
/// units and limited to 16 bits. The axes may be in any order and direction; they are
/// perpendicular. throws: InputError naming the file, the item and its value: geometry that is
/// absent, zero, sheared or not that of a patient; formats, encodings and types that are not read;
/// data that is shorter or longer than the header states. At most 1032 times the size of the file
/// is requested of the memory, the largest ratio of its compression.
Volume read_volume(const std::filesystem::path& file);

enum class NrrdEncoding { raw, gzip };

/// Writes the volume in NRRD format, LPS. throws: MachineError naming the file.
void write_nrrd(const Volume& volume, const std::filesystem::path& file,
                NrrdEncoding encoding = NrrdEncoding::gzip);

}  // namespace condyle
