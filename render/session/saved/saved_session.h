#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "render/camera/camera.h"
#include "render/window/view/view_state.h"
#include "sim/plan/plan.h"

namespace condyle {

/// Where a patient comes from: a built-in one by its name, a case folder, or imported surfaces.
struct BuiltInSource {
  std::string name = "built-in";
  bool operator==(const BuiltInSource&) const = default;
};
struct FolderSource {
  std::filesystem::path folder;  // absolute
  bool operator==(const FolderSource&) const = default;
};
struct SurfaceSource {
  struct Surface {
    std::filesystem::path file;  // absolute
    std::string role;
    bool operator==(const Surface&) const = default;
  };
  std::vector<Surface> surfaces = {};
  std::string units = "mm", frame = "LPS";
  bool operator==(const SurfaceSource&) const = default;
};
using PatientSource = std::variant<BuiltInSource, FolderSource, SurfaceSource>;

/// Names of what a view numbers, by number.
struct ViewNames {
  std::vector<std::string> parts = {}, muscles = {}, layers = {};
  std::vector<std::string> bodies = {};  // by BodyId; empty: not movable
  std::string chosen = {};               // the body with handles; empty: none

  bool operator==(const ViewNames&) const = default;
};

/// The state of a window, as it is saved and opened again.
struct SavedSession {
  PatientSource source = {};
  CaseGeometry geometry = {};       // of the patient before the operation
  bool landmarks_replaced = false;  // those of the source, by the landmarks of the geometry
  std::filesystem::path plan = {};  // file of the plan, absolute; empty: none
  std::optional<Plan> draft = {};   // a plan without a file
  Camera camera = {};               // in the world's frame
  ViewState view = {};              // by the numbers of `names`
  ViewNames names = {};
  std::filesystem::path saved_as = {};  // of an autosave: file of the session; empty: none
  std::vector<Eigen::Vector3d> measured_at_rest = {};  // the measured points, cranium's frame, mm
};

/// Whether both would be written as the same file. The clock of a playing motion does not count.
bool same_session(const SavedSession& a, const SavedSession& b);

/// The view of a front end as it is saved, without patient and plan.
SavedSession saved_view(const ViewState& view, const WindowScene& scene, const Camera& camera);

/// A saved view for a scene whose parts may have other numbers. `left_out`: sentences on what the
/// scene has no place for.
ViewState fitted_view(const SavedSession& session, const WindowScene& scene,
                      std::vector<std::string>& left_out);

}  // namespace condyle
