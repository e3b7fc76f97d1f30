#include "sim/report/motion_findings.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/units.h"
#include "sim/motion/joint_surfaces.h"
#include "sim/report/bite_position.h"
#include "sim/report/motion_extremes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Collects the findings of one motion.
class MotionAssessment {
 public:
  MotionAssessment(const Scene& scene, const Motion& motion, const MotionSeries& series)
      : scene_(scene),
        motion_(motion),
        series_(series),
        bite_(bite_position(series)),
        joint_(JointSurfaces::find(scene.patient)) {}

  std::vector<Finding> all() {
    if (!series_.known_landmarks || series_.size() < 2) return {};
    opening();
    if (too_coarse(series_)) return std::move(found_);
    for (const auto& phase : series_.phases) {
      if (phase.name == "protrusion") protrusion(phase);
      if (phase.name.starts_with("laterotrusion")) laterotrusion(phase);
      if (phase.name == "posterior border") posterior_border(phase);
      if (phase.name == "protruded contact") protruded_contact(phase);
      if (phase.name == "left border" || phase.name == "right border") lateral_border(phase);
      if (phase.name.starts_with("chewing")) chewing(phase);
      if (phase.name == "rest position") rest_position(phase);
    }
    if (!series_.borders.frontal.empty())
      add({"area of the frontal border", "mm2", frontal_area(series_.borders.frontal), 1, 0, ""});
    inclination(JawSide::left);
    inclination(JawSide::right);
    disc_gaps();
    return std::move(found_);
  }

 private:
  void add(Finding finding) { found_.push_back(std::move(finding)); }
  /// Whether the target values of the motion were prescribed; those of a recording were not.
  bool built_in() const { return !motion_.recorded; }
  const Measures& at(std::size_t frame) const { return series_.measures[frame]; }

  /// Whether the fossa of a side ("left", "right") guides its condyle, not a path that was given or
  /// assumed. Condyles placed as in an articulator have no fossae.
  bool on_fossa(const std::string& side) const {
    return joint_ &&
           std::none_of(motion_.inputs.begin(), motion_.inputs.end(), [&](const auto& in) {
             return in.name == "inclination_" + side || in.name == "bonwill" ||
                    in.name == "balkwill";
           });
  }

  /// Position of the incisal point forward of and above the bite, mm.
  double anterior(std::size_t frame) const { return bite_.y() - at(frame).incisor.y(); }
  double superior(std::size_t frame) const { return at(frame).incisor.z() - bite_.z(); }

  std::size_t frame_of_largest(std::size_t first, std::size_t last, double Measures::*value) const {
    std::size_t best = first;
    for (std::size_t i = first; i <= last; ++i)
      if (at(i).*value > at(best).*value) best = i;
    return best;
  }

  /// Path length of a condyle from the first frame to the last, mm.
  double curve_mm(std::size_t first, std::size_t last, Vector3d Measures::*condyle) const {
    double length = 0;
    for (std::size_t i = first + 1; i <= last; ++i)
      length += (at(i).*condyle - at(i - 1).*condyle).norm();
    return length;
  }

