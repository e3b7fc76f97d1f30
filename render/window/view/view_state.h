#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/image/colour_map.h"
#include "render/window/view/landmark_list.h"
#include "render/window/view/measuring.h"
#include "render/window/view/movable.h"
#include "render/window/view/ui_commands.h"
#include "sim/frame/before_operation.h"
#include "sim/frame/expression_level.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// An entry of the tree other than a part.
struct TreeItem {
  std::string name, label;
  std::string short_label = {};  // in the tree, where the label is long; empty: the label
};

/// The content of a window. Plain data; the parts must outlive the window or the next scene.
struct WindowScene {
  std::span<const Part> parts = {};
  std::string case_name = {};
  std::string motion_name = {};
  double duration_s = 0;       // of the motion; 0 when there is none
  double step_s = 1.0 / 30;    // for one press of an arrow key
  double max_opening_mm = 50;  // end of the opening slider; below 1: the slider is disabled
  std::vector<std::string> notes = {};  // sentences about this case, e.g. overlap at rest
  // Colours for distances, where the loop behind the window can compute them, and remarks for
  // their legend.
  std::optional<ColourMap> distance_colours = {};
  std::vector<std::string> distance_remarks = {};
  std::vector<MovableBody> bodies = {};    // movable by hand
  std::filesystem::path case_folder = {};  // empty: not stored in files
  std::vector<std::string> motions = {};   // names to choose from
  MotionChoice motion = {};                // source of the motion
  std::vector<MotionSetting> motion_settings = {};
  std::vector<ExcitationSetting> excitations = {};  // of a motion that muscles drive
  std::vector<Landmark> landmarks = {};             // of the loaded or saved case
  std::vector<Landmark> landmarks_in_use = {};      // those of the simulation
  std::vector<TreeItem> expressions = {};  // of the face, and action units; none: no muscles
  std::vector<TreeItem> muscles = {};      // lines of action that can be shown, in the case's order
  std::vector<TreeItem> layers = {};       // sheets of the soft tissue, from the skin inward
  std::vector<std::filesystem::path> recent = {};      // opened before, the last one first
  PlanView plan = {};                                  // of the operation
  std::shared_ptr<const BeforeOperation> before = {};  // none where the plan changes nothing
  std::filesystem::path session = {};                  // file of the session; empty: not saved
  std::shared_ptr<const CtView> ct = {};               // that is imported; none: no import
  bool has_midsagittal_plane = false;  // landmarks define one, by which parts can be mirrored
};

/// How one part is drawn.
struct PartView {
  bool shown = true;
  double opacity = 1;  // 0 to 1
  bool operator==(const PartView&) const = default;
};

/// Function of the left button in the picture: turn it, move bodies, set points to measure, place
/// landmarks, or draw a cut.
enum class Tool { look, move, measure, landmarks, cut };

/// A saw cut that is being drawn on a bone: points in order, extruded along a direction into the
/// bone. Points and direction in the cranium's frame, where the bone is at rest.
struct DrawnCut {
  std::optional<std::size_t> part = {};                  // the bone; none before the first point
  std::vector<Eigen::Vector3d> points = {};              // mm
  Eigen::Vector3d direction = Eigen::Vector3d::UnitY();  // of the view at the first point
  double depth_mm = 0;                                   // 0: through the first wall of bone
  double kerf_mm = 0;
  bool operator==(const DrawnCut&) const = default;
};

/// A handle that is being dragged: a point of the drawn cut, or one of the plan's (see PlanHandle).
struct HeldHandle {
  bool is_drawn = false;
  std::size_t index = 0;                         // of its kind
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // as far as it was dragged
  double value = 0;                              // of its number
  bool moved = false;                            // since it was gripped
};

/// Additions to the surfaces in the picture, and their cuts.
struct Look {
  bool clip = false;
  bool clip_skin = false;      // only the face is cut
  char clip_from = 'L';        // removed side: L R A P S I
  double clip_fraction = 0.5;  // of the patient's extent, from that side
  bool cut_away = false;
  enum class Window { left_joint, right_joint, mouth } cut_at = Window::left_joint;
  double cut_radius_mm = 35;
  bool ghost = false;      // of the rest state
  bool wireframe = false;  // of all parts
  bool patches = false;    // only where surfaces touch, of the map of distances
  bool paths = false, axes = false;
  bool springs = false, prisms = false, bone_springs = false;  // of the soft tissue
  bool displacement = false;    // the skin coloured by its displacement from rest
  bool facial_muscles = false;  // of the soft tissue
  bool muscle_labels = true;    // names of the muscles that are shown
  bool scale_bar = true, letters = true;
  bool folds = true;          // of compressed skin, in pictures alone
  bool life = false;          // blinks, gaze, breathing, nodding of the face, in pictures alone
  bool wipe = false;          // the kept state at the left, the present one at the right
  double wipe_at = 0.5;       // fraction of the width
  std::string mirrored = {};  // part whose mirror image is shown; empty: none
  bool operator==(const Look&) const = default;
};

