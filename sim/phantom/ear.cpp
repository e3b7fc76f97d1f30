#include "sim/phantom/soft_shapes.h"

namespace condyle {

void add_ear(FieldRecipe& head) {
  using Eigen::Vector3d;
  // The ear's own frame: leaning back 12 degrees, standing off 28 degrees.
  const Vector3d origin(71.5, 6, -1);
  const Eigen::Matrix3d turn = axis_rotation('x', -12) * axis_rotation('z', -28);
  const Vector3d out = turn.col(0), back = turn.col(1), up = turn.col(2);
  Eigen::Matrix3d axes;
  axes << out, back, up;
  const auto at = [&](double u, double v, double n) -> Vector3d {
    return origin + u * back + v * up + n * out;
  };
  head.add(ellipsoid(at(5, 4, 1.5), {2.6, 14.5, 25.5}, axes), 4);
  head.add(ellipsoid(at(0, -20, 1), {3.2, 8, 11}, axes), 5);      // lobule
  head.add(ellipsoid(at(-3, 0, -6), {8, 10, 20}, axes), 5);       // root
  head.cut(ellipsoid(at(0, 2, 5.5), {5.5, 8.2, 13}, axes), 2.5);  // concha
  head.cut(ellipsoid(at(6, 17, 4.6), {2.8, 7, 6}, axes), 2);
  head.add(tube({at(-6, 3, 3), at(-9, 14, 3.5), at(-6, 25, 3.8), at(4, 30.5, 4), at(14, 26, 4.2),
                 at(19.3, 14, 4.2), at(18.5, 0, 3.8), at(13.5, -13, 3.2), at(5, -22, 2)},
                {2.0, 2.5, 2.8, 2.9, 2.9, 2.8, 2.5, 2.2, 2}),
           2);  // helix
  head.add(
      tube({at(7, 19, 3.4), at(10.5, 10, 3.6), at(10.5, 0, 3.6), at(7, -9, 3.4), at(2, -12.5, 3.2)},
           {1.6, 2.1, 2.2, 2.1, 2}),
      2.5);                                                            // antihelix
  head.add(ellipsoid(at(-8, -2, 3.2), {3, 3.4, 6}, axes), 3);          // tragus
  head.cut(tube({at(-3, -1, 4), at(-3.5, -1, .5)}, {3.2, 2.2}), 1.5);  // meatus
}

}  // namespace condyle