  void opening() {
    const auto widest = frame_of_largest(0, series_.size() - 1, &Measures::opening_mm);
    constexpr double wide_mm = 35;  // smaller openings are not maximal
    if (at(widest).opening_mm < wide_mm) return;
    const std::string why =
        fmt::format("{:.1f} mm of opening require {:.1f} deg here: condyle to incisor is {:.0f} mm",
                    at(widest).opening_mm, at(widest).rotation_deg,
                    (series_.rest.incisor - series_.rest.left_condyle).norm());
    add({"maximum opening", "mm", (at(widest).incisor - bite_).norm(), 42, 58,
         "51.2 (Woelfel), 48.8 (Zawawi 2003)", built_in(), why});
    add({"rotation at maximum opening", "deg", at(widest).rotation_deg, 28, 45,
         "39.1 +- 5.9 men, 36.3 +- 4.3 women (Muto 1996), 34.1 (Leader 2003)", false, why});
    const std::string travel = "11.9 straight, 14 along the curve (Travers), 18 to 20.5 (Muto)";
    add({"left condylar travel at maximum opening", "mm", at(widest).left_condyle_travel_mm, 10, 20,
         travel, false, why});
    add({"right condylar travel at maximum opening", "mm", at(widest).right_condyle_travel_mm, 10,
         20, travel, false, why});
    if (!too_coarse(series_)) {  // too few frames to measure the length of a curve
      std::size_t start = widest;
      while (start > 0 && at(start).opening_mm > 0.02) --start;
      add({"left condylar travel along its curve", "mm",
           curve_mm(start, widest, &Measures::left_condyle), 10, 24, travel, false, why});
    }
    const double before = at(widest).rotation_deg;
    // Two condyles on the same path open straight in any anatomy.
    add({"midline deviation at maximum opening", "mm",
         std::abs(at(widest).midline_deviation_mm - series_.rest.midline_deviation_mm), 0, 2,
         "under 2 in healthy adults", built_in() && !(on_fossa("left") && on_fossa("right")),
         fmt::format("the condyles travel {:.1f} mm left and {:.1f} mm right ({:.0f} deg)",
                     at(widest).left_condyle_travel_mm, at(widest).right_condyle_travel_mm,
                     before)});
  }

  void protrusion(const MotionPhase& phase) {
    const auto [first, last] = series_.frames_of(phase);
    const auto end = frame_of_largest(first, last, &Measures::protrusion_mm);
    add({"protrusion", "mm", anterior(end), 6, 11, "8.0 (Woelfel), 8.8 +- 2.3", built_in(),
         "its end is prescribed"});
    tooth_path(first, end, "protrusion");
  }

  /// The dip over the incisal edges, and the slope towards it.
  void tooth_path(std::size_t first, std::size_t end, const std::string& what) {
    const auto low = std::min(first, end), high = std::max(first, end);
    const auto dip = frame_of_largest(low, high, &Measures::opening_mm);
    add({"dip of the incisal point in " + what, "mm", -superior(dip), 0.5, 6,
         "an edge-to-edge dip of about the overbite (Posselt)", false,
         "determined by the overbite"});
    // First frame 2 mm in front of the bite.
    std::optional<std::size_t> frame;
    for (auto i = low; i <= high; ++i)
      if (anterior(i) >= 2 && (!frame || anterior(i) < anterior(*frame))) frame = i;
    if (frame)
      add({"incisal guidance over 2 mm of " + what, "deg",
           std::atan2(-superior(*frame), anterior(*frame)) * degrees_per_radian, 20, 70,
           "an incisal table is set to 20 to 70", false, "determined by overjet and overbite"});
  }

  void laterotrusion(const MotionPhase& phase) {
    const auto [first, last] = series_.frames_of(phase);
    const bool to_left = phase.name.ends_with("left");
    std::size_t end = first;
    for (auto i = first; i <= last; ++i)
      if (std::abs(at(i).laterotrusion_mm) > std::abs(at(end).laterotrusion_mm)) end = i;
    add({phase.name, "mm", std::abs(at(end).laterotrusion_mm), 7, 12,
         "9.2 right, 9.4 left (Woelfel)", built_in(),
         "its end is prescribed, or is where bone meets bone"});
    lateral_joints(end, to_left, phase.name);
  }

