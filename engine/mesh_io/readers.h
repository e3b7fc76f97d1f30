#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// One reader per format: from the whole content of the file to a mesh. `file` names it in errors.
TriMesh read_stl(const std::filesystem::path& file, std::string_view content);
TriMesh read_ply(const std::filesystem::path& file, std::string_view content);
TriMesh read_obj(const std::filesystem::path& file, std::string_view content);
TriMesh read_glb(const std::filesystem::path& file, std::string_view content);

/// The reader that the file's extension asks for, and the checks that all formats share.
TriMesh parse_mesh(const std::filesystem::path& file, std::string_view content);

/// "an STL file", "text" ...: the apparent format of the first bytes, for messages.
std::string looks_like(std::string_view content);

/// Checks a count read from a header before anything is allocated. throws: InputError.
void check_count(const std::filesystem::path& file, std::string_view what, double count, int limit);

/// Finite coordinates, within reach of any unit a head could be in.
bool sound_point(const Eigen::Vector3d& p);
[[noreturn]] void refuse_point(const std::filesystem::path& file, const std::string& item,
                               const Eigen::Vector3d& p);

}  // namespace condyle
