#include "sim/appliance/guide.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/units.h"
#include "engine/field/isosurface.h"
#include "engine/field/mesh_field.h"
#include "engine/field/smooth.h"
#include "engine/mesh/repair.h"
#include "sim/appliance/grid_frame.h"
#include "sim/appliance/slot_plan.h"
#include "sim/operation/closed_bone.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double guide_rounding_mm = 1.6;
constexpr double least_wall_mm = 1;
// Rounded ends of a wall are thinner than its middle.
constexpr double guide_thin_mm = 1.3, guide_thin_tolerance_mm = 0.12;
constexpr int most_trims = 4;
constexpr double trim_mm = 0.6, more_trim_mm = 0.2;  // beyond half of a thin wall, each time more
constexpr double coarse_mm = 0.4;                    // samples of the outer face and of undercuts
constexpr double guide_margin_mm = 0.8;
constexpr double coarse_error_mm = 0.08;  // of undercuts found by them
constexpr double wrap_mm = 5.5;           // of the shell, below the edge of the cut as it is seated
constexpr float nothing_near = 1;         // value of samples without anything of the guide
constexpr double hole_ring_mm = 1.3;      // of shell around a screw hole
constexpr double teeth_margin_mm = 0.5;
constexpr double tower_end_mm = 2.5;  // of the slot's walls beyond its ends
constexpr double tower_depth_mm = 3;  // of those below the edge of the cut, where bone falls away

double slot_width_mm(const GuideSettings& settings) {
  return settings.saw.blade_mm + 2 * settings.tolerance_mm;
}

void check_guide_settings(const GuideSettings& settings) {
  check_lengths(settings, guide_lengths);
  if (settings.hole_mm > 0 && settings.hole_mm < 1)
    throw InputError(
        fmt::format("hole {} mm: it is 0 for none, or from 1 to 4 mm", settings.hole_mm));
  const double slot = slot_width_mm(settings);
  if (settings.voxel_mm > 0.5 * slot)
    throw InputError(
        fmt::format("voxel {} mm is too coarse for a slot of {:.2f} mm: it is at most {:.2f} mm",
                    settings.voxel_mm, slot, 0.5 * slot));
}

/// The grip, less the error of the coarse samples.
double guide_held_mm(const GuideSettings& settings) {
  return settings.grip_mm - std::min(coarse_error_mm, settings.gap_mm);
}

/// Shell, walls, slots and holes on one grid with z along the withdrawal path.
class GuideField {
 public:
  GuideField(const TriMesh& bone, const SlotPlan& plan, const Matrix3d& R,
             const GuideSettings& settings)
      : settings_(settings), plan_(plan), R_(R), half_slot_(0.5 * slot_width_mm(settings)) {
    for (const Vector3d& p : plan.points) points_.push_back(R * p);
    for (const Vector3d& p : points_) box_.add(p);
    const double around = settings.reach_mm + guide_margin_mm + grid_shift_mm;
    box_.low -= Vector3d::Constant(around);
    // The walls of a slot may lean.
    double top = settings.height_mm + half_slot_ + settings.slot_wall_mm;
    for (const SlotPlan::Bar& bar : plan.bars) top = std::max(top, bar.lift_mm + 3);
    box_.high += Vector3d(around, around, top + guide_margin_mm + grid_shift_mm);
    axes_ = even_grid({box_.low, box_.high}, settings.voxel_mm);
    sample_bone(bone);
    fill();
  }

  /// Keeps away from teeth, and from the path past them.
  void spare(const TriMesh& teeth) {
    if (teeth.empty()) return;
    SampledField field = coarse_field(teeth, teeth_margin_mm + 1);
    sweep(field, Sweep::down, settings_.threads);
    change([&](const Vector3d& p, float& value) {
      if (value < 1)
        value = std::max(value, static_cast<float>(teeth_margin_mm - even_value(field, p)));
    });
  }

  /// Whether the shell surrounds a hole of its bone at a point, all in the cranium's axes.
  bool has_shell(const Vector3d& point, const Vector3d& axis) const {
    const Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
    const double radius = 0.5 * settings_.hole_mm + hole_ring_mm;
    for (int i = 0; i < 12; ++i) {
      const double angle = 30 * i * degree;
      const Vector3d ring = point + radius * (std::cos(angle) * u + std::sin(angle) * v);
      // Bent bone has its shell higher or lower.
      double least = 1;
      for (double height = 0; height <= settings_.shell_mm; height += 0.25)
        least = std::min(least, even_value(field_, R_ * (ring + height * axis)));
      if (least > -0.4) return false;
    }
    return true;
  }

