#include "sim/session/session_splint.h"

#include <fmt/format.h>

#include <sstream>

#include "engine/core/error.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/appliance/appliance_text.h"
#include "sim/appliance/plan_arches.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

fs::path free_file(const fs::path& folder, const std::string& stem) {
  fs::path file = folder / (stem + ".stl");
  std::error_code ignored;
  for (int i = 2; fs::exists(file, ignored); ++i) file = folder / fmt::format("{}-{}.stl", stem, i);
  return file;
}

}  // namespace

std::vector<NamedItem> splint_choices(const Operated& operated) {
  const bool upper = moves_arch(operated, true), lower = moves_arch(operated, false);
  std::vector<NamedItem> choices;
  if (upper || lower) choices.push_back({"final", "Final splint"});
  if (upper && lower) {
    choices.push_back({"intermediate-upper", "Intermediate splint, upper jaw first"});
    choices.push_back({"intermediate-lower", "Intermediate splint, lower jaw first"});
  }
  return choices;
}

std::shared_ptr<const SessionSplint> make_session_splint(const Operated& operated,
                                                         const std::string& choice,
                                                         const fs::path& folder, int threads,
                                                         const Progress& progress) {
  const SplintKind kind = choice == "final" ? SplintKind::final_bite : SplintKind::intermediate;
  const FirstJaw first = choice == "intermediate-lower" ? FirstJaw::lower : FirstJaw::upper;
  SplintSettings settings;
  settings.threads = threads;
  const Splint splint = make_splint(splint_arches(operated, kind, first), settings, progress);
  auto made = std::make_shared<SessionSplint>();
  made->mesh = splint.mesh;
  made->file = free_file(folder, choice + "-splint");
  write_stl(splint.mesh, made->file);
  std::istringstream lines(splint_text(splint, settings));
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) made->findings.push_back(line);
  if (kind == SplintKind::intermediate)
    made->findings.push_back(
        "It fits the arches after the first move, not at their final positions.");
  made->findings.insert(made->findings.end(), splint.notes.begin(), splint.notes.end());
  return made;
}

}  // namespace condyle
