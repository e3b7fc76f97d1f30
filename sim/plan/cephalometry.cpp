#include "sim/plan/cephalometry.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "engine/core/units.h"
#include "sim/plan/columns.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Landmarks on the midsagittal plane: x forward, y up. Reading a point that is missing notes its
/// name and makes every value that depends on it not finite.
class Profile {
 public:
  Profile(const ClinicalFrame& frame, const Landmarks& landmarks)
      : frame_(frame), landmarks_(landmarks) {}

  Vector2d at(const std::string& name) {
    if (const auto found = landmarks_.find(name)) {
      const Vector3d v = frame_.components(*found - frame_.origin);
      return {-v.y(), v.z()};
    }
    missing_.insert(name);
    return Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  /// The mean of both sides of a pattern such as "{}_gonion".
  Vector2d pair(const char* pattern) {
    const Vector2d left = at(fmt::format(fmt::runtime(pattern), "left"));
    const Vector2d right = at(fmt::format(fmt::runtime(pattern), "right"));
    return 0.5 * (left + right);
  }
  const std::set<std::string>& missing() const { return missing_; }

 private:
  const ClinicalFrame& frame_;
  const Landmarks& landmarks_;
  std::set<std::string> missing_;
};

/// Unsigned angle between directions, degrees; not finite for one without length.
double angle(const Vector2d& a, const Vector2d& b) {
  const double cross = a.x() * b.y() - a.y() * b.x(), dot = a.dot(b);
  if (!(a.norm() > 1e-9 && b.norm() > 1e-9)) return std::numeric_limits<double>::quiet_NaN();
  return std::atan2(std::abs(cross), dot) * degrees_per_radian;
}

/// The direction of unit length; not finite for one without length.
Vector2d unit(const Vector2d& v) {
  return v.norm() > 1e-9 ? Vector2d(v.normalized())
                         : Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
}

/// Angle by which `b` is turned clockwise from `a`, the patient facing right, degrees.
double clockwise(const Vector2d& a, const Vector2d& b) {
  const double cross = a.x() * b.y() - a.y() * b.x();
  return cross > 0 ? -angle(a, b) : angle(a, b);
}

// Lines, each as a direction.
Vector2d nasion_to_sella(Profile& p) { return p.at("sella") - p.at("nasion"); }
Vector2d frankfort_back(Profile& p) { return p.pair("{}_porion") - p.pair("{}_orbitale"); }
/// From the chin to the angle of the jaw.
Vector2d menton_to_gonion(Profile& p) { return p.pair("{}_gonion") - p.at("menton"); }
Vector2d upper_incisor(Profile& p) {  // from the apex to the tip
  return p.at("upper_incisal_point") - p.pair("upper_{}_central_incisor_apex");
}
Vector2d lower_incisor(Profile& p) {
  return p.at("lower_incisal_point") - p.pair("lower_{}_central_incisor_apex");
}

double sna(Profile& p) { return angle(nasion_to_sella(p), p.at("a_point") - p.at("nasion")); }
double snb(Profile& p) { return angle(nasion_to_sella(p), p.at("b_point") - p.at("nasion")); }

/// Distance of a point in front of the line through nasion across the Frankfort plane, mm.
double before_perpendicular(Profile& p, const char* name) {
  return -unit(frankfort_back(p)).dot(p.at(name) - p.at("nasion"));
}

/// A dropped on the functional occlusal plane, in front of B, mm.
double wits(Profile& p) {
  const Vector2d molars = 0.5 * (p.pair("upper_{}_first_molar_mesiobuccal_cusp") +
                                 p.pair("lower_{}_first_molar_mesiobuccal_cusp"));
  const Vector2d canines = 0.5 * (p.pair("upper_{}_canine_tip") + p.pair("lower_{}_canine_tip"));
  return unit(canines - molars).dot(p.at("a_point") - p.at("b_point"));
}

/// Distance in front of the line from the tip of the nose to the soft chin, mm.
double before_e_line(Profile& p, const char* lip) {
  const Vector2d nose = p.at("pronasale");
  const Vector2d down = unit(p.at("soft_pogonion") - nose);
  const Vector2d front(-down.y(), down.x());  // a right angle anticlockwise from downward
  return front.dot(p.at(lip) - nose);
}

double upper_height_percent(Profile& p) {
  const double upper = p.at("nasion").y() - p.at("ans").y();
  return 100 * upper / (p.at("nasion").y() - p.at("menton").y());
}

struct Definition {
  const char* name;
  const char* unit;
  CephalometricNorm norm;
  std::function<double(Profile&)> value;
};

constexpr const char* textbook = "textbook value, European adults";

CephalometricNorm normal(double mean, double sd, const std::string& author) {
  return {mean, sd, false, author.empty() ? textbook : author + "; " + textbook};
}

CephalometricNorm between(double low, double high, const std::string& author) {
  return {0.5 * (low + high), 0.5 * (high - low), true, author + "; " + textbook};
}

using Definitions = std::vector<Definition>;

/// Position of the jaws.
Definitions skeletal_definitions() {
  return {
      {"SNA", "deg", normal(82, 3.5, "Steiner 1953"), sna},
      {"SNB", "deg", normal(80, 3, "Steiner 1953"), snb},
      {"ANB", "deg", normal(2, 2, "Steiner 1953"), [](Profile& p) { return sna(p) - snb(p); }},
      {"Wits", "mm", between(-3, 2, "Jacobson 1975 (men -1 ± 2, women 0 ± 2)"), wits},
      {"SN to Go-Gn", "deg", normal(32, 5, "Steiner 1953"),
       [](Profile& p) {
         return clockwise(nasion_to_sella(p), p.pair("{}_gonion") - p.at("gnathion"));
       }},
      {"FMA (Frankfort to Go-Me)", "deg", normal(25, 5, "Tweed 1954"),
       [](Profile& p) { return clockwise(frankfort_back(p), menton_to_gonion(p)); }},
      {"facial angle (Frankfort to N-Pog)", "deg", normal(88, 3.5, "Downs 1948"),
       [](Profile& p) { return angle(frankfort_back(p), p.at("pogonion") - p.at("nasion")); }},
      {"convexity (NA to APog)", "deg", normal(0, 5, "Downs 1948"),
       [](Profile& p) {
         const Vector2d a = p.at("a_point");
         return clockwise(a - p.at("nasion"), p.at("pogonion") - a);
       }},
      {"A to N-perpendicular", "mm", between(0, 1, "McNamara 1984"),
       [](Profile& p) { return before_perpendicular(p, "a_point"); }},
      {"Pog to N-perpendicular", "mm", between(-4, 2, "McNamara 1984"),
       [](Profile& p) { return before_perpendicular(p, "pogonion"); }},
      {"N-ANS of N-Me", "%", normal(45, 0, ""), upper_height_percent},
  };
}

Definitions dental_definitions() {
  return {
      {"overjet", "mm", normal(2.5, 1, ""),
       [](Profile& p) {
         return p.at("upper_incisal_point").x() - p.at("lower_incisal_point").x();
       }},
      {"overbite", "mm", normal(2.5, 1, ""),
       [](Profile& p) {
         return p.at("lower_incisal_point").y() - p.at("upper_incisal_point").y();
       }},
      {"U1 to SN", "deg", normal(103, 6, ""),
       [](Profile& p) { return angle(nasion_to_sella(p), upper_incisor(p)); }},
      {"U1 to Frankfort", "deg", normal(111, 6, ""),
       [](Profile& p) { return angle(frankfort_back(p), upper_incisor(p)); }},
      {"IMPA (L1 to Go-Me)", "deg", normal(90, 5, "Tweed 1954"),
       [](Profile& p) { return angle(menton_to_gonion(p), lower_incisor(p)); }},
      {"FMIA (L1 to Frankfort)", "deg", normal(65, 5, "Tweed 1954"),
       [](Profile& p) { return angle(-frankfort_back(p), lower_incisor(p)); }},
      {"interincisal angle", "deg", normal(131, 6, "Steiner 1953"),
       [](Profile& p) { return angle(upper_incisor(p), lower_incisor(p)); }},
  };
}

Definitions soft_definitions() {
  return {
      {"facial convexity (G-Sn-Pog')", "deg", normal(12, 4, "Legan and Burstone 1980"),
       [](Profile& p) {
         const Vector2d sn = p.at("subnasale");
         return clockwise(sn - p.at("soft_glabella"), p.at("soft_pogonion") - sn);
       }},
      {"nasolabial angle", "deg", normal(102, 8, "Legan and Burstone 1980"),
       [](Profile& p) {
         const Vector2d sn = p.at("subnasale");
         return angle(p.at("columella") - sn, p.at("labrale_superius") - sn);
       }},
      {"upper lip to E line", "mm", normal(-4, 2, "Ricketts 1968"),
       [](Profile& p) { return before_e_line(p, "labrale_superius"); }},
      {"lower lip to E line", "mm", normal(-2, 2, "Ricketts 1968"),
       [](Profile& p) { return before_e_line(p, "labrale_inferius"); }},
  };
}

const Definitions& definitions() {
  static const Definitions all = [] {
    Definitions list = skeletal_definitions();
    for (auto part : {dental_definitions(), soft_definitions()})
      list.insert(list.end(), part.begin(), part.end());
    return list;
  }();
  return all;
}

std::string value_text(const std::optional<double>& value, bool with_sign = false) {
  if (!value) return "-";
  const std::string text =
      with_sign ? fmt::format("{:+.1f}", *value) : fmt::format("{:.1f}", *value);
  return text == "-0.0" || text == "+0.0" ? "0.0" : text;
}

}  // namespace

