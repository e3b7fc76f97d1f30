#include "sim/report/motion_plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "sim/report/bite_position.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Axes of the clinical views. Sagittal: anterior to the right; frontal and horizontal: the
/// patient's left to the right, as the axis label says.
double anterior(const Vector3d& d) { return -d.y(); }
double superior(const Vector3d& d) { return d.z(); }
double to_left(const Vector3d& d) { return d.x(); }

using Coordinate = double (*)(const Vector3d&);

Curve path(const char* name, const std::vector<Vector3d>& points, const Vector3d& rest,
           Coordinate across, Coordinate up) {
  Curve curve{name, {}, {}};
  for (const auto& p : points) {
    curve.x.push_back(across(p - rest));
    curve.y.push_back(up(p - rest));
  }
  return curve;
}

std::vector<Vector3d> points_of(const MotionSeries& series, Vector3d Measures::*point) {
  std::vector<Vector3d> points;
  for (const auto& m : series.measures) points.push_back(m.*point);
  return points;
}

PlotBand box(const char* name, double x0, double x1, double y0, double y1) {
  return {name, {x0, x1, x1, x0}, {y0, y0, y1, y1}};
}

/// The border movements, where the motion has them, as a closed dashed line.
void add_border(std::vector<Curve>& curves, std::vector<Vector3d> round, const Vector3d& rest,
                Coordinate across, Coordinate up) {
  if (round.empty()) return;
  round.push_back(round.front());
  Curve border = path("border movements", round, rest, across, up);
  border.dashed = true;
  border.colour = 1;
  curves.push_back(std::move(border));
}

MotionPlot posselt(const MotionSeries& series) {
  const auto incisor = points_of(series, &Measures::incisor);
  const Vector3d rest = bite_position(series);
  const auto panel = [&](const char* title, const char* x, const char* y, Coordinate across,
                         Coordinate up, const std::vector<Vector3d>& border,
                         std::vector<PlotBand> bands) {
    PlotPanel made{{path("lower incisal point", incisor, rest, across, up)},
                   {.title = title,
                    .x_label = x,
                    .y_label = y,
                    .equal_scale = true,
                    .bands = std::move(bands)}};
    add_border(made.curves, border, rest, across, up);
    return made;
  };
  std::vector<Vector3d> all = series.borders.sagittal;
  all.insert(all.end(), series.borders.frontal.begin(), series.borders.frontal.end());
  return {"posselt",
          {panel("Posselt, sagittal", "posterior  -  mm from the bite  -  anterior",
                 "inferior  -  mm  -  superior", anterior, superior, series.borders.sagittal,
                 {box("end of hinge", -15, -9, -21, -16),
                  box("maximum opening", -27, -19, -48, -44), box("protrusion", 6, 11, -3, 3)}),
           panel("Posselt, frontal", "patient's right  -  mm from the bite  -  left",
                 "inferior  -  mm  -  superior", to_left, superior, series.borders.frontal,
                 {box("right", -12, -7, -12, 0), box("left", 7, 12, -12, 0),
                  box("maximum opening", -2, 2, -48, -44)}),
           panel("Posselt, horizontal", "patient's right  -  mm from the bite  -  left",
                 "posterior  -  mm  -  anterior", to_left, anterior, all,
                 {box("right", -12, -7, -6, 2), box("left", 7, 12, -6, 2),
                  box("protrusion", -1, 1, 6, 11)})}};
}

/// Normal inclination over the first 5 mm, 26 to 62 degrees, as a wedge.
PlotBand inclination_wedge() {
  constexpr double secant_mm = 5, slope_low = 0.48773, slope_high = 1.88073;  // tan 26, 62 deg
  return {"26 to 62\u00b0 over 5 mm",
          {0, secant_mm, secant_mm},
          {0, -secant_mm * slope_low, -secant_mm * slope_high}};
}

/// Medial displacement of an orbiting condyle for Bennett angles of 5 to 15 degrees.
PlotBand bennett_wedge(double side) {
  constexpr double forward_mm = 10, low = 0.08749, high = 0.26795;
  return {side > 0 ? "Bennett 5 to 15\u00b0" : "",
          {0, -side * forward_mm * low, -side * forward_mm * high},
          {0, forward_mm, forward_mm}};
}