  void drill(const std::vector<ScrewHole>& holes) {
    const Matrix3d back = R_.transpose();
    change([&](const Vector3d& p, float& value) {
      if (value >= 0.5) return;
      const Vector3d q = back * p;
      for (const ScrewHole& hole : holes) {
        const Vector3d d = q - hole.point;
        const double along = d.dot(hole.axis), radius = 0.5 * hole.diameter_mm;
        if (std::abs(along) > settings_.shell_mm + 4) continue;
        value = std::max(value, static_cast<float>(radius - (d - along * hole.axis).norm()));
      }
    });
  }

  void remove_thin_walls() {
    remove_thin(field_, 0.5 * guide_thin_mm, guide_thin_tolerance_mm, settings_.threads);
  }

  /// Takes out walls that are still thin, such as necks between two places where a ball fits.
  /// Returns boxes outside which the guide is as before.
  std::vector<Box> trim(const std::vector<ThinWall>& walls, double trimmed_mm) {
    std::vector<Box> boxes;
    for (const ThinWall& wall : walls) {
      const double radius = 0.5 * wall.thickness_mm + trimmed_mm;
      const Box around = box_about(wall.at, radius + 2);
      take_out_ball(wall.at, radius);
      const auto near = std::find_if(boxes.begin(), boxes.end(),
                                     [&](const Box& box) { return box.contains(wall.at); });
      if (near == boxes.end())
        boxes.push_back(around);
      else
        near->add(around);
    }
    for (const Box& box : boxes)
      remove_thin_within(field_, box, 0.5 * guide_thin_mm, guide_thin_tolerance_mm,
                         settings_.threads);
    return boxes;
  }

  TriMesh surface() const { return isosurface(field_); }

 private:
  /// Coarse samples that reach beyond all of the bone on the withdrawal path.
  SampledField coarse_field(const TriMesh& mesh, double band_mm) const {
    Box box = box_;
    const Box whole = bounding_box(mesh);
    box.high.z() = std::max(box.high.z(), whole.high.z() + coarse_mm);
    return mesh_field(mesh, even_grid({box.low, box.high}, coarse_mm), band_mm, settings_.threads);
  }

  void sample_bone(const TriMesh& bone) {
    const double fine_band = settings_.gap_mm + 0.5 * guide_thin_mm + 2 * settings_.voxel_mm;
    field_ = mesh_field(bone, axes_, fine_band, settings_.threads);
    outer_ = coarse_field(bone, settings_.gap_mm + settings_.shell_mm + 1.5);
    swept_ = outer_;
    // The guide leaves upward: what lies above a sample is on its path.
    sweep(swept_, Sweep::down, settings_.threads);
  }

  static Box box_about(const Vector3d& p, double half) {
    Box box;
    box.add(p - Vector3d::Constant(half));
    box.add(p + Vector3d::Constant(half));
    return box;
  }

  void take_out_ball(const Vector3d& center, double radius) {
    // Values around it become depths below its surface.
    const double reach = radius + 0.5 * guide_thin_mm + settings_.voxel_mm;
    Eigen::Vector3i low, high;
    for (int a = 0; a < 3; ++a) {
      const GridAxis& axis = axes_[static_cast<std::size_t>(a)];
      const auto at = [&](double x) {
        return std::clamp(static_cast<int>(std::lround((x - axis[0]) / settings_.voxel_mm)), 0,
                          static_cast<int>(axis.size()) - 1);
      };
      low[a] = at(center[a] - reach);
      high[a] = at(center[a] + reach);
    }
    for (int i = low.x(); i <= high.x(); ++i)
      for (int j = low.y(); j <= high.y(); ++j)
        for (int k = low.z(); k <= high.z(); ++k) {
          float& value = field_.values[field_.index(i, j, k)];
          const double distance = (field_.position(i, j, k) - center).norm();
          value = std::max(value, static_cast<float>(radius - distance));
        }
  }

  template <class Body>
  void change(const Body& body) {
    for_samples(field_, settings_.threads,
                [&](const Vector3d& p, std::size_t at) { body(p, field_.values[at]); });
  }

