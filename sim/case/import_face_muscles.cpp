#include "sim/case/import_face_muscles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "engine/core/error.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/case/face_muscle_table.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Fibre = std::vector<FaceMusclePoint>;

constexpr double same_end_mm = 0.1, point_every_mm = 6;
/// The insertion pulls the tissue around it; a force on one column would tear it.
constexpr double insertion_spread_mm = 5;
/// mm; an end so near its insertion stays.
constexpr double at_insertion = 2;
/// mm; a fibre that ends farther from its insertion is another patient's, or in another frame.
constexpr double most_led = 30;
/// mm below the skin; what is deeper between the ends of a fibre lies in the mouth or the airway.
constexpr double most_deep_between = 32;
/// mm; farther outside the skin, below it, or from a named bone nothing is a muscle of the face.
constexpr double most_outside = 6, most_below = 60, most_from_bone = 20;

/// Where muscles of the mouth end, from the corner of the mouth on the left side: the modiolus, and
/// the skin of the lips. source: anatomical studies, as the default muscles.
struct Insertion {
  const char* kind;
  Vector3d from_corner;
};
const std::vector<Insertion>& insertions() {
  static const Vector3d modiolus(1.5, 5, 0.5);
  static const std::vector<Insertion> all = {
      {"zygomaticus_major", modiolus},
      {"levator_anguli_oris", modiolus},
      {"risorius", modiolus},
      {"buccinator", modiolus},
      {"depressor_anguli_oris", modiolus},
      {"zygomaticus_minor", {-13.5, -10.4, 7.5}},
      {"levator_labii_superioris", {-12.5, -10.4, 8.5}},
      {"depressor_labii_inferioris", {-15.5, -10.4, -7.5}},
  };
  return all;
}
constexpr double insertion_depth = 0.5;

/// Moves the end to a point, and the rest of the fibre with it, less and less towards its origin.
void lead_to(const Vector3d& end, Fibre& fibre) {
  const Vector3d move = end - fibre.back().at;
  std::vector<double> along = {0};
  for (std::size_t i = 1; i < fibre.size(); ++i)
    along.push_back(along.back() + (fibre[i].at - fibre[i - 1].at).norm());
  for (std::size_t i = 1; i < fibre.size(); ++i) fibre[i].at += along[i] / along.back() * move;
}

std::string place(const Vector3d& p) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", p.x(), p.y(), p.z());
}

/// The bones of one jaw as one surface.
TriangleTree bone_tree(const Case& patient, bool lower) {
  TriMesh all;
  for (const Part& part : patient.parts) {
    const bool upper_bone = part.role == Role::skull || part.role == Role::maxilla;
    if (lower ? part.role != Role::mandible : !upper_bone) continue;
    const int offset = static_cast<int>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
    for (const auto& t : part.mesh.triangles)
      all.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
  }
  return TriangleTree(all);
}

class FaceMuscleImport {
 public:
  FaceMuscleImport(const std::filesystem::path& file, Case& patient)
      : file_(file),
        patient_(patient),
        cranium_(bone_tree(patient, false)),
        mandible_(bone_tree(patient, true)) {
    const Part* face = patient.find(Role::face);
    if (!face) throw InputError(file, "", "the patient has no face for its muscles; add --face");
    skin_.emplace(face->mesh);
  }

  void bones_are_named() { named_ = true; }

  void complete(FaceMuscle& muscle) {
    for (std::size_t i = 0; i < muscle.lines.size(); ++i) {
      Fibre& fibre = muscle.lines[i];
      const std::string item = fmt::format("{}, fibre {}", muscle.name, i + 1);
      const bool closed = (fibre.front().at - fibre.back().at).norm() < same_end_mm;
      if (!named_ && !closed) attach(muscle, fibre, item);
      for (const FaceMusclePoint& point : fibre) check(point, item);
      note_airway(fibre, item);
      divide(fibre);
    }
  }

  void add_notes() const {
    if (!far_.empty())
      patient_.notes.push_back("muscles of the face that begin on no bone that is modelled: " +
                               far_ + "; their origins are fixed to the cranium");
    if (!crossing_.empty())
      patient_.notes.push_back("muscles of the face that pass through bone: " + crossing_);
    if (!deep_.empty())
      patient_.notes.push_back(
          "muscles of the face that pass through the mouth or the airway, below the soft tissue of "
          "the face: " +
          deep_ + "; they pull along its inner side there");
  }

