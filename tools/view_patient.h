#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/window/view_state.h"
#include "sim/simulator/simulator.h"
#include "tools/common.h"

namespace condyle {

/// A patient as the window has it: what is simulated, and what is told of it.
struct ViewPatient {
  std::filesystem::path folder;  // none: not kept in files
  Scene scene;
  FrameState at_rest;  // with its face
  std::vector<Landmark> landmarks;
  std::vector<Muscle> muscles;  // the case's, or usual ones; none where landmarks are missing
  std::string trouble;          // what had to be left out, as a sentence
};

/// Builds the scene of a patient, without soft tissue when the face does not allow any: the bones
/// can still be moved. throws: InputError.
std::shared_ptr<const ViewPatient> make_view_patient(Case patient, std::filesystem::path folder,
                                                     SimulatorSettings settings,
                                                     const Progress& progress);

/// The patient's case with other landmarks.
Case with_landmarks(Case patient, const std::vector<Landmark>& landmarks);

/// What a dropped or opened file is.
enum class FileKind { patient, motion, excitations, surface, landmarks, muscles, unknown };
FileKind kind_of(const std::filesystem::path& path);
/// What a patient is made of, with others of its kind.
constexpr bool makes_patient(FileKind kind) {
  return kind == FileKind::surface || kind == FileKind::landmarks || kind == FileKind::muscles;
}
/// Guesses from the files' names: "mandible" for Lower_Jaw.stl; none where a name tells nothing. Of
/// mandible.ply, mandible_8k.ply and mandible_with_teeth.ply, the same bone once more, only the
/// first one has the role.
std::vector<FileRole> proposed_roles(const std::vector<std::filesystem::path>& files);
/// throws: InputError.
Case import_files(const wish::Import& wanted);

}  // namespace condyle