  /// Distance from the edge of the shell by the nearest point of the line: beside and below it.
  double beyond_reach(const Vector3d& p) const {
    double least = 1e30, height = 0;
    for (const Vector3d& q : points_)
      if (const double d2 = (q - p).squaredNorm(); d2 < least) {
        least = d2;
        height = q.z();
      }
    return std::max(std::sqrt(least) - settings_.reach_mm, height - wrap_mm - p.z());
  }

  /// Walls that lead the saw, and the slots between them: distances from both.
  struct Lead {
    double walls = 1e9, slots = 1e9;
  };
  Lead lead_at(const Vector3d& p) const {
    Lead lead;
    for (const SlotRun& run : plan_.runs) {
      const double across = std::abs(run.across.dot(p) - run.w0);
      if (across > half_slot_ + settings_.slot_wall_mm + 1) continue;
      const double t = run.along.dot(p);
      if (t < run.t.front() - 4 || t > run.t.back() + 4) continue;
      const double above = run.outward.dot(p) - run.even_surface(t);
      for (const SlotRun::Slot& slot : run.slots) {
        const double beyond =
            std::abs(t - 0.5 * (slot.low + slot.high)) - 0.5 * (slot.high - slot.low);
        const double wall = smooth_max(
            smooth_max(across - half_slot_ - settings_.slot_wall_mm, beyond - tower_end_mm, 1),
            above - settings_.height_mm, 1);
        lead.walls = std::min(lead.walls, std::max(wall, -tower_depth_mm - above));
        lead.slots = std::min(lead.slots,
                              std::max({across - half_slot_, beyond, -settings_.reach_mm - above}));
      }
    }
    return lead;
  }

  /// Bars between parts of the guide, raised from the bone.
  double bar_at(const Vector3d& p) const {
    double least = 1e9;
    const auto capsule = [&](const Vector3d& a, const Vector3d& b, double beyond) {
      const Vector3d ab = b - a;
      const double length = ab.norm();
      const double t = std::clamp((p - a).dot(ab) / length, -beyond, length + beyond);
      least = std::min(least, (p - a - t / length * ab).norm() - SlotPlan::bar_radius_mm);
    };
    for (const SlotPlan::Bar& bar : plan_.bars) {
      const Vector3d a = bar.from + bar.lift_mm * plan_.out, b = bar.to + bar.lift_mm * plan_.out;
      capsule(a, b, 3);  // it reaches into both parts
      capsule(bar.from, a, 0);
      capsule(bar.to, b, 0);
    }
    return least;
  }

  /// Columns of samples in which the guide may lie.
  std::vector<char> columns_near() const {
    const double reach = settings_.reach_mm + guide_margin_mm, step = settings_.voxel_mm;
    const std::size_t rows = axes_[1].size();
    std::vector<char> near(axes_[0].size() * rows, 0);
    const auto mark = [&](const Vector3d& p) {
      const int half = static_cast<int>(reach / step);
      const int x = static_cast<int>((p.x() - axes_[0][0]) / step),
                y = static_cast<int>((p.y() - axes_[1][0]) / step);
      for (int i = std::max(0, x - half); i <= std::min<int>(axes_[0].size() - 1, x + half); ++i)
        for (int j = std::max(0, y - half); j <= std::min<int>(rows - 1, y + half); ++j)
          if ((i - x) * (i - x) + (j - y) * (j - y) <= half * half) near[i * rows + j] = 1;
    };
    for (const Vector3d& p : points_) mark(p);
    for (const SlotPlan::Bar& bar : plan_.bars)
      for (int i = 0; i <= 20; ++i) mark(R_ * (bar.from + 0.05 * i * (bar.to - bar.from)));
    return near;
  }

