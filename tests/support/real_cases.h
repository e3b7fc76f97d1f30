#pragma once

#include <filesystem>
#include <optional>

#include "sim/case/case_io.h"
#include "tests/support/places.h"

namespace condyle::test {

/// Folder of real anatomy beside the checkout; it may be absent.
inline std::filesystem::path real_data() { return source_folder() / ".." / "shared" / "data"; }

/// Its muscles and mechanics only on request: they change the guidance of its joints.
enum class Driven { no, by_muscles };
inline std::optional<Case> case_ubc(Driven driven = Driven::no) {
  const auto folder = real_data() / "case-ubc";
  if (!std::filesystem::exists(folder)) return std::nullopt;
  ImportRequest request;
  request.files = {{Role::maxilla, folder / "maxilla_with_teeth_wrap_30k.ply"},
                   {Role::mandible, folder / "mandible_8k.ply"},
                   {Role::upper_teeth, folder / "upper_teeth.ply"},
                   {Role::lower_teeth, folder / "lower_teeth.ply"}};
  request.landmarks = folder / "markers.csv";
  request.name = "case-ubc";
  if (driven == Driven::by_muscles) {
    request.muscles = folder / "muscles.csv";
    request.mechanics = folder / "model_parameters.json";
  }
  return import_meshes(request);
}

/// Its face, with its own muscles, only on request: most checks are of bones.
enum class Faced { no, yes };
inline std::optional<Case> case_badin(Faced faced = Faced::no) {
  const auto folder = real_data() / "case-badin";
  if (!std::filesystem::exists(folder)) return std::nullopt;
  ImportRequest request;
  request.files = {{Role::maxilla, folder / "maxilla_capped.ply"},
                   {Role::mandible, folder / "mandible.ply"}};
  request.landmarks = folder / "markers.csv";
  request.name = "case-badin";
  if (faced == Faced::yes) {
    request.files.emplace_back(Role::face, folder / "face_skin.ply");
    request.face_muscles = folder / "face_muscles.csv";
  }
  return import_meshes(request);
}

}  // namespace condyle::test
