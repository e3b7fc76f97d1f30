#include "sim/plan/graft_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

constexpr std::size_t max_curve_points = 1000;
constexpr double curve_range_mm = 1e4;
constexpr double max_donor_mm = 1000;

GraftStepProblem refused_name(const std::string& item, const std::string& name) {
  const auto plain = [](unsigned char c) { return c >= ' ' && c != 127; };
  if (!name.empty() && name.size() <= 100 && std::all_of(name.begin(), name.end(), plain))
    return std::nullopt;
  return std::pair(
      item, "is \"" + name.substr(0, 40) + "\"; expected a name of 1 to 100 printable characters");
}

GraftStepProblem refused_number(const std::string& item, double value, double least, double most) {
  if (value >= least && value <= most) return std::nullopt;
  return std::pair(item, fmt::format("is {:g}; expected {:g} to {:g}", value, least, most));
}

/// The name of a graft becomes that of files.
bool is_file_name(const std::string& name) {
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

}  // namespace

std::vector<std::string> graft_bodies(const GraftStep& step) {
  if (step.pieces == 1) return {step.name};
  std::vector<std::string> names;
  for (int i = 1; i <= step.pieces; ++i) names.push_back(fmt::format("{}_{}", step.name, i));
  return names;
}

GraftStepProblem graft_step_problem(const ResectStep& step) {
  return refused_name("segment", step.segment);
}

GraftStepProblem graft_step_problem(const GraftStep& step) {
  if (auto found = refused_name("name", step.name)) return found;
  if (!is_file_name(step.name))
    return std::pair("name", "is \"" + step.name + "\"; expected letters, digits, - and _");
  if (auto found = refused_name("replaces", step.replaces)) return found;
  if (step.donor.empty() || step.donor.size() > 4096)
    return std::pair("donor",
                     fmt::format("has {} characters; expected 1 to 4096", step.donor.size()));
  if (step.pieces < 1 || step.pieces > max_graft_pieces)
    return std::pair("pieces",
                     fmt::format("is {}; expected 1 to {}", step.pieces, max_graft_pieces));
  if (step.curve.size() == 1 || step.curve.size() > max_curve_points)
    return std::pair("curve", fmt::format("has {} points; expected none, or 2 to {}",
                                          step.curve.size(), max_curve_points));
  for (std::size_t i = 0; i < step.curve.size(); ++i) {
    const Eigen::Vector3d& p = step.curve[i];
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > curve_range_mm)
      return std::pair(fmt::format("curve[{}]", i),
                       fmt::format("is ({:g}, {:g}, {:g}); each coordinate must be a number from "
                                   "{:g} to {:g}",
                                   p.x(), p.y(), p.z(), -curve_range_mm, curve_range_mm));
    if (i > 0 && (p - step.curve[i - 1]).norm() < 0.1)
      return std::pair(fmt::format("curve[{}]", i), "repeats the point before it");
  }
  if (step.height_mm)
    if (auto found = refused_number("height_mm", *step.height_mm, 0, 60)) return found;
  if (auto found = refused_number("roll_deg", step.roll_deg, -180, 180)) return found;
  if (auto found = refused_number("kerf_mm", step.kerf_mm, 0, 2)) return found;
  if (auto found = refused_number("spacing_mm", step.spacing_mm, 0, 20)) return found;
  if (auto found = refused_number("clearance_mm", step.clearance_mm, 0, 5)) return found;
  if (!step.starts_mm.empty() && step.starts_mm.size() != static_cast<std::size_t>(step.pieces))
    return std::pair("starts_mm", fmt::format("has {} places; expected none, or one for each of {} "
                                              "pieces",
                                              step.starts_mm.size(), step.pieces));
  for (std::size_t i = 0; i < step.starts_mm.size(); ++i)
    if (auto found =
            refused_number(fmt::format("starts_mm[{}]", i), step.starts_mm[i], 0, max_donor_mm))
      return found;
  if (step.approach != "submandibular" && step.approach != "intraoral")
    return std::pair("approach",
                     "is \"" + step.approach + "\"; it must be submandibular or intraoral");
  return std::nullopt;
}

std::string donor_label(const GraftStep& step) {
  const bool of_file =
      !step.donor_shape.empty() || step.donor.find_first_of("/\\.") != std::string::npos;
  return of_file ? "own surface" : step.donor;
}

std::string graft_step_details(const GraftStep& step) {
  std::string text =
      fmt::format("{} in {} piece{} for {}; kerf {:g} mm; {}", donor_label(step), step.pieces,
                  step.pieces == 1 ? "" : "s", step.replaces, step.kerf_mm,
                  step.curve.empty() ? "along the lower border"
                                     : fmt::format("along {} points", step.curve.size()));
  if (step.roll_deg != 0) text += fmt::format("; roll {:g} degrees", step.roll_deg);
  return text;
}

}  // namespace condyle
