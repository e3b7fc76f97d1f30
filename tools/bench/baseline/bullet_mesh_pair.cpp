#include "tools/bench/baseline/bullet_mesh_pair.h"

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <vector>

namespace condyle {
namespace {

struct Surface {
  std::vector<int> indices;
  std::vector<btScalar> places;
  std::unique_ptr<btTriangleIndexVertexArray> triangles;
  std::unique_ptr<btGImpactMeshShape> shape;
  btCollisionObject object;

  explicit Surface(const TriMesh& mesh) {
    for (const auto& t : mesh.triangles) indices.insert(indices.end(), t.data(), t.data() + 3);
    for (const auto& v : mesh.vertices) places.insert(places.end(), v.data(), v.data() + 3);
    triangles = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(mesh.triangles.size()), indices.data(), static_cast<int>(3 * sizeof(int)),
        static_cast<int>(mesh.vertices.size()), places.data(),
        static_cast<int>(3 * sizeof(btScalar)));
    shape = std::make_unique<btGImpactMeshShape>(triangles.get());
    shape->updateBound();
    object.setCollisionShape(shape.get());
  }
};

}  // namespace

struct BulletMeshPair::State {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btCollisionWorld world{&dispatcher, &broadphase, &configuration};
  Surface a, b;

  State(const TriMesh& mesh_a, const TriMesh& mesh_b) : a(mesh_a), b(mesh_b) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
    world.addCollisionObject(&a.object);
    world.addCollisionObject(&b.object);
  }
  ~State() {
    world.removeCollisionObject(&b.object);
    world.removeCollisionObject(&a.object);
  }
};

BulletMeshPair::BulletMeshPair(const TriMesh& a, const TriMesh& b)
    : state_(std::make_unique<State>(a, b)) {}
BulletMeshPair::~BulletMeshPair() = default;

BulletMeshPair::Found BulletMeshPair::find(const Pose& X_AB) {
  const btQuaternion turn(X_AB.R.x(), X_AB.R.y(), X_AB.R.z(), X_AB.R.w());
  const btVector3 place(X_AB.t.x(), X_AB.t.y(), X_AB.t.z());
  state_->b.object.setWorldTransform(btTransform(turn, place));
  state_->world.performDiscreteCollisionDetection();
  Found found;
  for (int i = 0; i < state_->dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *state_->dispatcher.getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      ++found.contacts;
      found.depth_mm = std::max(found.depth_mm, -manifold.getContactPoint(k).getDistance());
    }
  }
  return found;
}

}  // namespace condyle