  void fill() {
    const double gap = settings_.gap_mm, thick = gap + settings_.shell_mm;
    const double held = guide_held_mm(settings_);
    const Matrix3d back = R_.transpose();
    constexpr float skipped = 100;
    const std::vector<char> near = columns_near();
    const std::size_t rows = axes_[1].size();
    parallel_for(axes_[0].size(), settings_.threads, [&](std::size_t i) {
      for (std::size_t j = 0; j < rows; ++j)
        if (!near[i * rows + j])
          std::fill_n(&field_.values[field_.index(static_cast<int>(i), static_cast<int>(j), 0)],
                      axes_[2].size(), skipped);
    });
    change([&](const Vector3d& p, float& value) {
      if (value == skipped) {
        value = nothing_near;
        return;
      }
      const double swept = even_value(swept_, p) + held;
      const double print = gap - value;  // fine distance of the bone
      const double inner = std::max(print, -swept);
      if (inner > 1) {
        value = 1;
        return;
      }
      const double outer = even_value(outer_, p) - thick;
      const Vector3d q = back * p;
      const Lead lead = lead_at(q);
      const double bar = bar_at(q);
      if (outer > 1 && lead.walls > 1 && bar > 1) {
        value = 1;
        return;
      }
      double shell = outer;
      if (outer < 1) shell = smooth_max(outer, beyond_reach(p), guide_rounding_mm);
      const double body = smooth_min(smooth_min(shell, lead.walls, 1), bar, 1);
      value = static_cast<float>(std::min(std::max({body, inner, -lead.slots}), 1.0));
    });
  }

  const GuideSettings& settings_;
  const SlotPlan& plan_;
  Matrix3d R_;
  double half_slot_;
  std::vector<Vector3d> points_;
  Box box_;
  std::array<GridAxis, 3> axes_;
  SampledField field_, outer_, swept_;
};

/// Rays in the cranium's axes on a surface in the axes of the guide.
struct TurnedTree {
  const TriangleTree& tree;
  Matrix3d R;
  std::optional<SurfacePoint> ray_cast(const Vector3d& p, const Vector3d& d, double reach) const {
    return tree.ray_cast(R * p, R * d, reach);
  }
};

constexpr double slot_step_mm = 0.5;

/// What rays across a slot meet on the finished surface.
struct SlotSection {
  double width = 0, wall = 1e9;
  int walls = 0;  // that lead the blade, of two
};
SlotSection section_of(const TurnedTree& tree, const SlotRun& run, const Vector3d& p,
                       double slot_mm) {
  SlotSection section;
  for (const double sense : {1., -1.}) {
    const Vector3d across = sense * run.across;
    const auto hit = tree.ray_cast(p, across, slot_mm);
    if (!hit) continue;
    ++section.walls;
    section.width += hit->distance;
    if (const auto exit = tree.ray_cast(p + (hit->distance + 1e-3) * across, across, 20))
      section.wall = std::min(section.wall, exit->distance);
  }
  return section;
}

/// Widths of a slot and its walls on the finished surface, at two heights.
GuideSlot measure_slot(const TurnedTree& tree, const SlotRun& run, const SlotRun::Slot& slot,
                       const GuideSettings& settings) {
  GuideSlot measured;
  measured.from = run.point(slot.low);
  measured.to = run.point(slot.high);
  measured.length_mm = slot.high - slot.low;
  measured.width_min_mm = measured.wall_min_mm = 1e9;
  const int count = std::max(1, static_cast<int>(std::lround(measured.length_mm / slot_step_mm)));
  const double step = measured.length_mm / count;
  for (int i = 0; i < count; ++i) {
    const double t = slot.low + (i + 0.5) * step;
    int walls = 2;
    for (const double height : {0.5 * settings.height_mm, 0.7 * settings.height_mm}) {
      const SlotSection section =
          section_of(tree, run, run.point(t) + height * run.outward, slot_width_mm(settings));
      walls = std::min(walls, section.walls);
      // The rounded ends of a slot are no width.
      if (section.walls < 2 || t < slot.low + 0.75 || t > slot.high - 0.75) continue;
      measured.width_min_mm = std::min(measured.width_min_mm, section.width);
      measured.width_max_mm = std::max(measured.width_max_mm, section.width);
      measured.wall_min_mm = std::min(measured.wall_min_mm, section.wall);
    }
    if (walls == 2) {
      measured.guided_mm += step;
      continue;
    }
    const Vector3d from = run.point(t - 0.5 * step), to = run.point(t + 0.5 * step);
    if (auto& gaps = measured.gaps; !gaps.empty() && gaps.back().both == (walls == 0) &&
                                    (gaps.back().to - from).norm() < 0.1 * step) {
      gaps.back().to = to;
      gaps.back().length_mm += step;
    } else {
      gaps.push_back({from, to, step, walls == 0});
    }
  }
  if (measured.width_max_mm == 0) measured.width_min_mm = measured.wall_min_mm = 0;
  return measured;
}