 private:
  /// Origin first, on its bone; the insertion spread, at the modiolus for muscles of the corner.
  void attach(const FaceMuscle& muscle, Fibre& fibre, const std::string& item) {
    const bool left = face_muscle_side(muscle) != "right";
    const auto corner = patient_.landmarks.find(left ? "left_cheilion" : "right_cheilion");
    const auto mouth = patient_.landmarks.find("stomion");
    const auto insertion =
        std::find_if(insertions().begin(), insertions().end(),
                     [&](const Insertion& one) { return muscle.kind == one.kind; });
    std::optional<Vector3d> end;
    if (corner && insertion != insertions().end())
      end = *corner + Vector3d(left ? 1 : -1, 1, 1).cwiseProduct(insertion->from_corner);
    bool turned = false;
    if (muscle.kind == "mentalis")  // from the bone forward
      turned = fibre.front().at.y() < fibre.back().at.y();
    else if (muscle.kind.starts_with("frontalis"))  // down to the brow
      turned = fibre.front().at.z() < fibre.back().at.z();
    else if (pulls_upper_face(muscle.kind))  // from the bone to the skin
      turned =
          cranium_.nearest(fibre.front().at).distance > cranium_.nearest(fibre.back().at).distance;
    else if (const auto& to = end ? end : mouth; to)
      turned = (fibre.front().at - *to).norm() < (fibre.back().at - *to).norm();
    if (turned) std::reverse(fibre.begin(), fibre.end());
    if (end && (fibre.back().at - *end).norm() > most_led)
      throw InputError(file_, item,
                       fmt::format("ends at {}, {:.0f} mm from its insertion at the {} corner of "
                                   "the mouth: check its side, unit (mm), frame and patient",
                                   place(fibre.back().at), (fibre.back().at - *end).norm(),
                                   left ? "left" : "right"));
    if (end && (fibre.back().at - *end).norm() > at_insertion) {
      lead_to(*end, fibre);
      fibre.back().depth = insertion_depth;
    }
    fibre.back().spread_mm = insertion_spread_mm;
    if (muscle.kind != "risorius") fix_origin(fibre, item);  // begins in fascia
    if (muscle.kind == "orbicularis_oculi_superior") {       // from canthus to canthus
      std::reverse(fibre.begin(), fibre.end());
      fix_origin(fibre, item);
    }
    note_crossing(fibre, item);
  }

  void fix_origin(Fibre& fibre, const std::string& item) {
    const Vector3d& origin = fibre.front().at;
    const double upper = cranium_.nearest(origin).distance,
                 lower = mandible_.nearest(origin).distance;
    const bool on_lower = lower < upper && lower < most_from_bone;
    fibre.front().bone = on_lower ? mandible_body : cranium_body;
    if (const double distance = std::min(upper, lower); !on_lower && distance > most_from_bone / 2)
      far_ += fmt::format("{}{} ({:.0f} mm)", far_.empty() ? "" : ", ", item, distance);
  }

  void note_crossing(const Fibre& fibre, const std::string& item) {
    constexpr double deep_mm = 3;
    for (const FaceMusclePoint& point : fibre)
      for (const TriangleTree* bone : {&cranium_, &mandible_}) {
        const double inside = bone->empty() ? 0 : -bone->signed_distance(point.at);
        if (!(inside > deep_mm) || bone->winding_number(point.at) < 0.5) continue;
        crossing_ += fmt::format("{}{} ({:.0f} mm deep at {})", crossing_.empty() ? "" : ", ", item,
                                 inside, place(point.at));
        return;
      }
  }

  void note_airway(const Fibre& fibre, const std::string& item) {
    for (std::size_t i = 1; i + 1 < fibre.size(); ++i)
      if (const double deep = -skin_->signed_distance(fibre[i].at); deep > most_deep_between) {
        deep_ += fmt::format("{}{} ({:.0f} mm deep at {})", deep_.empty() ? "" : ", ", item, deep,
                             place(fibre[i].at));
        return;
      }
  }

