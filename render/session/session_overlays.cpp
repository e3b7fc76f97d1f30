#include "render/session/session_overlays.h"

#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

void add_cut(const CutOverlay& cut, const FrameState& frame, Overlays& shown) {
  const auto R = frame.poses[cut.body].R.toRotationMatrix().cast<float>().eval();
  const auto t = frame.poses[cut.body].t.cast<float>().eval();
  LineSet rims = cut.rims;
  for (auto& p : rims.ends) p = R * p + t;
  shown.lines["cut rims"] = std::move(rims);
  for (const auto& [name, sheet] : cut.sheets) {
    GlassSheet& placed = shown.sheets[name] = sheet;
    for (auto& p : placed.positions) p = R * p + t;
  }
}

GlassSheet splint_sheet(const SessionSplint& splint) {
  GlassSheet sheet{.color = {0.55f, 0.80f, 0.95f}, .opacity = 0.75f};
  for (const Eigen::Vector3d& p : splint.mesh.vertices) sheet.positions.push_back(p.cast<float>());
  sheet.triangles = splint.mesh.triangles;
  return sheet;
}

/// A part with a tint over it; none of the face, which deforms.
GlassSheet selection_sheet(const SessionPatient& patient, const FrameState& frame,
                           std::size_t selected) {
  GlassSheet sheet{.color = {0.34f, 0.71f, 0.91f}, .opacity = 0.3f};
  const auto& parts = patient.scene.patient.parts;
  if (selected >= parts.size() || parts[selected].role == Role::face) return sheet;
  const Part& part = parts[selected];
  const Pose X_CB = pose_of(part, frame.poses);
  for (const Eigen::Vector3d& p : part.mesh.vertices)
    sheet.positions.push_back((X_CB * p).cast<float>());
  sheet.triangles = part.mesh.triangles;
  return sheet;
}

}  // namespace

void add_session_overlays(const SessionState& state, const ViewState& view, Overlays& shown) {
  if (state.splint) shown.sheets["splint"] = splint_sheet(*state.splint);
  if (state.cut_overlay) add_cut(*state.cut_overlay, *state.newest, shown);
  if (const auto selected = visible_selection(view))
    shown.sheets["selected"] = selection_sheet(*state.patient, *state.newest, *selected);
}

}  // namespace condyle
