#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/case/case.h"
#include "sim/choice/file_role.h"

namespace condyle {

/// The kind of a dropped or opened file, by its name and first line.
enum class FileKind {
  patient,
  motion,
  excitations,
  surface,
  landmarks,
  muscles,
  plan,
  session,
  unknown
};
FileKind kind_of(const std::filesystem::path& path);

/// Whether a patient can be imported from such files.
constexpr bool makes_patient(FileKind kind) {
  return kind == FileKind::surface || kind == FileKind::landmarks || kind == FileKind::muscles;
}

/// The same files, with each folder that is no case replaced by the surfaces, landmarks and muscles
/// in it, if there are any.
std::vector<std::filesystem::path> with_loose_surfaces(
    const std::vector<std::filesystem::path>& files);

/// Guesses roles from the files' names: "mandible" for Lower_Jaw.stl; none where a name suggests
/// nothing. Among mandible.ply, mandible_8k.ply and mandible_with_teeth.ply, the same bone three
/// times, only the first has the role.
std::vector<FileRole> proposed_roles(const std::vector<std::filesystem::path>& files);

/// Makes a case from files with roles. `units`: mm, m, cm or in; `frame`: LPS, RAS, ... .
/// throws: InputError.
Case import_files(const std::vector<FileRole>& files, const std::string& units,
                  const std::string& frame);

}  // namespace condyle
