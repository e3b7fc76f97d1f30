// Cuts that are drawn by hand, previews of cuts, and their handles.
#include "sim/session/cut_preview.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/osteotomy/osteotomy.h"
#include "sim/phantom/phantom.h"
#include "sim/session/drawn_cut.h"
#include "sim/session/plan_editing.h"
#include "sim/session/session_patient.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::shared_ptr<const Case> uncut() {
  static const auto patient = std::make_shared<const Case>(builtin_patient());
  return patient;
}

Plan plan_with(const PlanAction& action) { return with_step(empty_plan(*uncut()), action); }

CutStep genioplasty() { return {.osteotomy = "genioplasty", .pieces = {"chin"}}; }

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// A line across the chin, drawn from the front.
plan_edit::DrawCut across_the_chin(const Vector3d& shift = Vector3d::Zero()) {
  const Vector3d pogonion = *uncut()->landmarks.find("pogonion") + shift;
  plan_edit::DrawCut drawing;
  drawing.part = "mandible";
  drawing.points = {pogonion + Vector3d(-60, -4, 2), pogonion + Vector3d(60, -4, 2)};
  drawing.direction = Vector3d::UnitY();
  return drawing;
}

TEST(CutPreview, ShowsTheCutThatThePlanMakes) {
  const Plan plan = plan_with(genioplasty());
  CutPreviewer previewer(uncut());
  const CutPreview preview = previewer.preview(plan, 1);
  EXPECT_EQ(preview.words.problem, "");
  EXPECT_EQ(preview.body, "mandible");
  const Operated made = apply_plan(*uncut(), plan);
  ASSERT_EQ(preview.pieces.size(), made.cuts[0].pieces.size());
  for (std::size_t i = 0; i < preview.pieces.size(); ++i) {
    EXPECT_EQ(preview.pieces[i].name, made.cuts[0].pieces[i].body);
    EXPECT_EQ(signed_volume(preview.pieces[i].mesh), made.cuts[0].pieces[i].volume_mm3);
    EXPECT_GT(preview.pieces[i].rims.size(), 20u);
  }
  const auto start = std::chrono::steady_clock::now();
  constexpr int repeats = 5;
  for (int i = 0; i < repeats; ++i) previewer.preview(plan, 1);
  std::printf("preview of a genioplasty: %.0f ms\n", milliseconds_since(start) / repeats);
}

TEST(CutPreview, NamesWhatIsWrong) {
  // Through the roots of the incisors.
  plan_edit::DrawCut drawing = across_the_chin({0, 0, 14});
  const CutStep cut = drawn_cut(apply_plan(*uncut(), empty_plan(*uncut())), drawing);
  const CutPreview roots = CutPreviewer(uncut()).preview(plan_with(cut), 1);
  EXPECT_TRUE(roots.words.warns || !roots.words.problem.empty());
  drawing.depth_mm = 3;
  const CutStep shallow = drawn_cut(apply_plan(*uncut(), empty_plan(*uncut())), drawing);
  const CutPreview ends = CutPreviewer(uncut()).preview(plan_with(shallow), 1);
  EXPECT_TRUE(ends.words.problem.find("does not separate") != std::string::npos)
      << ends.words.problem;
  EXPECT_TRUE(ends.words.warns);
}

/// Distance of a point from the rims of a preview.
double from_rims(const CutPreview& preview, const Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& piece : preview.pieces)
    for (const Vector3d& q : piece.rims) least = std::min(least, (p - q).norm());
  return least;
}

TEST(CutPreview, AHandleGoesWithItsCutFace) {
  CutPreviewer previewer(uncut());
  std::string body;
  const auto handles = previewer.number_handles(plan_with(genioplasty()), 1, body);
  EXPECT_EQ(body, "mandible");
  const auto height = std::find_if(handles.begin(), handles.end(), [](const PlanHandle& handle) {
    return handle.number == "height_mm";
  });
  ASSERT_NE(height, handles.end());
  EXPECT_GT(height->per_unit.z(), 0.5) << "a higher cut lies farther up";
  for (const PlanHandle& handle : handles) {
    EXPECT_GT(handle.per_unit.norm(), 0.2) << handle.number;
    std::printf("%s: at %.1f %.1f %.1f, %.2f %.2f %.2f per unit from %.1f\n", handle.number.c_str(),
                handle.at.x(), handle.at.y(), handle.at.z(), handle.per_unit.x(),
                handle.per_unit.y(), handle.per_unit.z(), handle.value);
  }
  // The cut faces of a cut 3 mm lower pass through the moved handle.
  CutStep lower = genioplasty();
  for (const OsteotomyParameter& parameter : osteotomy_parameters("genioplasty"))
    if (parameter.name == "height_mm") {
      EXPECT_LE(height->value, parameter.standard + 1e-9) << "roots and foramina hold it down";
      EXPECT_GT(height->value, parameter.standard - 3);
      lower.parameters["height_mm"] = height->value - 3;
    }
  const CutPreview moved = previewer.preview(plan_with(lower), 1);
  const Vector3d there = height->at - 3 * height->per_unit;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& piece : moved.pieces)
    nearest = std::min(nearest, TriangleTree(piece.mesh).nearest(there).distance);
  EXPECT_LT(nearest, 0.5);
  EXPECT_LT(from_rims(moved, there), 25);
}