  void check(const FaceMusclePoint& point, const std::string& item) const {
    const double from_skin = skin_->signed_distance(point.at);
    if (from_skin > most_outside && !point.bone)
      throw InputError(file_, item,
                       fmt::format("{} lies {:.0f} mm outside the skin: check its unit (mm), frame "
                                   "and patient",
                                   place(point.at), from_skin));
    if (std::abs(from_skin) > most_below)
      throw InputError(file_, item,
                       fmt::format("{} lies {:.0f} mm from the skin: no muscle of the face runs "
                                   "there",
                                   place(point.at), std::abs(from_skin)));
    if (!point.bone) return;
    const TriangleTree& bone = *point.bone == mandible_body ? mandible_ : cranium_;
    if (const double distance = bone.nearest(point.at).distance;
        named_ && distance > most_from_bone)
      throw InputError(
          file_, item,
          fmt::format("{} is on no bone: the nearest of the {} is {:.0f} mm away", place(point.at),
                      *point.bone == mandible_body ? "mandible" : "cranium", distance));
  }

  static void divide(Fibre& fibre) {
    Fibre finer = {fibre.front()};
    for (std::size_t i = 1; i < fibre.size(); ++i) {
      const Vector3d &a = fibre[i - 1].at, &b = fibre[i].at;
      const int count = static_cast<int>(std::ceil((b - a).norm() / point_every_mm));
      for (int k = 1; k < count; ++k)
        finer.push_back({.at = a + (b - a) * k / count, .depth = std::nullopt});
      finer.push_back(fibre[i]);
    }
    fibre = std::move(finer);
  }

  const std::filesystem::path& file_;
  Case& patient_;
  TriangleTree cranium_, mandible_;
  std::optional<TriangleTree> skin_;
  bool named_ = false;
  std::string far_, crossing_, deep_;
};

/// The fibres of one kind on both sides as closed loops, where each end meets another; else empty.
std::vector<Fibre> loops_of(std::vector<Fibre> arcs) {
  std::vector<Fibre> loops;
  const auto meet = [](const FaceMusclePoint& a, const FaceMusclePoint& b) {
    return (a.at - b.at).norm() < same_end_mm;
  };
  while (!arcs.empty()) {
    Fibre loop = std::move(arcs.back());
    arcs.pop_back();
    while (!meet(loop.front(), loop.back())) {
      const auto next = std::find_if(arcs.begin(), arcs.end(), [&](const Fibre& arc) {
        return meet(loop.back(), arc.front()) || meet(loop.back(), arc.back());
      });
      if (next == arcs.end()) return {};
      if (!meet(loop.back(), next->front())) std::reverse(next->begin(), next->end());
      loop.insert(loop.end(), next->begin() + 1, next->end());
      arcs.erase(next);
    }
    loop.back() = loop.front();
    loops.push_back(std::move(loop));
  }
  return loops;
}

/// Joins the muscles of both sides that form loops.
void join_loops(std::vector<FaceMuscle>& muscles) {
  std::map<std::string, std::vector<Fibre>> of_kind;
  for (const FaceMuscle& muscle : muscles)
    for (const Fibre& fibre : muscle.lines) of_kind[muscle.kind].push_back(fibre);
  for (auto& entry : of_kind) {
    const std::string& kind = entry.first;
    auto loops = loops_of(std::move(entry.second));
    if (loops.empty()) continue;
    const auto first = std::find_if(muscles.begin(), muscles.end(),
                                    [&](const FaceMuscle& m) { return m.kind == kind; });
    first->name = kind;
    first->lines = std::move(loops);
    std::erase_if(muscles, [&](const FaceMuscle& m) { return m.kind == kind && m.name != kind; });
  }
}

}  // namespace

void import_face_muscles(const std::filesystem::path& file, const Eigen::Matrix3d& axes_to_lps,
                         Case& patient) {
  FaceMuscleTable table = read_face_muscles(file);
  for (FaceMuscle& muscle : table.muscles)
    for (Fibre& fibre : muscle.lines)
      for (FaceMusclePoint& point : fibre) point.at = axes_to_lps * point.at;
  FaceMuscleImport import(file, patient);
  if (table.has_bodies)
    import.bones_are_named();
  else
    join_loops(table.muscles);
  for (FaceMuscle& muscle : table.muscles) import.complete(muscle);
  import.add_notes();
  if (!table.unused_columns.empty())
    patient.notes.push_back(fmt::format("{}: columns that are not used: {}",
                                        file.filename().string(),
                                        fmt::join(table.unused_columns, ", ")));
  std::size_t fibres = 0;
  for (const FaceMuscle& muscle : table.muscles) fibres += muscle.lines.size();
  patient.notes.push_back(fmt::format("muscles of the face: {} of {} fibres from {}",
                                      table.muscles.size(), fibres, file.filename().string()));
  patient.face_muscles = std::move(table.muscles);
}

}  // namespace condyle
