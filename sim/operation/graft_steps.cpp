#include "sim/operation/graft_steps.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/collide/solid.h"
#include "engine/core/error.h"
#include "engine/core/infinity.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/case/edit_bodies.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const Resection* resection_of(const Operated& operated, const std::string& segment) {
  for (const Resection& resection : operated.resections)
    if (resection.segment == segment) return &resection;
  return nullptr;
}

bool is_host(const Operated& operated, const Part& part, const Resection& resection) {
  const auto origin = operated.origin.find(part.name);
  return collides(part.role) && !is_teeth(part.role) && origin != operated.origin.end() &&
         origin->second.part == resection.origin.part;
}

double kerf_of(const Plan& plan, int id) {
  for (const PlanStep& step : plan.steps)
    if (step.id == id)
      if (const auto* cut = std::get_if<CutStep>(&step.action)) return cut->kerf_mm;
  return 0;
}

Vector3d up_of(const Operated& operated, const Plan& plan) {
  try {
    return clinical_frame(operated.patient.landmarks, plan.reference).up;
  } catch (const InputError&) {
    return Vector3d::UnitZ();  // LPS
  }
}

/// The bone nearest to a face of the defect.
const Part& host_at(const Operated& operated, const Resection& resection, const Vector3d& point) {
  const Part* host = nullptr;
  double least = infinity;
  for (const Part& part : operated.patient.parts) {
    if (!is_host(operated, part, resection)) continue;
    const double distance = TriangleTree(part.mesh).nearest(point).distance;
    if (distance < least) {
      least = distance;
      host = &part;
    }
  }
  if (!host)
    throw InputError(
        fmt::format("nothing is left of the bone from which {} was resected", resection.segment));
  return *host;
}

void add_pieces(Operated& operated, const PlanStep& step, const GraftLayout& graft,
                const Resection& resection) {
  Case& patient = operated.patient;
  const BodyId host = host_at(operated, resection, graft.defect.faces[0].point).body;
  std::vector<std::string> touching;
  for (const Part& part : patient.parts)
    if (is_host(operated, part, resection)) touching.push_back(part.name);
  BodyId parent = host;
  for (const GraftPiece& piece : graft.pieces) {
    if (std::any_of(patient.parts.begin(), patient.parts.end(),
                    [&](const Part& part) { return part.name == piece.body; }))
      throw InputError(fmt::format("the patient already has a part \"{}\"", piece.body));
    const BodyId body =
        patient.bodies.add({.name = piece.body, .parent = parent, .driver = BodyDriver::plan});
    if (parent == host) parent = body;
    patient.parts.push_back({piece.body, Role::transplant, piece.mesh, {}, body});
    SurfaceOrigin origin{.part = graft.step.name, .triangle = {}, .made_by = {}};
    for (const int wall : piece.wall) {
      origin.triangle.push_back(-1);
      origin.made_by.push_back(wall < 0 ? 0 : step.id);
    }
    operated.origin[piece.body] = std::move(origin);
    for (const std::string& other : touching)
      patient.pair_rules.push_back({piece.body, other, PairPolicy::cut_face, std::nullopt, 0});
    touching.push_back(piece.body);
  }
}