/// Distance of a point from the nearest plane of a bent sheet.
double from_sheet(const PlacedOsteotomy& placed, const Vector3d& at, bool split) {
  double least = std::numeric_limits<double>::infinity();
  for (const Cut& cut : placed.cuts)
    for (const Region::Leaf& leaf : cut.above.leaves())
      if (split ? leaf.wall >= 1 && leaf.wall < 8 : leaf.wall >= 0)
        least = std::min(least, std::abs(leaf.plane.distance(at)));
  return least;
}

TEST(CutPreview, BendsAndStationsHaveHandlesOnTheCut) {
  for (const char* osteotomy : {"genioplasty", "sagittal_split"}) {
    CutStep cut = genioplasty();
    cut.osteotomy = osteotomy;
    cut.pieces = {};
    cut.parameters = {};
    const bool split = cut.osteotomy == "sagittal_split";
    const auto stations = place_osteotomy(*uncut(), cut).stations;
    EXPECT_EQ(stations.size(), split ? 6u : 4u);
    CutPreviewer previewer(uncut());
    std::string body;
    const auto handles = previewer.number_handles(plan_with(cut), 1, body);
    for (const CutStation& station : stations) {
      const auto handle = std::find_if(handles.begin(), handles.end(), [&](const PlanHandle& each) {
        return each.number == station.parameter;
      });
      ASSERT_NE(handle, handles.end()) << station.parameter;
      EXPECT_EQ(handle->at, station.at);
      EXPECT_EQ(handle->per_unit, station.per_unit);
      const double most = split ? 4 : 12;
      for (const double change : {-most, -2.0, 0.0, 2.0, most}) {
        cut.parameters = {{station.parameter, change}};
        const PlacedOsteotomy moved = place_osteotomy(*uncut(), cut);
        const Vector3d there = station.at + change * station.per_unit;
        EXPECT_LT(from_sheet(moved, there, split), 1e-6) << station.parameter << " " << change;
        if (split && change != 0) {
          EXPECT_GT(from_sheet(moved, station.at, split), 0.2) << station.parameter;
        }
        for (const CutStation& now : moved.stations)
          if (now.parameter == station.parameter) {
            EXPECT_LT((now.at - there).norm(), 1e-6);
          }
      }
    }
    cut.parameters = {{split ? "left_ramus_mm" : "left_bend_mm", 3}};
    const CutPreview changed = previewer.preview(plan_with(cut), 1);
    EXPECT_EQ(changed.words.problem, "") << osteotomy;
    EXPECT_EQ(changed.pieces.size(), split ? 3u : 2u);
  }
}

TEST(DrawnCut, PartsTheSmallerPieceWhicheverWayItIsDrawn) {
  const Operated before = apply_plan(*uncut(), empty_plan(*uncut()));
  plan_edit::DrawCut drawing = across_the_chin();
  for (int turn = 0; turn < 2; ++turn) {
    const CutStep cut = drawn_cut(before, drawing);
    EXPECT_EQ(cut.target, "mandible");
    EXPECT_EQ(cut.pieces, std::vector<std::string>{"segment_1"});
    const Operated made = apply_plan(*uncut(), plan_with(cut));
    EXPECT_TRUE(made.problems.empty()) << made.problems.front();
    const auto& pieces = made.cuts.at(0).pieces;
    ASSERT_EQ(pieces.size(), 2u);
    EXPECT_TRUE(pieces[0].stays);
    EXPECT_EQ(pieces[1].body, "segment_1");
    EXPECT_LT(pieces[1].volume_mm3, pieces[0].volume_mm3);
    EXPECT_GT(pieces[1].volume_mm3, 1000);
    EXPECT_TRUE(made.cuts[0].outcomes[0].through);
    std::reverse(drawing.points.begin(), drawing.points.end());
  }
}