void measure_hole(const TurnedTree& tree, const GuideSettings& settings, ScrewHole& hole) {
  const Vector3d p = hole.point + (settings.gap_mm + 0.5 * settings.shell_mm) * hole.axis;
  const Vector3d u = hole.axis.unitOrthogonal(), v = hole.axis.cross(u);
  double least = 1e9;
  for (const Vector3d& d : {u, v, Vector3d((u + v).normalized()), Vector3d((u - v).normalized())}) {
    const auto one = tree.ray_cast(p, d, 5), two = tree.ray_cast(p, -d, 5);
    if (one && two) least = std::min(least, one->distance + two->distance);
  }
  hole.diameter_mm = least < 1e9 ? least : 0;
}

/// What a guide is made of: surfaces in the cranium's axes, and the bone in those of the grid.
struct GuideParts {
  const GuideSupport& support;
  const CutLine& line;
  const GuideSettings& settings;
  const TriangleTree& bone_tree;
  Matrix3d R;
  TriMesh bone;
};

/// A surface in the axes of its grid.
struct GuideSurface {
  TriMesh mesh;
  std::optional<TriangleTree> tree;
  std::vector<ScrewHole> holes;
  std::vector<std::string> notes;
};

constexpr double around_trimmed_mm = 1, beside_trimmed_mm = 2.5;

bool is_in_any(const std::vector<Box>& boxes, const Vector3d& p, double margin_mm) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
    return ((box.low.array() - margin_mm) < p.array()).all() &&
           (p.array() < (box.high.array() + margin_mm)).all();
  });
}

/// The thin walls in and about the boxes alone.
std::vector<ThinWall> thin_walls_within(const TriMesh& mesh, const std::vector<Box>& boxes,
                                        int threads) {
  // The surface ends outside the boxes, where its normals are wrong.
  TriMesh near{mesh.vertices, {}, {}};
  for (const Eigen::Vector3i& t : mesh.triangles)
    if (is_in_any(boxes, mesh.vertices[static_cast<std::size_t>(t[0])], beside_trimmed_mm))
      near.triangles.push_back(t);
  drop_unreferenced(near);
  if (near.empty()) return {};
  std::vector<ThinWall> walls = find_thin_walls(near, TriangleTree(near), least_wall_mm, threads);
  std::erase_if(
      walls, [&](const ThinWall& wall) { return !is_in_any(boxes, wall.at, around_trimmed_mm); });
  return walls;
}

GuideSurface form_guide(const GuideParts& parts, const SlotPlan& plan) {
  const GuideSettings& settings = parts.settings;
  GuideSurface made;
  GuideField field(parts.bone, plan, parts.R, settings);
  field.spare(in_axes(parts.support.teeth, parts.R));
  made.holes = plan_holes(
      parts.support, parts.bone_tree, plan, settings,
      [&](const Vector3d& p, const Vector3d& axis) { return field.has_shell(p, axis); },
      made.notes);
  field.drill(made.holes);
  field.remove_thin_walls();
  std::vector<Box> trimmed;
  for (int trims = 0;; ++trims) {
    made.mesh = field.surface();
    const double dropped_mm3 = keep_one_piece(made.mesh);
    if (made.mesh.empty()) throw InputError("no guide fits on the bone beside " + parts.line.title);
    std::vector<ThinWall> thin;
    if (trims > 0) thin = thin_walls_within(made.mesh, trimmed, settings.threads);
    if (thin.empty()) {  // by the whole surface
      made.tree.emplace(made.mesh);
      thin = find_thin_walls(made.mesh, *made.tree, least_wall_mm, settings.threads);
    }
    if (thin.empty()) {
      if (dropped_mm3 > crumb_mm3)
        made.notes.push_back(fmt::format(
            "a part of {:.0f} mm³ that is not connected to the guide is left out", dropped_mm3));
      return made;
    }
    if (trims == most_trims) {
      const Vector3d at = parts.R.transpose() * thin.front().at;
      throw InputError(fmt::format(
          "the guide for {} has a wall of {:.2f} mm at ({:.0f}, {:.0f}, {:.0f}), less than the "
          "{:g} "
          "mm that it needs: another --from, less --reach or a thicker --shell may avoid it",
          parts.line.title, thin.front().thickness_mm, at.x(), at.y(), at.z(), least_wall_mm));
    }
    trimmed = field.trim(thin, trim_mm + trims * more_trim_mm);
  }
}

