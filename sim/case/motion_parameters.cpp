#include "sim/case/motion_parameters.h"

namespace condyle {
namespace {

/// A row of the table below; `also` is a second value that the parameter sets.
struct ParameterRow {
  const char *name, *unit;
  double low, high;
  const char* help;
  MotionParameters::Value MotionParameters::*value;
  MotionParameters::Value MotionParameters::*also = nullptr;
};

constexpr ParameterRow parameter_rows[] = {
    {"opening", "mm", 1, 80, "Maximum opening: descent of the lower incisal point",
     &MotionParameters::opening_mm},
    {"protrusion", "mm", 0.5, 20, "Maximum protrusion at the incisors (8)",
     &MotionParameters::protrusion_mm},
    {"retrusion", "mm", 0, 3, "Maximum retrusion of the condyles (0.7)",
     &MotionParameters::retrusion_mm},
    {"laterotrusion", "mm", 0.5, 20, "Maximum laterotrusion at the incisors (9)",
     &MotionParameters::laterotrusion_mm},
    {"freeway", "mm", 0.2, 15, "Freeway space at the incisors in the rest position (2.5)",
     &MotionParameters::freeway_mm},
    {"hinge", "deg", 0, 30, "Rotation before the condyles translate (12)",
     &MotionParameters::hinge_deg},
    {"early_translation", "", 0, 1,
     "0 hinge first ... 1 translation from the start (as early as the joint requires)",
     &MotionParameters::early_translation},
    {"inclination", "deg", 0, 80,
     "Condylar inclination, secant over 5 mm; replaces the patient's fossa",
     &MotionParameters::inclination_left_deg, &MotionParameters::inclination_right_deg},
    {"inclination_left", "deg", 0, 80, "Condylar inclination, left side only",
     &MotionParameters::inclination_left_deg},
    {"inclination_right", "deg", 0, 80, "Condylar inclination, right side only",
     &MotionParameters::inclination_right_deg},
    {"path_shape", "", 0, 1,
     "Shape of a path of given inclination: 0 straight ... 1 curved as an eminence (1)",
     &MotionParameters::path_shape},
    {"bennett", "deg", 0, 40, "Bennett angle (7.5)", &MotionParameters::bennett_deg},
    {"side_shift", "mm", 0, 4, "Immediate side shift (0.3)", &MotionParameters::side_shift_mm},
    {"disc_gap", "mm", 0.05, 8, "Condyle to fossa when seated (as in the patient)",
     &MotionParameters::disc_gap_mm},
    {"disc_gap_front", "mm", 0.05, 8,
     "Condyle to fossa on the slope of the eminence (1.3, or as when seated where that is less)",
     &MotionParameters::disc_gap_front_mm},
    {"bonwill", "mm", 60, 150,
     "Bonwill distance, condyle to incisors: places the condyles as in an articulator",
     &MotionParameters::bonwill_mm},
    {"balkwill", "deg", 0, 60, "Balkwill angle, Bonwill's triangle to the horizontal: likewise",
     &MotionParameters::balkwill_deg},
    {"incisal_guidance", "deg", 0, 80,
     "Angle of an incisal table that guides in addition to the teeth (20 without teeth)",
     &MotionParameters::incisal_guidance_deg},
    {"speed", "mm_s", 1, 600, "Mean speed of the incisors, mm/s (40)",
     &MotionParameters::speed_mm_s},
    {"chew_rate", "hz", 0.2, 4, "Chewing cycles per second (1.4)", &MotionParameters::chew_rate_hz},
    {"chew_size", "mm", 2, 40, "Height of a chewing cycle (15)", &MotionParameters::chew_size_mm},
    {"chew_width", "mm", 0, 15, "Width of a chewing cycle (5)", &MotionParameters::chew_width_mm},
    {"chew_cycles", "", 1, 1000, "Number of chewing cycles (5)", &MotionParameters::chew_cycles},
};

}  // namespace

std::span<const MotionParameterName> motion_parameter_names() {
  static const std::vector<MotionParameterName> names = [] {
    std::vector<MotionParameterName> all;
    for (const ParameterRow& row : parameter_rows) {
      all.push_back({row.name, row.unit, row.low, row.high, row.help, {row.value}});
      if (row.also) all.back().values.push_back(row.also);
    }
    return all;
  }();
  return names;
}

const MotionParameterName* motion_parameter(const std::string& name) {
  for (const auto& entry : motion_parameter_names())
    if (entry.name == name || entry.key() == name) return &entry;
  return nullptr;
}

MotionParameters MotionParameters::over(const MotionParameters& others) const {
  MotionParameters both = *this;
  for (const auto& entry : motion_parameter_names())
    for (const auto value : entry.values)
      if (!(both.*value)) both.*value = others.*value;
  return both;
}

}  // namespace condyle