TEST(DrawnCut, IsPlacedWhereAMovedSegmentIsShown) {
  Plan plan = plan_with(genioplasty());
  plan = with_step(plan, MoveStep{"chin", ClinicalMove{.forward_mm = 5}});
  const Operated shown = apply_plan(*uncut(), plan);
  const auto chin = shown.patient.bodies.find("chin");
  ASSERT_TRUE(chin);
  const Vector3d menton = *uncut()->landmarks.find("menton");
  plan_edit::DrawCut drawing;
  for (const Part& part : shown.patient.parts)
    if (part.body == *chin && collides(part.role)) drawing.part = part.name;
  // Sagittal, from below, in the middle of the chin as it is shown.
  for (const double y : {-15., 25.})
    drawing.points.push_back(shown.poses[*chin] * (menton + Vector3d(0, y, -2)));
  drawing.direction = Vector3d::UnitZ();
  const CutStep cut = drawn_cut(shown, drawing);
  EXPECT_EQ(cut.target, "chin");
  for (const Vector3d& p : std::get<BentSheet>(cut.surfaces[0]).polyline)
    EXPECT_NEAR(p.x(), menton.x(), 1e-9) << "at the uncut rest";
  const Operated made = apply_plan(*uncut(), with_step(plan, cut));
  ASSERT_EQ(made.cuts.size(), 2u);
  ASSERT_EQ(made.cuts[1].pieces.size(), 2u);
  EXPECT_GT(made.cuts[1].pieces[1].volume_mm3, 0.3 * made.cuts[1].pieces[0].volume_mm3);

  // A point of it, dragged on the screen.
  const auto handles = point_handles(made, cut);
  ASSERT_EQ(handles.size(), 2u);
  const Vector3d to = handles[0].at + Vector3d(3, 0, 0);
  const CutStep changed = with_point(made, cut, {.step = 3, .surface = 0, .point = 0, .at = to});
  EXPECT_NEAR((point_handles(made, changed)[0].at - to).norm(), 0, 1e-9);
  EXPECT_THROW(with_point(made, cut, {.step = 3, .surface = 0, .point = 2, .at = to}), InputError);
  EXPECT_THROW(with_point(made, cut, {.step = 3, .surface = 1, .point = 0, .at = to}), InputError);
}

TEST(DrawnCut, IsRefusedWhereItMakesNoSheet) {
  const Operated before = apply_plan(*uncut(), empty_plan(*uncut()));
  plan_edit::DrawCut drawing = across_the_chin();
  drawing.points.resize(1);
  EXPECT_THROW(drawn_cut(before, drawing), InputError);
  drawing = across_the_chin();
  drawing.part = "rib";
  EXPECT_THROW(drawn_cut(before, drawing), InputError);
  drawing = across_the_chin();
  drawing.direction = Vector3d::UnitX();  // along the line
  EXPECT_THROW(drawn_cut(before, drawing), InputError);
  drawing = across_the_chin();
  drawing.points[1] = drawing.points[0];
  EXPECT_THROW(drawn_cut(before, drawing), InputError);
}

TEST(DrawnCut, IsAnEditOfThePlanWithItsOwnNumbers) {
  PlanDocument document(empty_plan(*uncut()));
  const auto make = [&](const PlanEdit& edit) {
    EditedPlan edited =
        edited_plan(*uncut(), document.plan(), apply_plan(*uncut(), document.plan()), edit);
    document.edit(std::move(edited.plan), edited.what);
  };
  make(across_the_chin());
  make(plan_edit::SetNumber{1, "kerf_mm", 0.6});
  make(plan_edit::SetNumber{1, "depth_mm", 45});
  const auto& cut = std::get<CutStep>(document.plan().steps[0].action);
  EXPECT_EQ(cut.kerf_mm, 0.6);
  EXPECT_EQ(std::get<BentSheet>(cut.surfaces[0]).depth_mm, 45);
  const PlanView view = plan_view(document, apply_plan(*uncut(), document.plan()), {});
  EXPECT_EQ(view.steps[0].title, "Cut of mandible");
  ASSERT_EQ(view.steps[0].numbers.size(), 2u);
  EXPECT_EQ(view.undo, "edit step 1 (cut mandible)") << view.undo;
}

}  // namespace
}  // namespace condyle