MotionPlot axiography(const MotionSeries& series) {
  const auto left = points_of(series, &Measures::left_condyle);
  const auto right = points_of(series, &Measures::right_condyle);
  const auto panel = [&](const char* title, const char* x, const char* y, Coordinate across,
                         Coordinate up, std::vector<PlotBand> bands) {
    return PlotPanel{{path("left condyle", left, series.rest.left_condyle, across, up),
                      path("right condyle", right, series.rest.right_condyle, across, up)},
                     {.title = title,
                      .x_label = x,
                      .y_label = y,
                      .equal_scale = true,
                      .bands = std::move(bands)}};
  };
  return {"axiography",
          {panel("Axiography, sagittal", "posterior  -  mm from rest  -  anterior",
                 "inferior  -  mm  -  superior", anterior, superior, {inclination_wedge()}),
           panel("Axiography, horizontal", "patient's right  -  mm from rest  -  left",
                 "posterior  -  mm  -  anterior", to_left, anterior,
                 {bennett_wedge(1), bennett_wedge(-1)}),
           panel("Axiography, frontal", "patient's right  -  mm from rest  -  left",
                 "inferior  -  mm  -  superior", to_left, superior, {})}};
}

Curve over_time(const char* name, const MotionSeries& series,
                const std::function<double(std::size_t)>& value) {
  Curve curve{name, series.time_s, {}};
  for (std::size_t i = 0; i < series.size(); ++i) curve.y.push_back(value(i));
  return curve;
}

double largest(const Curve& curve) {
  double most = 0;
  for (const double y : curve.y) most = std::max(most, std::abs(y));
  return most;
}

/// Adds a reference band only if the motion comes near it: chewing is not compared with full
/// opening.
void add_if_reached(PlotPanel& panel, double reached, double from, PlotBand band) {
  if (reached >= from) panel.settings.bands.push_back(std::move(band));
}

MotionPlot opening(const MotionSeries& series) {
  const auto of = [&](double Measures::*value) {
    return [&series, value](std::size_t i) { return series.measures[i].*value; };
  };
  PlotPanel down{{over_time("vertical displacement of the lower incisal point", series,
                            of(&Measures::opening_mm)),
                  over_time("interincisal distance", series, of(&Measures::interincisal_mm))},
                 {.title = "Opening over time", .x_label = "time, s", .y_label = "mm"}};
  add_if_reached(down, largest(down.curves[1]), 30,
                 {"maximum interincisal distance: 42 to 58 mm", {}, {42, 58}});
  PlotPanel aside{
      {over_time("protrusion (anterior)", series, of(&Measures::protrusion_mm)),
       over_time("laterotrusion (to the left)", series, of(&Measures::laterotrusion_mm)),
       over_time("midline deviation", series, of(&Measures::midline_deviation_mm))},
      {.title = "Excursions of the incisal point over time",
       .x_label = "time, s",
       .y_label = "mm"}};
  const double reached = largest(aside.curves[1]);
  add_if_reached(aside, reached, 5, {"laterotrusion left 7 to 12 mm", {}, {7, 12}});
  add_if_reached(aside, reached, 5, {"laterotrusion right 7 to 12 mm", {}, {-12, -7}});
  return {"opening", {std::move(down), std::move(aside)}};
}

