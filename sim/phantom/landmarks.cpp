#include <cmath>
#include <vector>

#include "sim/case/landmark_names.h"
#include "sim/phantom/bone_shapes.h"
#include "sim/phantom/soft_shapes.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

enum class On { skull, mandible, skin, space };
struct Named {
  const char* name;
  On on;
  double x, y, z;  // mm; x > 0: left one of a pair
};

const std::vector<Named> named_points = {
    {"glabella", On::skull, 0, -93.5, 40.5},
    {"nasion", On::skull, 0, -90.6, 26},
    {"rhinion", On::skull, 0, -97.7, 10},
    {"ans", On::skull, 0, -95.4, -24.6},
    {"a_point", On::skull, 0, -91, -30.6},
    {"prosthion", On::skull, 0, -89.2, -42.7},
    {"pns", On::skull, 0, -44, -27},
    {"upper_incisal_point", On::space, 0, -95.2, -53.2},
    {"lower_incisal_point", On::space, 0, -92.5, -50.9},
    {"infradentale", On::mandible, 0, -89, -58.5},
    {"b_point", On::mandible, 0, -87.9, -70},
    {"pogonion", On::mandible, 0, -90.9, -82},
    {"gnathion", On::mandible, 0, -87.8, -90},
    {"menton", On::mandible, 0, -82.4, -92.3},
    {"basion", On::skull, 0, -0.5, -27.5},
    {"opisthion", On::skull, 0, 34.5, -28},
    {"sella", On::space, 0, -20, 17},
    {"vertex", On::skull, 0, 14.6, 117.5},
    {"opisthocranion", On::skull, 0, 95.5, 20},
    {"hyoid", On::space, 0, -42, -98},
    {"porion", On::skull, 62, 0, 0},
    {"orbitale", On::skull, 32, -79, -0.5},
    {"infraorbital_foramen", On::skull, 26.7, -82.2, -9.9},
    {"orbit_medial_rim", On::skull, 11, -82.4, 17.3},
    {"orbit_lateral_rim", On::skull, 46.3, -66.7, 17.3},
    {"orbit_roof_margin", On::skull, 32, -81, 33.5},
    {"frontotemporale", On::skull, 48, -64.5, 45},
    {"frontozygomatic", On::skull, 54, -68.2, 22.5},
    {"zygion", On::skull, 66.6, -32, -6},
    {"malar", On::skull, 48, -75.6, -9.6},
    {"zygomaxillare", On::skull, 45, -66.2, -23.8},
    {"euryon", On::skull, 70.3, 12, 45},
    {"mastoidale", On::skull, 52.6, 11, -30.3},
    {"condylion", On::mandible, 50.2, -12.8, -2},
    {"condyle_lateral_pole", On::mandible, 60.1, -14.6, -7.5},
    {"condyle_medial_pole", On::mandible, 40.5, -11, -7.5},
    {"condyle", On::space, 50.5, -13, -7.5},
    {"fossa_roof", On::skull, 50.5, -13, 0.5},
    {"eminence_crest", On::skull, 49, -32, -8.4},
    {"coronoid_tip", On::mandible, 46.6, -42.2, -7.4},
    {"sigmoid_notch", On::mandible, 46.2, -27.8, -22.5},
    {"gonion", On::mandible, 46.8, -17, -65.2},
    {"mental_foramen", On::mandible, 28.2, -76.9, -73.6},
    {"lingula", On::mandible, 38.4, -30.15, -40.4},
    {"soft_glabella", On::skin, 0, -99.5, 41},
    {"sellion", On::skin, 0, -96.7, 24.6},
    {"pronasale", On::skin, 0, -118.7, -14.4},
    {"columella", On::skin, 0, -113, -24.2},
    {"subnasale", On::skin, 0, -107, -28.5},
    {"labrale_superius", On::skin, 0, -105.2, -45.6},
    {"stomion", On::space, 0, -102, -50.7},
    {"labrale_inferius", On::skin, 0, -105.2, -55.2},
    {"soft_b_point", On::skin, 0, -98.2, -70.8},
    {"soft_pogonion", On::skin, 0, -100.7, -84.6},
    {"soft_menton", On::skin, 0, -84, -99.6},
    {"cervical_point", On::skin, 0, -57.6, -114},
    {"soft_vertex", On::skin, 0, 14.4, 123},
    {"soft_opisthocranion", On::skin, 0, 101.7, 33},
    {"endocanthion", On::skin, 18.3, -80.4, 12.9},
    {"exocanthion", On::skin, 44.5, -73.8, 14.8},
    {"cornea", On::space, 32, -86.1, 14.5},
    {"eyeball", On::space, 32, -73.5, 14.5},
    {"alare", On::skin, 18.5, -100, -19.5},
    {"cheilion", On::skin, 24.5, -93.6, -50.6},
    {"soft_zygion", On::skin, 72.3, -35, 4},
    {"soft_gonion", On::skin, 59.7, -16, -61.5},
    {"tragion", On::skin, 72.6, 0, 1.8},
    {"otobasion_superius", On::skin, 75, -2, 18.6},
    {"otobasion_inferius", On::skin, 73.5, -3.5, -25},
    {"superaurale", On::skin, 79, 15, 31.5},
    {"subaurale", On::skin, 73, 0, -31.5},
    {"postaurale", On::skin, 86, 26, 9.6},
    {"soft_euryon", On::skin, 77, 12, 45},
};

