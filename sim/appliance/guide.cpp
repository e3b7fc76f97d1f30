#include "sim/appliance/guide.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/units.h"
#include "engine/field/isosurface.h"
#include "engine/field/mesh_field.h"
#include "engine/field/smooth.h"
#include "sim/appliance/slot_plan.h"
#include "sim/operation/closed_bone.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double guide_rounding_mm = 1.6;
constexpr double crumb_mm3 = 20;  // a loose part that is smaller is left out without a note
constexpr double guide_thin_mm = 1, guide_thin_tolerance_mm = 0.12;
constexpr double coarse_mm = 0.4;  // samples of the outer face and of undercuts
constexpr double guide_margin_mm = 0.8;
constexpr double coarse_error_mm = 0.08;  // of undercuts found by them
constexpr double wrap_mm = 5.5;           // of the shell, below the edge of the cut as it is seated
constexpr float nothing_near = 1;         // value of samples without anything of the guide
constexpr double hole_ring_mm = 1.3;      // of shell around a screw hole
constexpr double teeth_margin_mm = 0.5;
constexpr double tower_end_mm = 2.5;  // of the slot's walls beyond its ends
constexpr double tower_depth_mm = 3;  // of those below the edge of the cut, where bone falls away

void check_guide_settings(const GuideSettings& settings) {
  check_voxel(settings.voxel_mm);
  const auto check = [](const char* name, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw InputError(fmt::format("{} {} mm: it is from {} to {} mm", name, value, low, high));
  };
  check("tolerance", settings.tolerance_mm, 0, 1);
  check("reach", settings.reach_mm, 6, 25);
  check("shell", settings.shell_mm, 1.2, 6);
  check("height", settings.height_mm, 2, 20);
  check("slot wall", settings.slot_wall_mm, 1.2, 5);
  if (settings.hole_mm != 0) check("hole", settings.hole_mm, 1, 4);
  check("gap", settings.gap_mm, 0, 0.5);
  check("grip", settings.grip_mm, 0, 1);
  const double slot = settings.saw.blade_mm + 2 * settings.tolerance_mm;
  if (settings.voxel_mm > 0.5 * slot)
    throw InputError(
        fmt::format("voxel {} mm is too coarse for a slot of {:.2f} mm: it is at most {:.2f} mm",
                    settings.voxel_mm, slot, 0.5 * slot));
}

Matrix3d view_axes(const Vector3d& out) {
  const Vector3d x = std::abs(out.x()) < 0.8 ? Vector3d::UnitX() : Vector3d::UnitY();
  Matrix3d R;
  R.row(2) = out.transpose();
  R.row(0) = (x - x.dot(out) * out).normalized().transpose();
  R.row(1) = R.row(2).cross(R.row(0));
  return R;
}

TriMesh in_view(TriMesh mesh, const Matrix3d& R) {
  for (Vector3d& p : mesh.vertices) p = R * p;
  mesh.colors.clear();
  return mesh;
}

/// Shell, walls, slots and holes on one grid with z along the withdrawal path.
class GuideField {
 public:
  GuideField(const TriMesh& bone, const SlotPlan& plan, const Matrix3d& R,
             const GuideSettings& settings)
      : settings_(settings), plan_(plan), R_(R), half_slot_(0.5 * slot_mm()) {
    for (const Vector3d& p : plan.points) points_.push_back(R * p);
    for (const Vector3d& p : points_) box_.add(p);
    constexpr double shift = 0.0137;  // not on planes of symmetry
    const double around = settings.reach_mm + guide_margin_mm + shift;
    box_.low -= Vector3d::Constant(around);
    // The walls of a slot may lean.
    double top = settings.height_mm + half_slot_ + settings.slot_wall_mm;
    for (const SlotPlan::Bar& bar : plan.bars) top = std::max(top, bar.lift_mm + 3);
    box_.high += Vector3d(around, around, top + guide_margin_mm + shift);
    axes_ = even_grid({box_.low, box_.high}, settings.voxel_mm);
    sample_bone(bone);
    fill();
  }

