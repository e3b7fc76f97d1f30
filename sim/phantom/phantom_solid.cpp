#include "sim/phantom/phantom_solid.h"

#include <algorithm>
#include <cmath>

#include "sim/phantom/bone_shapes.h"
#include "sim/phantom/soft_shapes.h"
#include "sim/phantom/tooth_shapes.h"

namespace condyle {
namespace {

constexpr double contact_gap = 0.085;  // mm, between opposing teeth at rest

std::vector<ToothSolid> make_teeth() {
  std::vector<ToothSolid> teeth;
  std::vector<Primitive> upper;
  for (const auto& frame : tooth_frames()) {
    const Primitive shape = tooth_shape(frame);
    ToothSolid tooth{frame.fdi, frame.fdi - 10, FieldRecipe(), shape.box};
    if (!frame.upper) tooth.right_fdi = frame.fdi + 10;
    tooth.solid.add(shape, 0);
    if (frame.upper) {
      upper.push_back(shape);
    } else {
      // Shaped slightly too high, then carved, so that every contact has the same small gap.
      for (const auto& opponent : upper) {
        if (!opponent.box.intersects(shape.box)) continue;
        tooth.solid.cut(
            {[opponent](const Eigen::Vector3d& p) { return opponent.distance(p) - contact_gap; },
             opponent.box},
            0);
        if (opponent.box.min().x() < 0)  // crosses the midline, as does its mirror image
          tooth.solid.cut({[opponent](const Eigen::Vector3d& p) {
                             return opponent.distance({-p.x(), p.y(), p.z()}) - contact_gap;
                           },
                           opponent.box},
                          0);
      }
    }
    teeth.push_back(std::move(tooth));
  }
  return teeth;
}

double nearest(const std::vector<ToothSolid>& teeth, Eigen::Vector3d p, int first, int last) {
  double d = FieldRecipe::nothing;
  const Eigen::Vector3d twin(-p.x(), p.y(), p.z());
  for (const auto& tooth : teeth)
    if (tooth.fdi >= first && tooth.fdi <= last)
      d = std::min({d, tooth.solid(p), tooth.solid(twin)});
  return d;
}

}  // namespace

double PhantomSolid::upper_teeth(const Eigen::Vector3d& p) const {
  return nearest(teeth, p, 21, 27);
}

double PhantomSolid::lower_teeth(const Eigen::Vector3d& p) const {
  return nearest(teeth, p, 31, 37);
}

PhantomSolid make_phantom_solid() {
  PhantomSolid solid;
  solid.skull = skull_recipe();
  solid.mandible = mandible_recipe();
  solid.skin = skin_recipe(Lips::closed);
  FieldRecipe mouth(Symmetry::mirror_x);
  mouth.add(oral_space(), 0);
  solid.oral_cavity = mouth;
  solid.nasal_cavity = nasal_cavity_recipe();
  solid.upper_gums = upper_gums_recipe();
  solid.lower_gums = lower_gums_recipe();
  solid.tongue = tongue_recipe();
  solid.teeth = make_teeth();
  return solid;
}

}  // namespace condyle