/// Gums over resected bone and teeth leave with them: triangles that lie nearer to these than to
/// what stays with the body.
void trim_gums(Case& patient, BodyId body, Resection& resection) {
  const auto nearest = [](const std::vector<TriangleTree>& trees, const Vector3d& p) {
    double least = infinity;
    for (const TriangleTree& tree : trees) least = std::min(least, tree.nearest(p, least).distance);
    return least;
  };
  std::vector<TriangleTree> gone, staying;
  for (const Part& part : resection.parts)
    if (collides(part.role)) gone.emplace_back(part.mesh);
  for (const Part& part : patient.parts)
    if (part.body == body && collides(part.role)) staying.emplace_back(part.mesh);
  for (Part& gums : patient.parts) {
    if (gums.body != body || (gums.role != Role::upper_gums && gums.role != Role::lower_gums))
      continue;
    const auto goes = [&](const Eigen::Vector3i& t) {
      const auto& v = gums.mesh.vertices;
      const Vector3d middle = (v[t[0]] + v[t[1]] + v[t[2]]) / 3;
      return nearest(gone, middle) < nearest(staying, middle);
    };
    Part removed = gums;
    removed.name += "_" + resection.segment;
    auto& triangles = removed.mesh.triangles;
    const auto stays = std::stable_partition(triangles.begin(), triangles.end(), goes);
    if (stays == triangles.begin() || stays == triangles.end()) continue;  // a part has a surface
    gums.mesh.triangles.assign(stays, triangles.end());
    triangles.erase(stays, triangles.end());
    drop_unreferenced(gums.mesh);
    drop_unreferenced(removed.mesh);
    resection.parts.push_back(std::move(removed));
  }
}

/// A surface with its pose.
struct PosedTree {
  TriangleTree tree;
  Pose X_CS;
};

/// Distance from a point of a face along its normal to the nearest of several surfaces.
std::optional<double> gap_along(const std::vector<PosedTree>& others, const Vector3d& p,
                                const Vector3d& normal) {
  constexpr double behind_mm = 1;  // overlaps up to this depth are found
  std::optional<double> least;
  for (const PosedTree& other : others) {
    const Pose X_SC = other.X_CS.inverse();
    const auto hit = other.tree.ray_cast(X_SC * Vector3d(p - behind_mm * normal), X_SC.R * normal,
                                         face_reach_mm + behind_mm);
    if (hit && (!least || hit->distance - behind_mm < *least)) least = hit->distance - behind_mm;
  }
  return least;
}

const Part& part_called(const Operated& operated, const std::string& name) {
  return *std::find_if(operated.patient.parts.begin(), operated.patient.parts.end(),
                       [&](const Part& part) { return part.name == name; });
}

double face_area(const GraftPiece& piece, int face) {
  TriMesh faces{piece.mesh.vertices, {}, {}};
  for (std::size_t t = 0; t < piece.mesh.triangles.size(); ++t)
    if (piece.wall[t] == face) faces.triangles.push_back(piece.mesh.triangles[t]);
  return surface_area(faces);
}

GraftFaceReport::Level level_of(const FaceContact& contact) {
  using Level = GraftFaceReport::Level;
  if (contact.facing_share == 0) return Level::open;
  if (contact.mean_gap_mm > very_wide_gap_mm) return Level::very_wide;
  return contact.mean_gap_mm > wide_gap_mm ? Level::wide : Level::good;
}

std::string tilt_words(const DonorCut& cut) {
  const auto side = [](const char* name, double degrees) {
    return fmt::format("{} side {:.1f}° {}", name, std::abs(degrees),
                       degrees >= 0 ? "ahead" : "behind");
  };
  return fmt::format("at {:.1f} mm, {:.1f}° off square ({}, {})", cut.place_mm, cut.angle_deg,
                     side("outer", cut.outward_deg), side("upper", cut.up_deg));
}

std::string face_words(const GraftFaceReport& face) {
  using Level = GraftFaceReport::Level;
  const std::string where =
      fmt::format("{}, {} face, to {}", face.piece, face.face == 0 ? "first" : "last", face.other);
  if (face.level == Level::open)
    return fmt::format("{}: no bone within {:g} mm: not united", where, face_reach_mm);
  std::string words = fmt::format(
      "{}: contact over {:.0f} % of the smaller face, gap {:.2f} mm on average, {:.2f} mm at most",
      where, 100 * face.share, face.contact.mean_gap_mm, face.contact.largest_gap_mm);
  if (face.level == Level::very_wide)
    words += fmt::format("; above {:g} mm bone is not expected to unite", very_wide_gap_mm);
  if (face.level == Level::wide)
    words += fmt::format("; above {:g} mm union is at risk", wide_gap_mm);
  return words;
}

}  // namespace

