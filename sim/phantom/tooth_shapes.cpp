#include "sim/phantom/tooth_shapes.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "engine/field/smooth.h"
#include "sim/phantom/lookup.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Height of the occlusal surface at y: a plane 8.4 degrees to the Frankfort plane with a curve of
/// Spee of 1.3 mm.
double occlusal_height(double y) {
  return -51.7 + (y + 94) * 0.148 - 1.3 * std::max(0.0, 1 - std::pow((y + 72) / 22, 2));
}

// Plan of each arch: incisal edges, then central fossae, from the midline back.
const std::vector<Vector2d> upper_plan = {{0, -95.6},    {9, -93.9},    {14, -90.5},
                                          {17.2, -86},   {20.3, -79.5}, {22.2, -72.5},
                                          {24.2, -63.5}, {26, -54},     {27, -45}};
const std::vector<Vector2d> lower_plan = {{0, -93.2},  {8, -91.7},    {12.2, -88.6},
                                          {15, -84},   {17.8, -77},   {19.6, -70},
                                          {21.6, -61}, {23.4, -51.5}, {24.4, -42}};

/// Sizes after Wheeler, trimmed by 1 to 2 %; `beyond` is how far the tip passes the occlusal
/// surface (mm), tilts are towards the lip and towards the midline.
struct ToothSize {
  const char* name;
  double width, depth, height, root, beyond, labial_tilt_deg, mesial_tip_deg;
};
constexpr std::array<ToothSize, 7> upper_sizes = {{{"I1", 8.6, 7.1, 10.6, 13, 1.3, 20, 2},
                                                   {"I2", 6.7, 6.2, 9.4, 13, .7, 19, 6},
                                                   {"C", 7.8, 8.0, 10.4, 16, 1.5, 9, 8},
                                                   {"P1", 7.1, 9.2, 8.6, 14, 1.1, -1, 5},
                                                   {"P2", 7.0, 9.1, 8.2, 14, 1.1, -2, 3},
                                                   {"M1", 10.3, 11, 7.4, 12.5, .75, -1, 1},
                                                   {"M2", 9.7, 10.8, 7.0, 11.5, .6, 5, -4}}};
constexpr std::array<ToothSize, 7> lower_sizes = {{{"I1", 5.1, 6.0, 8.8, 11, 1.2, 24, 0},
                                                   {"I2", 5.6, 6.3, 9.2, 11.5, 1.2, 22, 1},
                                                   {"C", 6.8, 7.6, 10.2, 15.5, 1.5, 10, 5},
                                                   {"P1", 6.9, 7.7, 8.6, 14, 1.0, -4, 5},
                                                   {"P2", 7.0, 8.1, 8.2, 14.5, .9, -9, 6},
                                                   {"M1", 10.9, 10.4, 7.4, 13.5, .75, -14, 8},
                                                   {"M2", 10.3, 10.0, 7.0, 12.5, .6, -18, 10}}};

/// Section of a crown against height (0 neck, 1 tip): half-width and half-depth as fractions of
/// half the tooth's, labial shift as a fraction of half the depth, superellipse exponent.
struct CrownSection {
  std::vector<double> at, width, depth, shift;
  double exponent;
};
const std::map<char, CrownSection> crown_sections = {{'I',
                                                      {{0, .25, .6, .88, 1},
                                                       {.70, .84, .98, 1.0, .95},
                                                       {.92, 1, .62, .34, .22},
                                                       {0, .02, .20, .34, .36},
                                                       3.0}},
                                                     {'C',
                                                      {{0, .3, .6, .8, 1},
                                                       {.72, .9, 1.0, .92, .5},
                                                       {.95, 1, .75, .5, .25},
                                                       {0, .0, .12, .22, .25},
                                                       2.4}},
                                                     {'P',
                                                      {{0, .35, .65, .85, 1},
                                                       {.74, .95, 1, .97, .8},
                                                       {.90, 1, .95, .84, .62},
                                                       {0, .03, 0, 0, 0},
                                                       2.5}},
                                                     {'M',
                                                      {{0, .35, .7, .88, 1},
                                                       {.84, .98, 1, .97, .86},
                                                       {.90, 1, .96, .86, .68},
                                                       {0, .03, 0, 0, 0},
                                                       3.0}}};