/// Projection of the point onto the surface along the gradient; midline points remain in the
/// midline.
Vector3d onto_surface(const FieldRecipe& field, Vector3d p) {
  const bool midline = p.x() == 0;
  const double h = 0.05;
  for (int i = 0; i < 8; ++i) {
    Vector3d gradient;
    for (int a = 0; a < 3; ++a) {
      const Vector3d step = h * Vector3d::Unit(a);
      gradient[a] = (field(p + step) - field(p - step)) / (2 * h);
    }
    if (midline) gradient.x() = 0;
    p -= field(p) * gradient / std::max(gradient.squaredNorm(), 0.25);
  }
  return p;
}

}  // namespace

Role landmark_role(const std::string& name) {
  if (name.starts_with("lower_")) return Role::mandible;  // incisal point and teeth
  std::string base = name;
  for (const char* side : {"left_", "right_"})
    if (base.starts_with(side)) base.erase(0, std::string(side).size());
  for (const auto& entry : named_points) {
    if (base != entry.name) continue;
    if (entry.on == On::mandible || base == "condyle") return Role::mandible;
    if (entry.on == On::skin || base == "hyoid" || base == "stomion") return Role::face;
  }
  return Role::skull;
}

Landmarks phantom_landmarks(const PhantomSolid& solid) {
  Landmarks landmarks;
  for (const auto& entry : named_points) {
    Vector3d p(entry.x, entry.y, entry.z);
    if (entry.on == On::skull) p = onto_surface(solid.skull, p);
    if (entry.on == On::mandible) p = onto_surface(solid.mandible, p);
    if (entry.on == On::skin) p = onto_surface(solid.skin, p);
    if (entry.x == 0) {
      landmarks.points[entry.name] = p;
    } else {
      landmarks.points[std::string("left_") + entry.name] = p;
      landmarks.points[std::string("right_") + entry.name] = {-p.x(), p.y(), p.z()};
    }
  }
  for (const auto& tooth : tooth_points(solid)) {
    const int place = tooth.fdi % 10;
    if (place != 1 && place != 3 && place != 6) continue;
    const auto names = tooth_landmark_names(tooth.fdi);
    landmarks.points[names.tip] = tooth.tip;
    landmarks.points[names.apex] = tooth.apex;
  }
  return landmarks;
}

}  // namespace condyle
