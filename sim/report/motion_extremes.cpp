#include "sim/report/motion_extremes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

namespace condyle {
namespace {

struct Kind {
  const char *name, *unit;
  std::function<double(const MotionSeries&, std::size_t frame)> value;
};

const std::vector<Kind>& kinds() {
  const auto of = [](auto value) {
    return [value](const MotionSeries& series, std::size_t i) { return value(series.measures[i]); };
  };
  static const std::vector<Kind> all = {
      {"opening", "mm", of([](const Measures& m) { return m.opening_mm; })},
      {"closing_beyond_rest", "mm", of([](const Measures& m) { return -m.opening_mm; })},
      {"between_incisors", "mm", of([](const Measures& m) { return m.interincisal_mm; })},
      {"protrusion", "mm", of([](const Measures& m) { return m.protrusion_mm; })},
      {"incisors_backward", "mm", of([](const Measures& m) { return -m.protrusion_mm; })},
      {"laterotrusion_left", "mm", of([](const Measures& m) { return m.laterotrusion_mm; })},
      {"laterotrusion_right", "mm", of([](const Measures& m) { return -m.laterotrusion_mm; })},
      {"midline_deviation", "mm",
       of([](const Measures& m) { return std::abs(m.midline_deviation_mm); })},
      {"rotation", "deg", of([](const Measures& m) { return m.rotation_deg; })},
      {"left_condyle_travel", "mm", of([](const Measures& m) { return m.left_condyle_travel_mm; })},
      {"right_condyle_travel", "mm",
       of([](const Measures& m) { return m.right_condyle_travel_mm; })},
      {"condyle_asymmetry", "mm", of([](const Measures& m) {
         return std::abs(m.left_condyle_travel_mm - m.right_condyle_travel_mm);
       })},
      {"opening_speed", "mm/s",
       [](const MotionSeries& s, std::size_t i) { return s.opening_speed_mm_s(i); }},
      {"closing_speed", "mm/s",
       [](const MotionSeries& s, std::size_t i) { return -s.opening_speed_mm_s(i); }},
      {"incisor_speed", "mm/s",
       [](const MotionSeries& s, std::size_t i) { return s.incisor_speed_mm_s(i); }},
  };
  return all;
}

}  // namespace

std::vector<Extreme> extremes(const MotionSeries& series) {
  std::vector<Extreme> out;
  if (series.size() == 0) return out;
  for (const Kind& kind : kinds()) {
    Extreme largest{kind.name, kind.unit, kind.value(series, 0), series.time_s[0]};
    for (std::size_t i = 1; i < series.size(); ++i)
      if (const double value = kind.value(series, i); value > largest.value) {
        largest.value = value;
        largest.time_s = series.time_s[i];
      }
    out.push_back(largest);
  }
  return out;
}

const Extreme& extreme(const std::vector<Extreme>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Extreme& e) { return e.name == name; });
  if (found == all.end()) throw std::out_of_range("no measure is called " + name);
  return *found;
}

}  // namespace condyle