  /// Keeps away from teeth, and from the path past them.
  void spare(const TriMesh& teeth) {
    if (teeth.empty()) return;
    SampledField field = coarse_field(teeth, teeth_margin_mm + 1);
    sweep(field, Sweep::down, settings_.threads);
    for_samples([&](const Vector3d& p, float& value) {
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
    for_samples([&](const Vector3d& p, float& value) {
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

  TriMesh surface() {
    remove_thin(field_, 0.5 * guide_thin_mm, guide_thin_tolerance_mm, settings_.threads);
    return isosurface(field_);
  }

 private:
  double slot_mm() const { return settings_.saw.blade_mm + 2 * settings_.tolerance_mm; }

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

  template <class Body>
  void for_samples(const Body& body) {
    parallel_for(axes_[0].size(), settings_.threads, [&](std::size_t layer) {
      const int i = static_cast<int>(layer);
      for (int j = 0; j < static_cast<int>(axes_[1].size()); ++j)
        for (int k = 0; k < static_cast<int>(axes_[2].size()); ++k)
          body(field_.position(i, j, k), field_.values[field_.index(i, j, k)]);
    });
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
    const double relief_error = std::min(coarse_error_mm, gap);
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
    for_samples([&](const Vector3d& p, float& value) {
      if (value == skipped) {
        value = nothing_near;
        return;
      }
      const double swept = even_value(swept_, p) + settings_.grip_mm - relief_error;
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

/// Widths of a slot and its walls on the finished surface, at several heights.
GuideSlot measure_slot(const TurnedTree& tree, const SlotPlan& plan, const SlotRun& run,
                       const SlotRun::Slot& slot, const GuideSettings& settings) {
  // Where slots of two walls meet there is no width.
  const auto meets_other = [&](const Vector3d& p) {
    for (const SlotRun& other : plan.runs)
      for (const SlotRun::Slot& each : other.slots)
        if (&other != &run && std::abs(other.across.dot(p) - other.w0) < 1.5 &&
            other.along.dot(p) > each.low - 1 && other.along.dot(p) < each.high + 1)
          return true;
    return false;
  };
  GuideSlot measured{run.point(slot.low), run.point(slot.high), slot.high - slot.low, 1e9, 0, 1e9};
  for (double t = slot.low + 0.75; t < slot.high - 0.7; t += 0.5)
    for (const double height : {0.5 * settings.height_mm, 0.7 * settings.height_mm}) {
      const Vector3d p = run.point(t) + height * run.outward;
      if (meets_other(p)) continue;
      const auto one = tree.ray_cast(p, run.across, 5), two = tree.ray_cast(p, -run.across, 5);
      if (!one || !two) continue;
      const double width = one->distance + two->distance;
      if (width > 5) continue;
      measured.width_min_mm = std::min(measured.width_min_mm, width);
      measured.width_max_mm = std::max(measured.width_max_mm, width);
      for (const double sense : {1., -1.}) {
        const Vector3d in = sense * run.across;
        const double at = (sense > 0 ? one : two)->distance + 1e-3;
        if (const auto exit = tree.ray_cast(p + at * in, in, 20))
          measured.wall_min_mm = std::min(measured.wall_min_mm, exit->distance);
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

}  // namespace

Guide make_guide(const GuideSupport& support, const CutLine& line, const GuideSettings& settings,
                 const Progress& progress) {
  check_guide_settings(settings);
  report(progress, "finding the slots", 0);
  Guide guide;
  guide.on = support.name;
  guide.slot_mm = settings.saw.blade_mm + 2 * settings.tolerance_mm;
  const TriangleTree bone_tree(support.bone);
  const SlotPlan plan = plan_slots(bone_tree, line, settings);
  guide.bone_mm = plan.bone_mm;
  guide.line_mm = plan.line_mm;
  guide.led_mm = plan.led_mm;

  report(progress, "forming the guide", 0.2);
  const Matrix3d R = view_axes(plan.out);
  const TriMesh bone = in_view(support.bone, R);
  GuideField field(bone, plan, R, settings);
  field.spare(in_view(support.teeth, R));
  guide.holes = plan_holes(
      support, bone_tree, plan, settings,
      [&](const Vector3d& p, const Vector3d& axis) { return field.has_shell(p, axis); },
      guide.notes);
  field.drill(guide.holes);
  TriMesh mesh = field.surface();
  const double dropped_mm3 = keep_one_piece(mesh);
  if (mesh.empty()) throw InputError("no guide fits on the bone beside " + line.title);
  if (dropped_mm3 > crumb_mm3)
    guide.notes.push_back(fmt::format(
        "a part of {:.0f} mm³ that is not connected to the guide is left out", dropped_mm3));

  report(progress, "measuring the guide", 0.7);
  const TriangleTree tree(mesh);
  guide.measure = measure_appliance(mesh, tree, settings.threads);
  guide.measure.wall_at = R.transpose() * guide.measure.wall_at;
  PrintMeasure print = measure_print(mesh, tree, bone,
                                     {.on = support.name,
                                      .seat = -Vector3d::UnitZ(),
                                      .gap_mm = settings.gap_mm,
                                      .grip_mm = settings.grip_mm,
                                      .thin_mm = guide_thin_mm},
                                     settings.threads);
  print.seat = -plan.out;
  guide.measure.prints.push_back(std::move(print));
  guide.mesh = in_view(std::move(mesh), R.transpose());
  for (const SlotRun& run : plan.runs)
    for (const SlotRun::Slot& slot : run.slots)
      guide.slots.push_back(measure_slot({tree, R}, plan, run, slot, settings));
  for (const GuideSlot& slot : guide.slots)
    if (slot.width_max_mm == 0)
      throw InputError(fmt::format(
          "the parts of a guide for {} are not connected on this side: make one for each side "
          "(--side left, --side right), or choose --from",
          line.title));
  for (ScrewHole& hole : guide.holes) measure_hole({tree, R}, settings, hole);
  if (std::erase_if(guide.holes, [](const ScrewHole& hole) { return hole.diameter_mm == 0; }) > 0)
    guide.notes.push_back("screw holes that the guide does not surround are left out");
  return guide;
}

GuideSupport guide_support(const Case& patient, const Plan& plan, const CutLine& line,
                           std::vector<std::string>& notes) {
  GuideSupport support{line.bone, {}, {}, {}};
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
  for (const PlanZone& zone : plan.zones) support.dangers.push_back(own_zone(zone));
  for (const Part& part : patient.parts) {
    if (!is_teeth(part.role) || part.body != body) continue;
    const TriMesh teeth = closed_bone(part).mesh;
    const int first = static_cast<int>(support.teeth.vertices.size());
    support.teeth.vertices.insert(support.teeth.vertices.end(), teeth.vertices.begin(),
                                  teeth.vertices.end());
    for (const auto& t : teeth.triangles)
      support.teeth.triangles.emplace_back(t.x() + first, t.y() + first, t.z() + first);
  }
  return support;
}

}  // namespace condyle
