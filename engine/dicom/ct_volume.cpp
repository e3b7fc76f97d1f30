#include "engine/dicom/ct_volume.h"

#include "engine/core/error.h"
#include "engine/volume/volume_files.h"

namespace condyle {
namespace fs = std::filesystem;

CtVolume ct_volume(const std::filesystem::path& what, const CtRequest& request,
                   const Progress& progress) {
  if (!std::filesystem::exists(what)) throw InputError(what, "", "no such file or folder");
  if (std::filesystem::is_directory(what))
    return CtFolder(what, request.threads, progress).read(request, progress);
  if (!is_volume_file(what) && is_dicom_file(what))
    throw InputError(what, "", "is one file of a DICOM series: name its folder");
  if (request.series > 1)
    throw InputError(what, "series " + std::to_string(request.series),
                     "does not exist; the file holds one volume");
  report(progress, "volume", 0);
  return {read_volume(what), 0, {}};
}

bool is_dicom_file(const std::filesystem::path& file) {
  try {
    return open_dicom(file).has_value();
  } catch (const DicomDamage&) {
    return false;
  }
}

bool holds_dicom(const std::filesystem::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error) || fs::exists(path / "case.json", error)) return false;
  int looked_at = 0;
  for (fs::recursive_directory_iterator entry(path, fs::directory_options::skip_permission_denied,
                                              error);
       !error && entry != fs::recursive_directory_iterator() && looked_at < 1000;
       entry.increment(error), ++looked_at)
    if (entry->is_regular_file(error) && is_dicom_file(entry->path())) return true;
  return false;
}

}  // namespace condyle