  void lateral_joints(std::size_t end, bool to_left, const std::string& what) {
    const Measures& m = at(end);
    const Vector3d working = to_left ? Vector3d(m.left_condyle - series_.rest.left_condyle)
                                     : Vector3d(m.right_condyle - series_.rest.right_condyle);
    const Vector3d orbiting = to_left ? Vector3d(m.right_condyle - series_.rest.right_condyle)
                                      : Vector3d(m.left_condyle - series_.rest.left_condyle);
    const double outward = (to_left ? 1 : -1) * working.x();
    add({"working-side shift in " + what, "mm", outward, 0, 3.5,
         "immediate side shift up to 0.75, at the extreme 2.5 to 3.5 (Lundeen 1978)", false,
         "determined by Bennett angle and side shift of the orbiting side"});
    add({"displacement of the working condyle in " + what, "mm", working.norm(), 0, 4,
         "it rotates in place and moves little", false,
         "determined by Bennett angle and side shift of the orbiting side"});
    add({"displacement of the orbiting condyle in " + what, "mm", orbiting.norm(), 5, 16,
         "10 mm of it yaw the jaw by about 5.5 deg", false,
         "determined by the lateral displacement of the incisors"});
    const Vector3d across = m.left_condyle - m.right_condyle;
    const double yaw = std::abs(std::atan2(across.y(), across.x())) * degrees_per_radian;
    add({"yaw for 10 mm of the orbiting condyle in " + what, "deg",
         10 * yaw / std::max(-orbiting.y(), 1e-9), 4.5, 6.5, "about 5.5", false,
         "determined by the intercondylar width"});
  }

  void posterior_border(const MotionPhase& phase) {
    const auto [first, last] = series_.frames_of(phase);
    const std::string derived = "derived from 88 to 100 mm condyle to incisor, 32 to 34 deg";
    const double retruded = std::hypot(anterior(first), superior(first));
    add({"retruded contact from the bite", "mm", retruded, 0.1, 1.9, "0.86 +- 0.52 (Utz 2021)",
         false, "retrusion is prescribed; the teeth open the jaw meanwhile"});
    constexpr double hinge_end_deg = 13.5;
    for (auto i = first; i <= last; ++i)
      if (at(i).rotation_deg >= hinge_end_deg) {
        add({"Posselt: end of hinge, anterior", "mm", anterior(i), -15, -9, derived, false,
             "early translation of the condyles moves it forward"});
        add({"Posselt: end of hinge, superior", "mm", superior(i), -21, -16, derived, false,
             "early translation of the condyles moves it down"});
        break;
      }
    const std::string why =
        fmt::format("this opening rotates the jaw by {:.1f} deg; the ranges assume 32 to 34",
                    at(last).rotation_deg);
    add({"Posselt: maximum opening, anterior", "mm", anterior(last), -27, -19, derived, false,
         why});
    add({"Posselt: maximum opening, superior", "mm", superior(last), -48, -44, derived, false,
         why});
  }

  void protruded_contact(const MotionPhase& phase) {
    const auto [first, last] = series_.frames_of(phase);
    add({"Posselt: protruded contact, anterior", "mm", anterior(first), 6, 11, "8 (Woelfel)",
         built_in(), "prescribed"});
    tooth_path(last, first, "protruded contact");
  }

  void lateral_border(const MotionPhase& phase) {
    const auto [first, last] = series_.frames_of(phase);
    const bool to_left = phase.name.starts_with("left");
    double widest = 0;
    for (auto i = first; i <= last; ++i)
      widest = std::max(widest, (to_left ? 1 : -1) * at(i).laterotrusion_mm);
    add({"Posselt: widest " + phase.name, "mm", widest, 7, 12, "9.2 right, 9.4 left (Woelfel)",
         false, "the frontal border is widest a few millimetres below the teeth"});
    lateral_joints(to_left ? first : last, to_left, phase.name);
  }

  void rest_position(const MotionPhase& phase) {
    const auto [first, last] = series_.frames_of(phase);
    (void)first;
    if (at(last).opening_mm <= 0) return;
    add({"freeway space", "mm", at(last).opening_mm, 2, 3, "2 to 3", built_in(), "prescribed"});
  }

  // ---- chewing

  /// Frames at which a cycle leaves the bite.
  std::vector<std::size_t> cycle_starts(std::size_t first, std::size_t last, double lowest) const {
    const double gate = 0.15 * lowest;
    std::vector<std::size_t> starts;
    for (auto i = first + 1; i <= last; ++i)
      if (at(i).opening_mm >= gate && at(i - 1).opening_mm < gate) {
        auto start = i - 1;
        while (start > first && at(start - 1).opening_mm < at(start).opening_mm) --start;
        starts.push_back(start);
      }
    return starts;
  }

