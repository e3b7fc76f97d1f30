#include "render/scene/tongue_shape.h"

#include "render/face/tongue_bend.h"
#include "render/mesh/vertex_normals.h"

namespace condyle {

void TongueShape::send(std::span<Drawable> drawables, std::span<const Pose> poses) {
  sent_.resize(drawables.size());
  for (std::size_t i = 0; i < drawables.size(); ++i) {
    Drawable& tongue = drawables[i];
    const Pose& X_CM = poses[i];
    Pose& sent = sent_[i];
    if (tongue.part->role != Role::tongue || tongue.box.isEmpty()) continue;
    if (X_CM.R.coeffs() == sent.R.coeffs() && X_CM.t == sent.t) continue;
    sent = X_CM;
    const TongueBend bend(tongue.box, X_CM);
    const Pose X_MC = X_CM.inverse();
    std::vector<Eigen::Vector3f> places;
    places.reserve(tongue.part->mesh.vertices.size());
    for (const auto& v : tongue.part->mesh.vertices)
      places.push_back((X_MC * bend(v.cast<float>()).cast<double>()).cast<float>());
    vertex_normals(places, tongue.part->mesh.triangles, normals_);
    tongue.mesh.send_shape(places, normals_);
  }
}

}  // namespace condyle