std::vector<CephalometricMeasure> cephalometry(const ClinicalFrame& frame, const Landmarks& before,
                                               const Landmarks& after) {
  std::vector<CephalometricMeasure> measures;
  for (const auto& definition : definitions()) {
    CephalometricMeasure measure{.name = definition.name,
                                 .unit = definition.unit,
                                 .before = {},
                                 .after = {},
                                 .norm = definition.norm,
                                 .missing = {}};
    std::set<std::string> missing;
    const auto measure_in = [&](const Landmarks& landmarks) -> std::optional<double> {
      Profile profile(frame, landmarks);
      const double value = definition.value(profile);
      missing.insert(profile.missing().begin(), profile.missing().end());
      if (!profile.missing().empty() || !std::isfinite(value)) return std::nullopt;
      return value;
    };
    measure.before = measure_in(before);
    measure.after = measure_in(after);
    measure.missing.assign(missing.begin(), missing.end());
    measures.push_back(std::move(measure));
  }
  return measures;
}

std::string norm_text(const CephalometricNorm& norm) {
  if (norm.is_range) return fmt::format("{:g} to {:g}", norm.mean - norm.sd, norm.mean + norm.sd);
  return norm.sd > 0 ? fmt::format("{:g} ± {:g}", norm.mean, norm.sd)
                     : fmt::format("{:g}", norm.mean);
}

