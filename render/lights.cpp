#include "render/lights.h"

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
  lights.key_color = {0.98f, 0.94f, 0.88f};
  lights.fill_color = {0.17f, 0.19f, 0.22f};
  lights.rim_color = {0.30f, 0.33f, 0.38f};
  lights.sky_color = {0.30f, 0.315f, 0.335f};
  lights.ground_color = {0.105f, 0.095f, 0.088f};
  lights.front_color = {0.10f, 0.10f, 0.10f};
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

Eigen::Matrix4f shadow_matrix(const Lights& lights, const Eigen::Vector3f& centre,
                              float radius_mm) {
  const Eigen::Vector3f w = lights.key_direction;
  const Eigen::Vector3f u = w.unitOrthogonal(), v = w.cross(u);
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  const float scale = 0.5f / radius_mm;
  matrix.row(0) << scale * u.transpose(), 0.5f - scale * u.dot(centre);
  matrix.row(1) << scale * v.transpose(), 0.5f - scale * v.dot(centre);
  matrix.row(2) << -scale * w.transpose(), 0.5f + scale * w.dot(centre);
  return matrix;
}

}  // namespace condyle