void resect_segment(Operated& operated, const PlanStep& step) {
  const std::string& name = std::get<ResectStep>(step.action).segment;
  Case& patient = operated.patient;
  const auto body = patient.bodies.find(name);
  if (!body) {
    operated.problems.push_back(
        fmt::format("{}: \"{}\" does not exist, so it is not resected", step_name(step), name));
    return;
  }
  Resection resection{.step = step.id, .segment = name};
  for (const Part& part : patient.parts) {
    if (part.body != *body) continue;
    resection.parts.push_back(part);
    for (const Tooth& tooth : part.teeth) resection.teeth.push_back(tooth.fdi);
    const auto origin = operated.origin.find(part.name);
    if (origin == operated.origin.end()) continue;
    resection.bone = part.mesh;
    resection.volume_mm3 = signed_volume(part.mesh);
    resection.origin = std::move(origin->second);
    operated.origin.erase(origin);
  }
  std::sort(resection.teeth.begin(), resection.teeth.end());
  const std::string parent = patient.bodies[patient.bodies[*body].parent].name;
  try {
    patient = without_body(std::move(patient), *body);
  } catch (const InputError& error) {
    throw InputError(step_name(step) + ": " + error.what());
  }
  trim_gums(patient, *patient.bodies.find(parent), resection);
  operated.resections.push_back(std::move(resection));
}

void place_graft(Operated& operated, const Plan& plan, const PlanStep& step) {
  const auto& graft = std::get<GraftStep>(step.action);
  const Resection* resection = resection_of(operated, graft.replaces);
  if (!resection || resection->bone.empty()) {
    operated.problems.push_back(fmt::format("{}: \"{}\" was not resected, so nothing is grafted",
                                            step_name(step), graft.replaces));
    return;
  }
  try {
    Box jaw = bounding_box(resection->bone);
    for (const Part& part : operated.patient.parts)
      if (is_host(operated, part, *resection)) jaw.add(bounding_box(part.mesh));
    const Defect defect = find_defect(
        resection->bone, resection->origin.made_by, [&](int id) { return kerf_of(plan, id); },
        up_of(operated, plan), jaw.center());
    GraftLayout layout = lay_graft(graft, resection->bone, defect);
    add_pieces(operated, step, layout, *resection);
    operated.grafts.push_back(std::move(layout));
  } catch (const InputError& error) {
    throw InputError(step_name(step) + ": " + error.what());
  }
}

std::vector<GraftFaceReport> graft_faces(const Operated& operated, const GraftLayout& graft) {
  const Case& patient = operated.patient;
  const Resection& resection = *resection_of(operated, graft.step.replaces);
  std::vector<PosedTree> hosts;
  for (const Part& part : patient.parts)
    if (is_host(operated, part, resection))
      hosts.push_back({TriangleTree(part.mesh), operated.poses[part.body]});
  const auto pose = [&](const GraftPiece& piece) {
    return operated.poses[part_called(operated, piece.body).body];
  };
  const auto measured = [&](const GraftPiece& piece, int face, const std::string& other,
                            double other_area, const std::vector<PosedTree>& others) {
    const Pose X = pose(piece);
    const Vector3d normal = X.R * piece.faces[face].normal;
    GraftFaceReport report{.piece = piece.body, .other = other, .face = face};
    report.contact =
        face_contact(piece.mesh, piece.wall, face, piece.faces[face],
                     [&](const Vector3d& p) { return gap_along(others, X * p, normal); });
    const double smaller = std::min(report.contact.area_mm2, other_area);
    report.share = smaller > 0 ? std::min(1., report.contact.contact_mm2 / smaller) : 0;
    report.level = level_of(report.contact);
    return report;
  };
  const auto host_name = [&](int face) {
    const Part& part = host_at(operated, resection, graft.defect.faces[face].point);
    return patient.bodies[part.body].name;
  };
  std::vector<GraftFaceReport> faces;
  faces.push_back(
      measured(graft.pieces.front(), 0, host_name(0), graft.defect.faces[0].area_mm2, hosts));
  for (std::size_t i = 0; i + 1 < graft.pieces.size(); ++i) {
    const GraftPiece& next = graft.pieces[i + 1];
    faces.push_back(measured(graft.pieces[i], 1, next.body, face_area(next, 0),
                             {{TriangleTree(next.mesh), pose(next)}}));
  }
  faces.push_back(
      measured(graft.pieces.back(), 1, host_name(1), graft.defect.faces[1].area_mm2, hosts));
  return faces;
}