std::string cephalometry_text(const std::vector<CephalometricMeasure>& measures) {
  std::vector<std::vector<std::string>> rows = {
      {"measure", "unit", "before", "after", "change", "norm", "source"}};
  std::string missing;
  for (const auto& measure : measures) {
    if (!measure.before || !measure.after)
      missing += fmt::format("  {}: {}\n", measure.name,
                             measure.missing.empty()
                                 ? "its points coincide"
                                 : fmt::format("{}", fmt::join(measure.missing, ", ")));
    if (!measure.before && !measure.after) continue;
    rows.push_back({measure.name, measure.unit, value_text(measure.before),
                    value_text(measure.after), value_text(measure.change(), true),
                    norm_text(measure.norm), measure.norm.source});
  }
  std::string text = aligned_columns(rows, "llrrrll");
  if (!missing.empty())
    text += "\nNot measured, because landmarks are missing or resected\n" + missing;
  return text;
}

nlohmann::ordered_json cephalometry_json(const std::vector<CephalometricMeasure>& measures) {
  using Json = nlohmann::ordered_json;
  const auto json_of = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  Json list = Json::array();
  for (const auto& measure : measures) {
    const CephalometricNorm& norm = measure.norm;
    Json item = {{"name", measure.name},
                 {"unit", measure.unit},
                 {"before", json_of(measure.before)},
                 {"after", json_of(measure.after)}};
    if (norm.is_range)
      item["norm"] = {{"low", norm.mean - norm.sd}, {"high", norm.mean + norm.sd}};
    else
      item["norm"] = {{"mean", norm.mean}, {"sd", norm.sd > 0 ? Json(norm.sd) : Json(nullptr)}};
    item["norm"]["source"] = norm.source;
    if (!measure.missing.empty()) item["missing"] = measure.missing;
    list.push_back(std::move(item));
  }
  return list;
}

}  // namespace condyle