MotionPlot rotation(const MotionSeries& series) {
  PlotPanel turn{{over_time("rotation", series,
                            [&](std::size_t i) { return series.measures[i].rotation_deg; })},
                 {.title = "Rotation over time", .x_label = "time, s", .y_label = "\u00b0"}};
  add_if_reached(turn, largest(turn.curves[0]), 22,
                 {"at max. opening 28 to 45\u00b0", {}, {28, 45}});
  PlotPanel travel{
      {over_time("left condyle", series,
                 [&](std::size_t i) { return series.measures[i].left_condyle_travel_mm; }),
       over_time("right condyle", series,
                 [&](std::size_t i) { return series.measures[i].right_condyle_travel_mm; })},
      {.title = "Condylar displacement over time", .x_label = "time, s", .y_label = "mm"}};
  add_if_reached(travel, largest(travel.curves[0]), 9,
                 {"at max. opening 10 to 20 mm", {}, {10, 20}});
  PlotPanel speed{{over_time("incisal point", series,
                             [&](std::size_t i) { return series.incisor_speed_mm_s(i); })},
                  {.title = "Speed over time", .x_label = "time, s", .y_label = "mm/s"}};
  const bool chews = std::any_of(series.phases.begin(), series.phases.end(), [](const auto& phase) {
    return phase.name.starts_with("chewing");
  });
  if (chews)
    speed.settings.bands.push_back({"middle third of chewing 40 to 80 mm/s", {}, {40, 80}});
  return {"rotation", {std::move(turn), std::move(travel), std::move(speed)}};
}

/// Muscles by side: "lat" is the left one of "lat" and "rat"; unpaired muscles come last.
std::array<std::vector<std::size_t>, 3> muscles_by_side(const std::vector<std::string>& names) {
  std::array<std::vector<std::size_t>, 3> sides;
  const auto has_twin = [&](const std::string& name, char other) {
    return std::find(names.begin(), names.end(), other + name.substr(1)) != names.end();
  };
  for (std::size_t m = 0; m < names.size(); ++m) {
    const char first = names[m].empty() ? ' ' : names[m][0];
    if (first == 'l' && has_twin(names[m], 'r'))
      sides[0].push_back(m);
    else if (first == 'r' && has_twin(names[m], 'l'))
      sides[1].push_back(m);
    else
      sides[2].push_back(m);
  }
  return sides;
}

/// A value of the muscles over time: one panel per side with the muscles of largest values.
MotionPlot muscles(const MotionSeries& series, const char* file, const std::string& what,
                   const char* y_label, double MuscleState::*value) {
  constexpr std::size_t max_curves = 8;
  constexpr double min_fraction = 0.02;  // of the largest value
  const auto peak = [&](std::size_t m) {
    double most = 0;
    for (const auto& states : series.muscles) most = std::max(most, states[m].*value);
    return most;
  };
  std::vector<double> peaks;
  for (std::size_t m = 0; m < series.muscle_names.size(); ++m) peaks.push_back(peak(m));
  const double least = min_fraction * *std::max_element(peaks.begin(), peaks.end());
  MotionPlot plot{file, {}};
  const std::array<const char*, 3> titles = {", left", ", right", ", unpaired"};
  auto sides = muscles_by_side(series.muscle_names);
  for (std::size_t side = 0; side < sides.size(); ++side) {
    auto& shown = sides[side];
    if (side == 2 && shown.empty()) continue;
    std::stable_sort(shown.begin(), shown.end(),
                     [&](std::size_t a, std::size_t b) { return peaks[a] > peaks[b]; });
    if (shown.size() > max_curves) shown.resize(max_curves);
    PlotPanel panel{{},
                    {.title = what + titles[side],
                     .x_label = "time, s",
                     .y_label = y_label,
                     .legend_beside = true}};
    constexpr std::size_t colours = 6;  // the colours repeat after six
    for (const std::size_t m : shown) {
      if (!(peaks[m] >= least && peaks[m] > 0)) continue;
      panel.curves.push_back(over_time(series.muscle_names[m].c_str(), series,
                                       [&](std::size_t i) { return series.muscles[i][m].*value; }));
      panel.curves.back().dashed = panel.curves.size() > colours;
    }
    if (panel.curves.empty()) panel.curves.push_back({"none", {0, 1}, {0, 0}});
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

}  // namespace

std::vector<MotionPlot> motion_plots(const MotionSeries& series) {
  std::vector<MotionPlot> plots = {posselt(series), axiography(series), opening(series),
                                   rotation(series)};
  if (!series.muscles.empty()) {
    plots.push_back(muscles(series, "muscle_activity", "Muscle activity", "activation, 0 to 1",
                            &MuscleState::activation));
    plots.push_back(muscles(series, "muscle_force", "Muscle force", "N", &MuscleState::force_N));
  }
  return plots;
}

}  // namespace condyle