  /// Time at which the opening crosses a value between a frame and the previous one, s.
  double crossing_s(std::size_t after, double opening_mm) const {
    const double a = at(after - 1).opening_mm, b = at(after).opening_mm;
    const double u = b != a ? (opening_mm - a) / (b - a) : 0;
    return series_.time_s[after - 1] + u * (series_.time_s[after] - series_.time_s[after - 1]);
  }

  void chewing(const MotionPhase& phase) {
    const auto [first, last] = series_.frames_of(phase);
    const auto deepest = frame_of_largest(first, last, &Measures::opening_mm);
    const double bite = at(first).opening_mm, lowest = at(deepest).opening_mm - bite;
    const auto starts = cycle_starts(first, last, at(deepest).opening_mm);
    if (starts.empty() || lowest < 2) return;
    std::vector<double> areas, opening_speed, closing_speed, glides, widths;
    for (std::size_t c = 0; c < starts.size(); ++c) {
      const std::size_t end = c + 1 < starts.size() ? starts[c + 1] : last;
      std::vector<Vector3d> round;
      double glide = 0, left = 0, right = 0;
      std::optional<double> down1, down2, up1, up2;
      for (std::size_t i = starts[c]; i <= end; ++i) {
        round.push_back(at(i).incisor);
        left = std::max(left, at(i).laterotrusion_mm);
        right = std::min(right, at(i).laterotrusion_mm);
        if (i == starts[c]) continue;
        const double a = at(i - 1).opening_mm - bite, b = at(i).opening_mm - bite;
        const auto passes = [&](double level) { return (a - level) * (b - level) <= 0 && a != b; };
        if (b > a && passes(lowest / 3)) down1 = crossing_s(i, bite + lowest / 3);
        if (b > a && passes(2 * lowest / 3)) down2 = crossing_s(i, bite + 2 * lowest / 3);
        if (b < a && passes(2 * lowest / 3)) up1 = crossing_s(i, bite + 2 * lowest / 3);
        if (b < a && passes(lowest / 3)) up2 = crossing_s(i, bite + lowest / 3);
        constexpr double touch_mm = 0.12;  // compliance of the teeth
        if (b < a && series_.tooth_gap_mm[i] < touch_mm && series_.tooth_gap_mm[i - 1] < touch_mm)
          glide += (at(i).incisor - at(i - 1).incisor).norm();
      }
      areas.push_back(frontal_area(round));
      glides.push_back(glide);
      widths.push_back(left - right);
      if (down1 && down2 && *down2 > *down1)
        opening_speed.push_back(lowest / 3 / (*down2 - *down1));
      if (up1 && up2 && *up2 > *up1) closing_speed.push_back(lowest / 3 / (*up2 - *up1));
    }
    const auto mean = [](const std::vector<double>& values) {
      double sum = 0;
      for (const double v : values) sum += v;
      return values.empty() ? 0 : sum / static_cast<double>(values.size());
    };
    const double cycles = static_cast<double>(starts.size());
    const double rate =
        starts.size() > 1
            ? (cycles - 1) / (series_.time_s[starts.back()] - series_.time_s[starts.front()])
            : 1 / std::max(phase.end_s - phase.start_s, 1e-9);
    const std::string& what = phase.name;
    add({what + ": rate", "Hz", rate, 1.2, 1.7, "1.46 +- 0.21", built_in(), "prescribed"});
    add({what + ": height of a cycle", "mm", lowest, 10, 24, "", built_in(), "prescribed"});
    add({what + ": width of a cycle", "mm", mean(widths), 2, 8, "", built_in(), "prescribed"});
    if (!series_.borders.frontal.empty()) {
      const double border = frontal_area(series_.borders.frontal);
      add({what + ": cycle area of the border area", "%", 100 * mean(areas) / border, 5, 12,
           "7 to 10 (Fuentes 2018)", false,
           fmt::format("a cycle of {:.0f} mm2 in a border of {:.0f} mm2", mean(areas), border)});
    }
    const std::string speed = fmt::format("{:.0f} mm cycles at {:.2f} Hz", lowest, rate);
    add({what + ": opening speed, middle third", "mm/s", mean(opening_speed), 40, 80, "58", false,
         speed});
    add({what + ": closing speed, middle third", "mm/s", mean(closing_speed), 40, 80, "58", false,
         speed});
    constexpr double relevant_mm = 0.1;
    const double overlap = series_.tooth_overlap_at_rest_mm;
    add({what + ": glide on the teeth", "mm", mean(glides), 0.5, 4, "about 1.4", false,
         overlap > relevant_mm
             ? fmt::format("crowns overlap by {:.2f} mm at rest and touch long before the bite",
                           overlap)
             : "determined by the width of the cycle at tooth contact; flat cusps shorten it"});
  }

