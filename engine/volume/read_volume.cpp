#include "engine/core/error.h"
#include "engine/volume/volume_files.h"
#include "engine/volume/volume_readers.h"
#include "engine/volume/voxel_data.h"

namespace condyle {
namespace {

using Reader = Volume (*)(const std::filesystem::path&);

Reader reader_of(const std::filesystem::path& file) {
  const std::string name = lower_case(file.filename().string());
  for (const char* ending : {".nrrd", ".nhdr"})
    if (name.ends_with(ending)) return read_nrrd;
  for (const char* ending : {".mha", ".mhd"})
    if (name.ends_with(ending)) return read_meta_image;
  for (const char* ending : {".nii", ".nii.gz"})
    if (name.ends_with(ending)) return read_nifti;
  return nullptr;
}

}  // namespace

bool is_volume_file(const std::filesystem::path& file) { return reader_of(file) != nullptr; }

Volume read_volume(const std::filesystem::path& file) {
  const Reader reader = reader_of(file);
  if (!reader)
    throw InputError(
        file, "",
        "does not have the extension of a volume: it must end in .nrrd, .nhdr, .mha, .mhd, .nii or "
        ".nii.gz");
  return reader(file);
}

}  // namespace condyle
