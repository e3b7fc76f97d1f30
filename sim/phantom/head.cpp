#include <cmath>

#include "engine/field/smooth.h"
#include "sim/phantom/bone_shapes.h"
#include "sim/phantom/soft_shapes.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double base_height = -190;  // where the neck is cut flat

Primitive half_space(const Vector3d& normal, double offset) {  // inside where normal.p < offset
  return {[=](const Vector3d& p) { return normal.dot(p) - offset; }, unbounded_box()};
}

void add_neck(FieldRecipe& head) {
  head.add(flat_tube({{0, 14, -60}, {0, 22, -110}, {0, 28, -160}, {0, 31, -215}}, {46, 47, 50, 54},
                     {50, 50, 56, 74}, {1, 0, 0}, 12),
           24);
  head.add(tube({{57, 12, -24}, {46, -3, -70}, {31, -17, -112}, {19, -26, -150}, {9, -30, -195}},
                {8, 8, 7.5, 7.5, 7.5}, 10),
           32);  // sternomastoid
  head.add(tube({{0, -38, -120}, {0, -34, -150}, {0, -31, -200}}, {13, 13, 13}), 20);  // larynx
  head.add(tube({{30, 34, -120}, {48, 34, -165}, {80, 34, -215}}, {22, 24, 30}, 6),
           20);                                                                         // trapezius
  head.add(tube({{14, 66, -14}, {15, 51, -52}, {16, 42, -120}}, {11, 16, 16}, 6), 24);  // nape
  head.add(ellipsoid({0, 8, -222}, {100, 50, 54}), 26);                                 // collar
}

void add_eyes(FieldRecipe& head) {
  head.cut(ellipsoid({31, -92, 13}, {14, 12, 10}), 9);
  head.add(ellipsoid(eye_center, Vector3d::Constant(eye_radius + 1.9)), 4);
  head.add(tube({{19, -78, 20}, {26, -84.5, 23.5}, {34, -85, 25}, {43, -79, 22}, {48, -72, 17}},
                {2.5, 3, 3.4, 3.2, 2.5}),
           6);  // lid fold
  head.cut(lid_opening(), 1.0);
  head.add(ellipsoid(eye_center, Vector3d::Constant(eye_radius)), 0);
  head.add(ellipsoid({17.6, -79.2, 12.3}, {2.4, 3, 2}), 1.2);    // caruncle
  head.add(ellipsoid({20.4, -79, 12.9}, {2.6, 2.6, 2.2}), 1.2);  // fold between it and the eyeball
}

void add_nose(FieldRecipe& head) {
  head.add(flat_tube({{0, -86.5, 28}, {0, -91, 18}, {0, -98, 8}, {0, -105, -3}, {0, -110, -11}},
                     {5.5, 5, 5, 6, 7}, {6.5, 5.5, 5.2, 6, 6.8}, {1, 0, 0}),
           11);
  head.add(ellipsoid({0, -110.5, -16}, {8, 7.5, 7.2}), 6);
  head.add(
      tube({{5, -95, 8}, {8, -98, -2}, {9.5, -101, -11}, {10.5, -102.5, -17}}, {4.5, 5.5, 6, 6}),
      10);
  head.add(ellipsoid({12.2, -101.5, -19.5}, {5.2, 8.5, 6}, axis_rotation('z', -14)), 3.5);
  head.add(tube({{0, -113, -20.5}, {0, -108, -24.2}, {0, -102, -27}}, {3.4, 3, 4}), 3);
  head.cut(flat_tube({{6.4, -109.5, -27}, {6.8, -106, -22}, {6.2, -100, -16}}, {2.3, 3.0, 2.5},
                     {1.9, 2.4, 2.2}, {1, 0, 0}),
           1.2);  // nostril
  head.cut(tube({{17.3, -103, -14.5}, {17.8, -98, -19}, {17.5, -95.5, -25}}, {.2, .2, -1.6}), 4);
}

void add_lips(FieldRecipe& head, Lips lips) {
  head.add(tube({{3.8, -101.6, -30}, {4.6, -102.6, -42}}, {1.0, 1.3}), 5);  // philtrum
  head.add(tube({{0, -101.6, -46.8},
                 {4, -102.6, -45.3},
                 {10, -100.6, -46.5},
                 {17, -96.2, -48.8},
                 {24, -89.8, -50.4}},
                {3.0, 3.6, 3.6, 3, 1.8}),
           3);
  head.add(tube({{0, -100.6, -55.3}, {7, -100., -55.3}, {15, -96, -54}, {24, -89.8, -51.2}},
                {4.6, 4.4, 3.6, 1.6}),
           3);
  if (lips == Lips::closed)
    head.cut(flat_tube({{0, -108, -50.7},
                        {5, -106, -50.2},
                        {12, -103, -50.6},
                        {19, -97, -50.6},
                        {25.5, -91.5, -50.9}},
                       {.8, .8, .8, .7, .4}, {6, 5, 4, 3, 2}, {.2, -1, 0}, 9),
             1.2);
}

}  // namespace

Primitive lid_opening() {
  const Vector2d inner(17.5, 12.4), outer(45, 15.2), middle = (inner + outer) / 2;  // (x, z)
  const double half = (outer - inner).norm() / 2;
  const Vector2d along = (outer - inner) / (2 * half), up(-along.y(), along.x());
  return {[=](const Vector3d& p) {
            const Vector2d q = Vector2d(p.x(), p.z()) - middle;
            const double u = q.dot(along), v = q.dot(up);
            double d = -50;
            // Two arcs; the upper one peaks toward the nose, the lower one away from it.
            for (const int side : {1, -1}) {
              const double height = side > 0 ? 4.7 : 3.8;
              const double radius = (half * half + height * height) / (2 * height);
              d = std::max(d, std::hypot(u + 1.2 * side, v * side + radius - height) - radius);
            }
            return std::max(d, p.y() + 70);
          },
          {Vector3d(14, -100, 4), Vector3d(48, -66, 24)}};
}

FieldRecipe skin_recipe(Lips lips) {
  FieldRecipe head(Symmetry::mirror_x);
  head.add(vault_shape(5.2), 0);
  head.cut(half_space({0, 0, 1}, -34), 18);
  head.add(face_base(), 12);
  add_neck(head);
  head.add(tube({{0, -88, 39}, {14, -88, 38}, {28, -83.5, 39}, {40, -75, 36}, {46, -68, 30}},
                {5, 5.5, 5.5, 5.5, 5}),
           10);                                          // brow
  head.add(ellipsoid({43, -68, -8}, {13, 12, 12}), 14);  // cheek
  add_eyes(head);
  add_nose(head);
  add_lips(head, lips);
  head.add(ellipsoid({0, -88, -85}, {14, 9.5, 9}), 10);  // chin pad
  add_ear(head);
  head.cut(half_space({0, 0, 1}, base_height), 8);
  return head;
}

}  // namespace condyle