  // ---- joints

  /// Secant of a condyle's path over its first 5 mm forward, to the case's horizontal.
  void inclination(JawSide side) {
    constexpr double secant_mm = 5;
    const auto condyle = side == JawSide::left ? &Measures::left_condyle : &Measures::right_condyle;
    const Vector3d seat = series_.rest.*condyle;
    for (std::size_t i = 0; i < series_.size(); ++i) {
      const Vector3d d = at(i).*condyle - seat;
      if (-d.y() < secant_mm) continue;
      const std::string name = side == JawSide::left ? "left" : "right";
      const bool given = built_in() && !on_fossa(name);
      add({name + " condylar inclination over 5 mm", "deg",
           std::atan2(-d.z(), -d.y()) * degrees_per_radian, 26, 62,
           "41.9 +- 7.8, range 26 to 62, to Frankfort", given,
           "determined by the shape of the fossa"});
      return;
    }
  }

  void disc_gaps() {
    if (motion_.recorded && !motion_.muscles) return;  // a recording is not guided by the fossa
    if (!joint_) return;
    constexpr std::size_t max_samples = 120;
    const std::size_t stride = std::max<std::size_t>(1, series_.size() / max_samples);
    for (const JawSide side : {JawSide::left, JawSide::right}) {
      TrianglePair start;
      double min_mm = 1e300, max_mm = 0;
      for (std::size_t i = 0; i < series_.size(); i += stride) {
        const double gap = joint_->gap_mm(side, series_.X_CM[i], start);
        min_mm = std::min(min_mm, gap);
        max_mm = std::max(max_mm, gap);
      }
      const std::string name = side == JawSide::left ? "left" : "right";
      const double rest = joint_->rest_gap_mm(side);
      const std::string published =
          "1.3 anterior, 2.5 superior, 2.1 posterior (Ikeda & Kawamura 2013)";
      // The range is extended to the gap of the case.
      const double low = std::min(0.8, std::floor(45 * rest) / 100);
      const std::string why = fmt::format(
          "its gap at rest is {:.2f} mm; retrusion or lateral motion reduces it by {:.2f} mm, {}",
          rest, std::max(0.0, rest - min_mm),
          min_mm > 0 ? "without contact of bone" : "down to contact of bone");
      // A condyle guided by its fossa keeps the disc gap, which is an input.
      const bool is_input = built_in() && !motion_.muscles && on_fossa(name);
      add({name + " condyle to fossa, minimum", "mm", min_mm, low, 3.2, published, is_input, why});
      add({name + " condyle to fossa, maximum", "mm", max_mm, low, 3.2, published, is_input, why});
    }
  }

  const Scene& scene_;
  const Motion& motion_;
  const MotionSeries& series_;
  const Vector3d bite_;  // incisal point
  const std::optional<JointSurfaces> joint_;
  std::vector<Finding> found_;
};

}  // namespace

double frontal_area(const std::vector<Vector3d>& points) {
  double twice = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d &a = points[i], &b = points[(i + 1) % points.size()];
    twice += a.x() * b.z() - b.x() * a.z();
  }
  return 0.5 * std::abs(twice);
}

