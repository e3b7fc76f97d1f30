#include <cmath>
#include <numbers>

#include "engine/field/smooth.h"
#include "sim/phantom/bone_shapes.h"
#include "sim/phantom/lookup.h"
#include "sim/phantom/tooth_shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// Meridian profiles of the brain case about its centre, by elevation (degrees): radii forward,
// sideways, backward (mm), and the superellipse exponents in azimuth (2 at the poles, or the vertex
// grows a spike).
const Vector3d vault_center(0, 12, 45);
const std::vector<double> elevation = {-90, -75, -60, -45, -30, -15, 0, 15, 30, 45, 60, 75, 90};
const std::vector<double> radius_front = {72, 69,   62, 58,   62, 88,  103,
                                          99, 93.5, 86, 78.8, 74, 72.5};
const std::vector<double> radius_side = {72, 73,   75, 79,   74.5, 71,  70.5,
                                         71, 72.3, 72, 71.6, 72,   72.5};
const std::vector<double> radius_back = {72, 77, 84,   89.5, 88.5, 85.5, 83,
                                         81, 79, 77.5, 75.5, 73.5, 72.5};
const std::vector<double> exponent_front = {2, 2, 2, 2, 2, 2, 2.05, 2.25, 2.3, 2.2, 2.1, 2, 2};
const std::vector<double> exponent_back = {2,    2,    2.1, 2.2, 2.25, 2.25, 2.25,
                                           2.25, 2.25, 2.2, 2.1, 2,    2};

// Orbit: a superelliptic cone from the opening to the apex.
const Vector3d orbit_opening(30.8, -80, 17), orbit_apex(13, -36, 21);

/// `grow` makes the shell around the cavity; the cone runs from `from` to `to` of its length.
Primitive orbit(double grow, double from, double to) {
  Vector3d axis = orbit_apex - orbit_opening;
  const double length = axis.norm();
  axis /= length;
  Vector3d lateral = axis.cross(Vector3d::UnitZ()).normalized();
  if (lateral.x() < 0) lateral = -lateral;
  Vector3d up = lateral.cross(axis);
  if (up.z() < 0) up = -up;
  const double droop = -10 * pi / 180;  // outer corner lower
  const Vector3d u = lateral * std::cos(droop) + up * std::sin(droop);
  const Vector3d v = up * std::cos(droop) - lateral * std::sin(droop);
  return {[=](const Vector3d& p) {
            const Vector3d q = p - orbit_opening;
            const double t = q.dot(axis) / length, inside = std::clamp(t, -0.6, 1.0);
            const double scale = inside > 0 ? 1 + .06 * std::sin(pi * std::min(inside / .3, 1.0)) -
                                                  .78 * std::pow(inside, 1.4)
                                            : 1 - .10 * inside;
            const double a = 18.9 * scale + grow, b = 16.8 * scale + grow;
            const double n = 2.7 - .7 * std::clamp(inside, 0.0, 1.0);
            const double k = std::pow(
                std::pow(std::abs(q.dot(u)) / a, n) + std::pow(std::abs(q.dot(v)) / b, n) + 1e-9,
                1 / n);
            const double d = (k - 1) * std::min(a, b) * .92;
            return std::max(smooth_max(d, (t - to) * length - grow, 6), (from - t) * length);
          },
          {Vector3d(orbit_opening.x() - 32, -108, -12), Vector3d(orbit_opening.x() + 32, -28, 46)}};
}

/// Piriform aperture and nasal cavity back to the choanae.
Primitive nasal_cavity() {
  const Lookup half_width({-40, -27, -25, -22, -17, -10, -2, 4, 8, 11, 20},
                          {1, 7, 9.5, 11.3, 12, 10.8, 8, 5.5, 3.2, 1, 1});
  return {[=](const Vector3d& p) {
            const double side = (p.x() - half_width(p.z())) * .85;
            const double ends = std::max(-25.5 - p.z(), p.z() - 10);
            const double back = p.y() + 46 - 16 * std::clamp((-9 - p.z()) / 2, 0.0, 1.0);
            return std::max(smooth_max(side, ends, 3), back);
          },
          {Vector3d(0, -125, -26), Vector3d(13, -28, 10)}};
}

/// Brain cavity: the vault moved in, thicker low down, and kept off the orbits.
Primitive brain_cavity() {
  const Primitive vault = vault_shape(0), eye = orbit(0, -.6, .97);
  return {[=](const Vector3d& p) {
            const double low = std::clamp((8 - p.z()) / 25, 0.0, 1.0);
            return smooth_max(vault.distance(p) + 6.2 + 5 * low, 2.6 - eye.distance(p), 2);
          },
          vault.box};
}