std::vector<std::string> graft_overlaps(const Operated& operated, const GraftLayout& graft) {
  constexpr double least_mm = 0.1;
  const Case& patient = operated.patient;
  std::vector<std::string> texts;
  const auto is_graft = [&](const Part& part) {
    return std::any_of(graft.pieces.begin(), graft.pieces.end(),
                       [&](const GraftPiece& piece) { return piece.body == part.name; });
  };
  for (const Part& a : patient.parts) {
    if (!is_graft(a)) continue;
    const Pose& X_CA = operated.poses[a.body];
    Box box;
    for (const Vector3d& v : a.mesh.vertices) box.add(X_CA * v);
    std::optional<Solid> solid;
    for (const Part& b : patient.parts) {
      if (!collides(b.role) || b.mesh.empty() || is_graft(b)) continue;
      const Pose& X_CB = operated.poses[b.body];
      Box other;
      for (const Vector3d& v : b.mesh.vertices) other.add(X_CB * v);
      if ((box.low.array() > other.high.array()).any() ||
          (other.low.array() > box.high.array()).any())
        continue;
      if (!solid) solid.emplace(a.mesh);
      const OverlapDepth found =
          overlap_depth(*solid, X_CA, Solid(b.mesh), X_CB, {.tolerance_mm = 0.01});
      if (found.depth_mm >= least_mm)
        texts.push_back(
            fmt::format("{} and {} overlap by {:.1f} mm", a.name, b.name, found.depth_mm));
    }
  }
  return texts;
}

std::string resection_sentence(const Resection& resection) {
  return fmt::format("resected: {}, {:.1f} cm³{}", resection.segment, resection.volume_mm3 / 1000,
                     resection.teeth.empty()
                         ? ""
                         : fmt::format(", with teeth {}", fmt::join(resection.teeth, ", ")));
}

std::vector<std::string> graft_sentences(const Operated& operated, const GraftLayout& graft) {
  std::vector<std::string> sentences;
  sentences.push_back(fmt::format(
      "{} from {:.1f} to {:.1f} mm of its length; the axis lies within "
      "{:.1f} mm of its curve",
      donor_label(graft.step), graft.donor_from_mm, graft.donor_to_mm, graft.curve_deviation_mm));
  for (std::size_t i = 0; i < graft.pieces.size(); ++i) {
    const GraftPiece& piece = graft.pieces[i];
    sentences.push_back(fmt::format("{}: {:.1f} mm long, {:.1f} cm³; saw cuts {}, and {}",
                                    piece.body, piece.length_mm, piece.volume_mm3 / 1000,
                                    tilt_words(piece.cuts[0]), tilt_words(piece.cuts[1])));
    if (i < graft.spacing_mm.size())
      sentences.push_back(fmt::format("{:.2f} mm beyond the kerf between {} and {} on the donor",
                                      graft.spacing_mm[i], piece.body, graft.pieces[i + 1].body));
  }
  for (const GraftFaceReport& face : graft_faces(operated, graft))
    sentences.push_back(face_words(face));
  for (const std::string& overlap : graft_overlaps(operated, graft)) sentences.push_back(overlap);
  for (const std::string& warning : graft.warnings) sentences.push_back("warning: " + warning);
  return sentences;
}

}  // namespace condyle
