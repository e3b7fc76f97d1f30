#include "render/scene/lights.h"

#include <Eigen/Geometry>

namespace condyle {

Lights lights_for(const Camera& camera) {
  const Eigen::Matrix3f to_world = view_matrix(camera).topLeftCorner<3, 3>().transpose();
  const auto toward = [&](float right, float up, float back) {
    return Eigen::Vector3f(to_world * Eigen::Vector3f(right, up, back).normalized());
  };
  Lights lights;
  lights.key_direction = toward(-0.50f, 0.62f, 0.66f);
  lights.fill_direction = toward(0.80f, 0.12f, 0.52f);
  lights.rim_direction = toward(0.58f, 0.42f, -0.66f);
  lights.sky_direction = toward(0, 0.95f, 0.3f);
  lights.key_color = {0.96f, 0.91f, 0.84f};
  lights.fill_color = {0.140f, 0.143f, 0.150f};
  lights.rim_color = {0.30f, 0.33f, 0.38f};
  lights.sky_color = {0.250f, 0.244f, 0.244f};
  lights.ground_color = {0.094f, 0.075f, 0.064f};
  lights.front_color = {0.075f, 0.075f, 0.075f};
  return lights;
}

void Lights::set_in(GlProgram& program) const {
  program.set("key_direction", key_direction);
  program.set("key_color", key_color);
  program.set("fill_direction", fill_direction);
  program.set("fill_color", fill_color);
  program.set("rim_direction", rim_direction);
  program.set("rim_color", rim_color);
  program.set("sky_direction", sky_direction);
  program.set("sky_color", sky_color);
  program.set("ground_color", ground_color);
  program.set("front_color", front_color);
}

Eigen::Matrix4f shadow_matrix(const Lights& lights, const Eigen::AlignedBox3f& box) {
  Eigen::Matrix3f rows;  // depth increases away from the light
  rows.row(2) = -lights.key_direction.transpose();
  rows.row(0) = lights.key_direction.unitOrthogonal().transpose();
  rows.row(1) = lights.key_direction.cross(rows.row(0).transpose()).transpose();
  Eigen::AlignedBox3f seen;
  for (int corner = 0; corner < 8; ++corner)
    seen.extend(rows * box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)));
  const Eigen::Vector3f scale = seen.sizes().cwiseMax(1e-3f).cwiseInverse();
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  matrix.topLeftCorner<3, 3>() = scale.asDiagonal() * rows;
  matrix.topRightCorner<3, 1>() = -scale.cwiseProduct(seen.min());
  return matrix;
}

}  // namespace condyle