/// Bone around the upper roots: tubes along the tooth axes, so that no root shows.
void add_upper_alveolar_process(FieldRecipe& bone) {
  struct Row {
    double depth, radius, outward;
  };
  for (const auto& row : {Row{4.6, 4.4, 0}, Row{9, 5.2, .2}, Row{14, 5.8, .3}}) {
    std::vector<Vector3d> points;
    for (const auto& tooth : tooth_frames(true)) {
      const double inward = tooth.name[0] == 'I' ? 1.6 : tooth.name == "C" ? .9 : 0;
      points.push_back(tooth.neck() - tooth.axis * row.depth +
                       tooth.labial * (row.outward - inward));
    }
    points.insert(points.begin(), Vector3d(0, points[0].y() + .3, points[0].z()));
    points.push_back(points.back() + Vector3d(.6, 5, 1.5));
    std::vector<double> radii{row.radius - 1.2, row.radius - 1, row.radius - .9, row.radius - .5};
    radii.resize(points.size(), row.radius);
    bone.add(tube(points, radii, 3), 5);
  }
}

void add_orbit_margins_and_nose(FieldRecipe& bone) {
  bone.add(orbit(3.0, .17, .9), 5);
  bone.add(rounded_box({0, -62, 8}, {11, 20, 22}, 8), 6);  // ethmoid
  bone.add(tube({{0, -84.3, 38},
                 {10, -85, 38},
                 {22, -83, 37.5},
                 {33, -78.5, 37},
                 {42.5, -72, 32},
                 {47.8, -67.5, 24}},
                {7, 6.6, 5.8, 5.2, 4.8, 4.8}, 4),
           11);  // brow
  bone.add(tube({{47.8, -66.5, 26}, {49.3, -63.5, 16}, {49.2, -64, 6}, {47, -66.5, -4}},
                {4.2, 3.4, 4.2, 6.5}),
           5);  // lateral margin
  bone.add(
      tube({{47, -66.5, -5}, {41, -72, -4}, {33, -76.5, -4.5}, {23, -78.2, -3.4}, {15, -80, 3}},
           {7, 5.6, 5, 5, 4}),
      5);  // lower margin
  bone.add(
      tube({{13, -80.8, 8}, {10.8, -82.5, 16}, {8, -84.5, 25}, {3, -84.5, 31}}, {3.4, 3.2, 4, 6}),
      4);  // frontal process
  bone.add(flat_tube({{0, -84, 32}, {0, -87.5, 22}, {0, -92.5, 14}, {0, -96.6, 8}},
                     {5, 3.6, 3, 2.2}, {6.5, 5.2, 6, 5.4}, {1, 0, 0}),
           4);  // nasal bones
  bone.add(tube({{6, -82.3, 24}, {8.3, -82.8, 14}, {10.8, -83.2, 5}}, {2.8, 2.8, 2.8}), 4);
  // Side walls of the nose, down to the rim of the aperture.
  bone.add(tube({{3.4, -91, 16}, {6, -88.5, 11.5}, {9.6, -85.5, 6}}, {2.4, 3.0, 3.2}), 5);
  bone.add(tube({{4, -94, 9.5}, {6.6, -91, 6.5}, {9.6, -87.6, 2}, {12.4, -85, -4}},
                {2.2, 2.4, 2.4, 2.6}),
           4);
}

void add_zygoma(FieldRecipe& bone) {
  bone.add(ellipsoid({46.5, -64.5, -9}, {8, 7.5, 9}), 9);
  bone.add(flat_tube({{49.5, -61.5, -11.5},
                      {55.5, -56.5, -10.5},
                      {61, -48, -8.5},
                      {64, -38, -7},
                      {64.2, -27, -5.5},
                      {63, -16, -3.5},
                      {61.5, -6, -1},
                      {61.5, 6, 2.5}},
                     {6.5, 6, 4.6, 3.8, 3.8, 4.2, 4.5, 4.5}, {4.5, 3.6, 2.6, 2.2, 2.3, 3, 3.6, 4},
                     {1, -.25, 0}, 9),
           5);  // arch
}

void add_maxilla(FieldRecipe& bone) {
  bone.add(rounded_box({20.5, -64, -20}, {12, 17, 17}, 9), 6);
  bone.add(rounded_box({25, -63.5, -16.5}, {12, 14.5, 13}, 9), 5);  // side wall
  bone.add(ellipsoid({32, -66, -15}, {13, 10.5, 11}), 8);
  bone.add(ellipsoid({25, -69, -31}, {7, 9, 8}), 6);
  // Zygomaticoalveolar crest: from the cheek bone in to the roots of the first molar.
  bone.add(tube({{29, -66, -28}, {35, -66, -23}, {44, -65.5, -16.2}}, {2.5, 3.5, 6.5}), 6);
  bone.add(tube({{15, -80.3, 4}, {15.6, -82, -6}, {15.5, -83.5, -16}, {13, -85, -25}},
                {3.6, 3.6, 4, 4.5}),
           5);  // piriform margin
  add_upper_alveolar_process(bone);
  bone.add(rounded_box({0, -66, -26.8}, {24, 22, 2.2}, 2), 5);  // hard palate
}