/// Content of the left column.
enum class LeftTab { parts, look };

/// Content of the right column.
enum class SideTab { readings, motion, plan, record, face };

/// Which panels are in use.
struct PanelChoice {
  SideTab tab = SideTab::readings;
  LeftTab left_tab = LeftTab::parts;
  bool plots = false;        // below the picture
  std::size_t plot_set = 0;  // the set shown, if there are so many
  bool operator==(const PanelChoice&) const = default;
};

/// The settings that undo restores: all but the clock, the camera and which panels
/// and tools are in use.
struct Edits {
  bool obey_contact = true;  // false plays the motion through the contact
  bool mark_contacts = true;
  bool shadows = true;
  bool distances = false;                  // colour parts by distance from what they may touch
  std::vector<PinnedPoint> measured = {};  // clicked points, in order
  std::optional<double> opening_mm = {};   // target, instead of the motion's pose
  Hands hands = {};                        // targets of bodies held by hand
  std::vector<Landmark> landmarks = {};    // as edited; initially the scene's
  DrawnCut drawn_cut = {};                 // by the tool for cuts
  MotionChoice motion = {};                // requested; initially the scene's
  std::vector<ExpressionLevel> expression = {};  // of the face, added to the motion's
  Look look = {};
  double skin_opacity = 1;                    // of parts with the role `face`, on top of their own
  std::optional<double> skin_to_return = {};  // its opacity before distances hid it
  std::vector<PartView> parts = {};           // one per part of the scene, in its order
  // The same for muscles and layers of tissue; initially hidden.
  std::vector<PartView> muscles = {}, layers = {};
  bool operator==(const Edits&) const = default;
};

/// The state that the user requests. The loop reads it and responds with a FrameState; nothing
/// here steps the simulation.
struct ViewState : Edits, PanelChoice {
  bool playing = false;
  bool falling = false;  // a released jaw is moving to its target
  bool loop = true;
  double speed = 1;                          // times real time, 0.1 to 2
  double time_s = 0;                         // of the motion, 0 to duration
  Tool tool = Tool::look;                    // function of the left button
  std::size_t chosen = 0;                    // index of the body with handles
  std::optional<std::size_t> landmark = {};  // to be placed by the next click
  std::optional<std::size_t> selected = {};  // part that was clicked
  std::optional<HeldHandle> held_handle = {};

  const Edits& edits() const { return *this; }
  /// Whether the jaw is held by hand instead of following the motion.
  bool jaw_is_held() const { return opening_mm || hands.X_CM_target(); }
  /// Moves a body by hand; the jaw is at X_CM. Moving the jaw or skull ends the motion; a mouth
  /// that the slider held open stays open once the skull is reset.
  void move(const MovableBody& body, const Pose& target, const Pose& X_CM);
  /// After distances are switched off: restores the skin's opacity, unless the user has set it
  /// since.
  void return_skin();
  /// Restores earlier edits; the rest stays, but the clock stops where the jaw is held by hand.
  void set_edits(Edits other);

  /// Whether any face is visible: without one the loop may leave out the face and its tissue.
  bool shows_face(const WindowScene& scene) const;
  /// Whether the soft tissue is moved: its face or what is drawn of it is visible.
  bool simulates_tissue(const WindowScene& scene) const;
  /// Fits the lists to the scene; new entries have their defaults.
  void fit(const WindowScene& scene);
};

/// Opacity of every part by name, hidden ones 0, as a SceneRenderer takes it. With the skin off
/// eyes, gums and tongue are hidden too: bones and teeth remain.
std::map<std::string, double> part_opacities(const WindowScene& scene, const ViewState& view);

/// Performance of the simulation loop. Zero where unknown.
struct LoopStatistics {
  double steps_per_second = 0;  // of the simulation
  std::string message = {};     // one line for the foot of the window; empty for none
};

/// Performance of drawing, measured by the window itself.
struct PictureStatistics {
  double pictures_per_second = 0;
  double picture_ms = 0;  // the 3-D picture alone
  bool finished = false;  // it shows all that is requested, in full quality
  // Longest time between two readings of mouse and keyboard, without waiting for them.
  double longest_away_ms = 0;
  double longest_work_ms = 0;  // longest such time less its time in OpenGL
  double render_scale = 1;     // 1 is full resolution
  int samples = 1;             // of multisampling
};

}  // namespace condyle
