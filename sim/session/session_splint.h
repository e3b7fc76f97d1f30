#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/mesh/tri_mesh.h"
#include "sim/choice/plan_view.h"
#include "sim/operation/operation.h"

namespace condyle {

/// A splint of a session's plan, saved in a file.
struct SessionSplint {
  TriMesh mesh;  // in the cranium's frame, at the planned positions
  std::filesystem::path file;
  std::vector<std::string> findings;  // what was measured, in sentences
};

/// The splints that a plan allows: by name, see make_session_splint(). None without two arches and
/// a move of one.
std::vector<NamedItem> splint_choices(const Operated& operated);

/// Makes a splint ("final", "intermediate-upper": with the upper jaw moved first,
/// "intermediate-lower") and saves it as STL in the folder, under its name or one that is free.
/// throws: InputError as splint_arches() and make_splint(); MachineError where it cannot be saved.
std::shared_ptr<const SessionSplint> make_session_splint(const Operated& operated,
                                                         const std::string& choice,
                                                         const std::filesystem::path& folder,
                                                         int threads, const Progress& progress);

}  // namespace condyle