void add_skull_base(FieldRecipe& bone) {
  bone.add(flat_tube({{15, -40, -4}, {16, -39, -22}, {15.5, -40, -38}}, {9, 6.5, 5},
                     {2.2, 1.8, 1.6}, {.95, .25, 0}),
           4);                                              // pterygoid plates
  bone.add(rounded_box({0, -36, 4}, {16, 18, 13}, 9), 10);  // sphenoid
  bone.add(
      flat_tube({{0, -26, -6}, {0, -12, -16}, {0, -2, -25}}, {10, 9, 7}, {14, 12, 10}, {1, 0, 0}),
      8);  // clivus
  bone.add(tube({{60, 4, 2}, {46, 2, -2}, {28, -9, -5}, {14, -20, -6}}, {7, 7, 7, 6}), 7);
  bone.add(rounded_box({50.5, -18.5, -2}, {12.5, 13.5, 5.6}, 5.4), 7);  // block for the fossa
  bone.add(tube({{58, -28.5, -6.2}, {50, -28.5, -6.6}, {42, -27.5, -6.2}}, {4.2, 4.6, 4}), 4);
  bone.add(ellipsoid({55.5, 11, -11}, {9, 12, 19.5}, axis_rotation('y', 10)), 7);    // mastoid
  bone.add(tube({{43, 2, -18}, {40, -1, -32}, {37.5, -4, -43}}, {2.6, 2, 1.2}), 3);  // styloid
  bone.add(tube({{0, 84, 13}, {0, 80, 3}}, {4, 5}), 18);                             // inion
  bone.add(ellipsoid({17, 5, -30}, {6, 11, 5.5}, axis_rotation('z', -20)), 4);
}

void hollow_out(FieldRecipe& bone) {
  bone.cut(brain_cavity(), 3);
  bone.cut(flat_tube({{0, 17, -20}, {0, 17, -50}}, {17.5, 17.5}, {14.5, 14.5}, {1, 0, 0}), 3);
  bone.cut(orbit(0, -.6, .97), 1.5);
  bone.cut(nasal_cavity(), 1.5);
  bone.add(tube({{0, -84, -27.5}, {0, -90, -26}, {0, -93.6, -24.9}}, {4.2, 3.2, 1.8}), 4);  // ANS
  bone.cut(ellipsoid({24, -63, -13}, {10, 12.5, 13}), 1);    // maxillary sinus
  bone.cut(ellipsoid({28, -93, -22}, {8, 9, 8}), 10);        // canine fossa
  bone.add(rounded_box({0, -67, -6}, {1.2, 19, 20}, 1), 1);  // septum
  bone.add(tube({{10.5, -77, -13}, {8.5, -72, -15}, {8.5, -55, -15}}, {2.2, 3, 3}), 1.5);
  bone.add(tube({{5.2, -80, 1}, {5, -70, -1}, {5, -56, -1}}, {2, 2.6, 2.6}), 1.5);  // conchae
  bone.cut(tube({{70, 0, -4}, {50, 0, -4}}, {4., 3.2}), 1.5);                       // ear canal
  bone.cut(ellipsoid({45, -46, -20}, {10.5, 12.5, 19}), 3);  // space for the coronoid process
  bone.cut(fossa_cut(), .8);
  bone.cut(tube({{26.3, -85, -9.2}, {27.3, -79.4, -7}}, {1.9, 1.2}), 1);  // infraorbital foramen
}

}  // namespace

Primitive vault_shape(double outward) {
  const Lookup front(elevation, radius_front), side(elevation, radius_side),
      back(elevation, radius_back), n_front(elevation, exponent_front),
      n_back(elevation, exponent_back);
  const Primitive temple = ellipsoid({84, -46, 17}, {27, 36, 38});
  return {[=](const Vector3d& p) {
            const Vector3d q = p - vault_center;
            const double h = std::sqrt(q.x() * q.x() + q.y() * q.y());
            const double r = std::sqrt(h * h + q.z() * q.z()) + 1e-4;
            const double e = std::atan2(q.z(), h) * 180 / pi;
            const double n = q.y() < 0 ? n_front(e) : n_back(e);
            const double along = q.y() < 0 ? front(e) : back(e);
            const double c = (std::abs(q.y()) + 1e-4) / (h + 1e-4),
                         s = std::abs(q.x()) / (h + 1e-4);
            const double R = std::pow(std::pow(c / along, n) + std::pow(s / side(e), n), -1 / n);
            return smooth_max((r - R) * .93, -temple.distance(p), 18) - outward;
          },
          {Vector3d(0, -95 - outward, -45 - outward),
           Vector3d(76 + outward, 100 + outward, 122 + outward)}};
}

FieldRecipe skull_recipe() {
  FieldRecipe bone(Symmetry::mirror_x);
  bone.add(vault_shape(0), 0);
  add_orbit_margins_and_nose(bone);
  add_zygoma(bone);
  add_maxilla(bone);
  add_skull_base(bone);
  hollow_out(bone);
  return bone;
}

FieldRecipe nasal_cavity_recipe() {
  FieldRecipe air(Symmetry::mirror_x);
  air.add(nasal_cavity(), 0);
  return air;
}

}  // namespace condyle