/// Cusps: distal and buccal position as fractions of half the width and depth, mm below the tip.
/// The first one is the buccal cusp of a premolar, the mesiobuccal cusp of a molar.
struct Cusp {
  double distal, buccal, below;
};
struct Occlusal {
  std::vector<Cusp> cusps;
  double fossa;  // depth, mm
};
const std::map<std::string, Occlusal> occlusal_shapes = {
    {"uP1", {{{0, .50, 0}, {-.08, -.50, .7}}, 2.6}},
    {"uP2", {{{0, .50, 0}, {-.05, -.50, .3}}, 2.3}},
    {"uM1", {{{-.48, .52, 0}, {.42, .52, .3}, {-.30, -.50, 0}, {.50, -.50, .9}}, 2.4}},
    {"uM2", {{{-.46, .52, 0}, {.42, .50, .4}, {-.25, -.50, .1}, {.5, -.48, 1.3}}, 2.2}},
    {"lP1", {{{0, .36, 0}, {0, -.52, 2.6}}, 2.4}},
    {"lP2", {{{0, .42, 0}, {-.25, -.52, 1.0}, {.4, -.5, 1.4}}, 2.2}},
    {"lM1",
     {{{-.55, .50, .1}, {.06, .54, .1}, {.66, .36, .6}, {-.5, -.54, 0}, {.38, -.54, .1}}, 2.3}},
    {"lM2", {{{-.48, .52, .1}, {.45, .52, .2}, {-.48, -.52, 0}, {.45, -.52, .2}}, 2.1}}};
constexpr double cusp_slope = 0.62;  // tan 32 degrees

/// Plan curve of an arch by arc length from the midline.
class ArchCurve {
 public:
  explicit ArchCurve(const std::vector<Vector2d>& plan) {
    std::vector<Eigen::VectorXd> rows{Vector2d(-plan[1].x(), plan[1].y())};
    rows.insert(rows.end(), plan.begin(), plan.end());
    const auto curve = catmull_rom(rows, 40);
    for (std::size_t i = 40; i < curve.size(); ++i) {
      length_.push_back(point_.empty() ? 0 : length_.back() + (curve[i] - point_.back()).norm());
      point_.emplace_back(curve[i]);
    }
  }
  Vector2d at(double length) const {
    std::size_t i = 0;
    while (i + 2 < length_.size() && length_[i + 1] < length) ++i;
    const double t = (length - length_[i]) / (length_[i + 1] - length_[i]);
    return point_[i] + std::clamp(t, 0.0, 1.0) * (point_[i + 1] - point_[i]);
  }
  Vector2d tangent(double length) const {
    return (at(length + 0.8) - at(std::max(length - 0.8, 0.0))).normalized();
  }

 private:
  std::vector<double> length_;
  std::vector<Vector2d> point_;
};

std::vector<ToothFrame> make_frames() {
  std::vector<ToothFrame> frames;
  for (const bool upper : {true, false}) {
    const ArchCurve curve(upper ? upper_plan : lower_plan);
    double length = 0;
    int fdi = upper ? 21 : 31;
    for (const auto& size : upper ? upper_sizes : lower_sizes) {
      const Vector2d p = curve.at(length + size.width / 2);
      const Vector2d t = curve.tangent(length + size.width / 2);
      length += size.width;
      Vector3d labial(t.y(), -t.x(), 0);
      if (labial.dot(Vector3d(p.x(), p.y() + 72, 0)) < 0) labial = -labial;
      const Vector3d distal(t.x(), t.y(), 0);
      const double tilt = size.labial_tilt_deg * std::numbers::pi / 180;
      const double tip = size.mesial_tip_deg * std::numbers::pi / 180;
      Vector3d axis(0, 0, upper ? -1 : 1);
      axis = axis * std::cos(tilt) + labial * std::sin(tilt);
      axis = (axis * std::cos(tip) - distal * std::sin(tip)).normalized();
      const Vector3d m = (distal - axis * axis.dot(distal)).normalized();
      Vector3d b = axis.cross(m);
      if (b.dot(labial) < 0) b = -b;
      ToothFrame frame;
      frame.upper = upper;
      frame.name = size.name;
      frame.fdi = fdi++;
      frame.width = size.width;
      frame.depth = size.depth;
      frame.height = size.height;
      frame.root = size.root;
      frame.tip = {p.x(), p.y(), occlusal_height(p.y()) + (upper ? -size.beyond : size.beyond)};
      frame.axis = axis;
      frame.distal = m;
      frame.labial = b;
      frames.push_back(frame);
    }
  }
  return frames;
}

constexpr double apex_shift = -0.12;  // labial, as a fraction of half the depth

/// The edge of front teeth lies labial of the axis by this much; the frame's tip is put on it.
double edge_offset(const ToothFrame& f) {
  const char kind = f.name[0];
  if (kind != 'I' && kind != 'C') return 0;
  return crown_sections.at(kind).shift.back() * f.depth / 2;
}

/// Outline of crown and root about the tooth's axis, without its top.
struct Barrel {
  Barrel(const ToothFrame& frame, const CrownSection& section)
      : half_width(make(frame, section, section.width, .12, .62, .97, .8)),
        half_depth(make(frame, section, section.depth, .12, .60, .97, .7)),
        shift(make_shift(frame, section)),
        exponent(section.exponent) {}