bool too_coarse(const MotionSeries& series) {
  constexpr double longest_s = 0.05 + 1e-9;
  return series.size() < 2 || series.time_s.back() - series.time_s.front() >
                                  longest_s * static_cast<double>(series.size() - 1);
}

std::vector<Finding> findings(const Scene& scene, const Motion& motion,
                              const MotionSeries& series) {
  if (!scene.patient.has_parts(scene.patient.jaw.lower_arch)) return {};
  return MotionAssessment(scene, motion, series).all();
}

std::vector<std::string> physiology_warnings(const MotionSeries& series) {
  std::vector<std::string> warnings;
  if (!series.known_landmarks || series.size() == 0) return warnings;
  const std::vector<Extreme> all = extremes(series);
  const auto warn = [&](const Extreme& found, double limit, const std::string& what) {
    if (found.value > limit)
      warnings.push_back(fmt::format("{} at {:.2f} s", fmt::format(fmt::runtime(what), found.value),
                                     found.time_s));
  };
  const auto limit = [&](const char* name, double max_value, const char* what) {
    warn(extreme(all, name), max_value, what);
  };
  limit("opening", 65, "opening of {:.1f} mm: adults seldom open more than 65 mm");
  limit("closing_beyond_rest", 6, "the lower incisors rise {:.1f} mm above their rest position");
  limit("protrusion", 13, "protrusion of {:.1f} mm: adults reach 6 to 11 mm");
  limit("laterotrusion_left", 14,
        "laterotrusion of {:.1f} mm to the left: adults reach 7 to 12 mm");
  limit("laterotrusion_right", 14,
        "laterotrusion of {:.1f} mm to the right: adults reach 7 to 12 mm");
  limit("left_condyle_travel", 23,
        "the left condyle travels {:.1f} mm: the normal range is 10 to 20 mm");
  limit("right_condyle_travel", 23,
        "the right condyle travels {:.1f} mm: the normal range is 10 to 20 mm");
  limit("rotation", 48,
        "the jaw rotates by {:.1f} deg: the normal range at full opening is 28 to 45 deg");
  limit("opening_speed", 457 + 183,
        "the incisors open at {:.0f} mm/s: the fastest voluntary opening is 457 +- 183");
  limit("closing_speed", 373 + 142,
        "the incisors close at {:.0f} mm/s: the fastest voluntary closing is 373 +- 142");
  Extreme backward, asymmetry;
  const auto update = [&](Extreme& largest, double value, std::size_t i) {
    if (value <= largest.value) return;
    largest.value = value;
    largest.time_s = series.time_s[i];
  };
  for (std::size_t i = 0; i < series.size(); ++i) {
    const Measures& m = series.measures[i];
    update(backward,
           std::max(m.left_condyle.y() - series.rest.left_condyle.y(),
                    m.right_condyle.y() - series.rest.right_condyle.y()),
           i);
    // In lateral motion the travels differ normally; in an opening they should not.
    if (std::abs(m.laterotrusion_mm) < 1 && m.opening_mm > 20)
      update(asymmetry, std::abs(m.left_condyle_travel_mm - m.right_condyle_travel_mm), i);
  }
  warn(backward, 2.5,
       "a condyle moves {:.1f} mm behind its rest position, into the rear wall of the fossa");
  warn(asymmetry, 4,
       "condylar travel differs by {:.1f} mm between the sides while the jaw opens straight");
  const bool opens = std::any_of(series.phases.begin(), series.phases.end(),
                                 [](const MotionPhase& p) { return p.name == "opening"; });
  const double opening = extreme(all, "opening").value;
  constexpr double limited_mm = 30, rounding_mm = 0.05;
  if (opens && series.phases.size() <= 3 && opening > 5 && opening < limited_mm - rounding_mm)
    warnings.push_back(fmt::format(
        "opening of {:.1f} mm: a maximum opening below 30 mm counts as limited", opening));
  return warnings;
}

}  // namespace condyle