/// Widths of all slots. Returns whether each has walls somewhere.
bool measure_slots(const TurnedTree& tree, const SlotPlan& plan, const GuideSettings& settings,
                   Guide& guide) {
  guide.slots.clear();
  guide.guided_mm = 0;
  bool all = true;
  for (const SlotRun& run : plan.runs)
    for (const SlotRun::Slot& slot : run.slots) {
      guide.slots.push_back(measure_slot(tree, run, slot, settings));
      guide.guided_mm += guide.slots.back().guided_mm;
      all = all && guide.slots.back().width_max_mm > 0;
    }
  return all;
}

}  // namespace

Guide make_guide(const GuideSupport& support, const CutLine& line, const GuideSettings& settings,
                 const Progress& progress) {
  check_guide_settings(settings);
  report(progress, "finding the slots", 0);
  Guide guide;
  guide.on = support.name;
  guide.bones = line.bones;
  guide.slot_mm = slot_width_mm(settings);
  const TriangleTree bone_tree(support.bone);
  SlotPlan plan = plan_slots(bone_tree, support.frame, line, settings);
  guide.bone_mm = plan.bone_mm;
  guide.line_mm = plan.line_mm;
  guide.led_mm = plan.led_mm;

  report(progress, "forming the guide", 0.2);
  const Matrix3d R = axes_along(plan.out);
  const GuideParts parts{support, line, settings, bone_tree, R, in_axes(support.bone, R)};
  GuideSurface made = form_guide(parts, plan);
  bool leads = measure_slots({*made.tree, R}, plan, settings, guide);
  if (!leads && join_with_bars(plan, bone_tree)) {
    made = form_guide(parts, plan);
    leads = measure_slots({*made.tree, R}, plan, settings, guide);
  }
  if (!leads)
    throw InputError(fmt::format(
        "the parts of a guide for {} are not connected on this side: make one for each side "
        "(--side left, --side right), or choose --from",
        line.title));

  report(progress, "measuring the guide", 0.7);
  guide.measure = measure_in_axes(made.mesh, *made.tree, R,
                                  {{parts.bone,
                                    {.on = support.name,
                                     .seat = -Vector3d::UnitZ(),
                                     .gap_mm = settings.gap_mm,
                                     .held_mm = guide_held_mm(settings),
                                     .thin_mm = guide_thin_mm}}},
                                  settings.threads);
  check_withdrawal(guide.measure, settings.grip_mm, "guide");
  guide.holes = std::move(made.holes);
  guide.notes = std::move(made.notes);
  for (ScrewHole& hole : guide.holes) measure_hole({*made.tree, R}, settings, hole);
  if (std::erase_if(guide.holes, [](const ScrewHole& hole) { return hole.diameter_mm == 0; }) > 0)
    guide.notes.push_back("screw holes that the guide does not surround are left out");
  guide.mesh = in_axes(std::move(made.mesh), R.transpose());
  return guide;
}

GuideSupport guide_support(const Case& patient, const Plan& plan, const CutLine& line,
                           std::vector<std::string>& notes) {
  GuideSupport support;
  support.name = line.bone;
  BodyId body = cranium_body;
  for (const Part& part : patient.parts)
    if (part.name == line.bone) {
      ClosedBone closed = closed_bone(part);
      support.bone = std::move(closed.mesh);
      notes.insert(notes.end(), closed.notes.begin(), closed.notes.end());
      support.dangers = danger_zones(patient, part, true);
      body = part.body;
    }
  if (support.bone.empty())
    throw InputError(fmt::format("{} is not a bone of the case", line.bone));
  try {
    support.frame = clinical_frame(patient.landmarks, plan.reference);
  } catch (const InputError& error) {
    notes.push_back(fmt::format("left and right by the axes of the case: {}", error.what()));
  }
  for (const PlanZone& zone : plan.zones) support.dangers.push_back(own_zone(zone));
  for (const Part& part : patient.parts) {
    if (!is_teeth(part.role) || part.body != body) continue;
    append(support.teeth, closed_bone(part).mesh);
  }
  return support;
}

}  // namespace condyle