  static Lookup make(const ToothFrame& f, const CrownSection& s, const std::vector<double>& table,
                     double apex, double middle, double neck, double beyond) {
    std::vector<double> x{-f.root / f.height, -0.6 * f.root / f.height, -0.1};
    std::vector<double> y{apex * table[0], middle * table[0], neck * table[0]};
    x.insert(x.end(), s.at.begin(), s.at.end());
    y.insert(y.end(), table.begin(), table.end());
    x.push_back(1.3);
    y.push_back(table.back() * beyond);
    return {x, y};
  }
  static Lookup make_shift(const ToothFrame& f, const CrownSection& s) {
    std::vector<double> x{-f.root / f.height, 0}, y{apex_shift, 0};
    x.insert(x.end(), s.at.begin() + 1, s.at.end());
    y.insert(y.end(), s.shift.begin() + 1, s.shift.end());
    x.push_back(1.3);
    y.push_back(s.shift.back());
    return {x, y};
  }
  /// u distal, v labial, q height as a fraction of the crown's; halves in mm.
  double distance(double u, double v, double q, double half_w, double half_d, double grow) const {
    const double a = half_width(q) * half_w + grow, b = half_depth(q) * half_d + grow;
    const double n = q > 0 ? exponent : 2.2;
    const double k = std::pow(
        std::pow(std::abs(u) / a, n) + std::pow(std::abs(v - shift(q) * half_d) / b, n) + 1e-9,
        1 / n);
    return (k - 1) * std::min(a, b) * 0.9;
  }
  Lookup half_width, half_depth, shift;
  double exponent;
};

Eigen::AlignedBox3d box_of(const ToothFrame& frame) {
  Eigen::AlignedBox3d box;
  box.extend(Vector3d(frame.tip + frame.axis));
  box.extend(Vector3d(frame.tip - frame.axis * (frame.height + frame.root)));
  return {box.min().array() - 7, box.max().array() + 7};
}

}  // namespace

const std::vector<ToothFrame>& tooth_frames() {
  static const auto frames = make_frames();
  return frames;
}

std::vector<ToothFrame> tooth_frames(bool upper) {
  const auto& all = tooth_frames();
  return upper ? std::vector<ToothFrame>(all.begin(), all.begin() + 7)
               : std::vector<ToothFrame>(all.begin() + 7, all.end());
}

Primitive tooth_shape(const ToothFrame& f) {
  const char kind = f.name[0];
  const auto& section = crown_sections.at(kind);
  const bool front = kind == 'I' || kind == 'C';
  const double edge = edge_offset(f);
  const Barrel barrel(f, section);
  const Occlusal occlusal = front ? Occlusal{} : occlusal_shapes.at((f.upper ? "u" : "l") + f.name);
  const double W = f.width / 2, B = f.depth / 2, H = f.height;
  const auto top = [=](double u, double v) {
    if (kind == 'I') return H - .05 * u * u - .25 * std::max(u - .7 * W, 0.0);
    if (kind == 'C') return H + .35 - .55 * std::sqrt(u * u + .4);
    double t = -1e9;
    for (const auto& cusp : occlusal.cusps) {
      const double du = u - cusp.distal * W, dv = v - cusp.buccal * B;
      const double cone = H - cusp.below - cusp_slope * (std::sqrt(du * du + dv * dv + .5) - .7);
      t = t < -1e8 ? cone : smooth_max(t, cone, .5);
    }
    return smooth_max(t, H - occlusal.fossa, 1.0);
  };
  return {[=](const Vector3d& p) {
            const Vector3d q = p - f.tip;
            const double u = q.dot(f.distal), v = q.dot(f.labial) + edge, w = q.dot(f.axis) + H;
            const double side = barrel.distance(u, v, w / H, W, B, 0);
            const double d = smooth_max(side, (w - top(u, v)) * .82, front ? .7 : 1.0);
            return std::max(d, -(w + f.root));
          },
          box_of(f)};
}

Vector3d tooth_tip(const ToothFrame& f) {
  const auto shape = occlusal_shapes.find((f.upper ? "u" : "l") + f.name);
  if (shape == occlusal_shapes.end()) return f.tip;
  const Cusp& cusp = shape->second.cusps.front();
  return f.tip + cusp.distal * f.width / 2 * f.distal + cusp.buccal * f.depth / 2 * f.labial -
         cusp.below * f.axis;
}

Vector3d tooth_apex(const ToothFrame& f) {
  return f.tip - (f.height + f.root) * f.axis +
         (apex_shift * f.depth / 2 - edge_offset(f)) * f.labial;
}

Primitive tooth_collar(const ToothFrame& f, double thickness) {
  const auto& section = crown_sections.at(f.name[0]);
  const double edge = edge_offset(f);
  const Barrel barrel(f, section);
  return {[=](const Vector3d& p) {
            const Vector3d q = p - f.tip;
            const double u = q.dot(f.distal), v = q.dot(f.labial) + edge,
                         w = q.dot(f.axis) + f.height;
            // The margin follows the neck: higher between the teeth, lower in their middle.
            const double s = std::abs(u) / (f.width / 2);
            const double margin = 0.7 + 1.6 * s * s;
            const double side =
                barrel.distance(u, v, w / f.height, f.width / 2, f.depth / 2, thickness);
            return smooth_max(smooth_max(side, (w - margin) * 0.8, 1.2), -(w + 9), 3);
          },
          box_of(f)};
}

}  // namespace condyle
