#include "sim/phantom/phantom.h"

#include <algorithm>
#include <mutex>
#include <thread>

#include "engine/core/parallel.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

Part plain_part(const char* name, Role role, TriMesh mesh) {
  return {name, role, std::move(mesh), {}};
}

/// Teeth stay sharp, the smooth brain case needs few triangles.
double skull_importance(const Vector3d& p) {
  const bool face = p.y() < -45 && p.z() < 45,
             joint = p.z() < 8 && std::abs(p.x()) > 35 && p.y() < 5;
  return face || joint ? 6 : 1;
}

}  // namespace

Case build_phantom(const Progress& progress) {
  const PhantomSolid solid = make_phantom_solid();
  std::vector<Part> parts(9);
  // Longest first, so that two threads end at about the same time.
  const std::vector<std::function<void()>> jobs = {
      [&] { parts[4] = plain_part("face", Role::face, face_surface()); },
      [&] {
        parts[0] = plain_part(
            "skull", Role::skull,
            symmetric_surface(solid.skull, {Vector3d(0, -112, -62), Vector3d(76, 102, 122)},
                              {.triangles = 50000, .importance = skull_importance}));
      },
      [&] {
        parts[1] = plain_part(
            "mandible", Role::mandible,
            symmetric_surface(solid.mandible, {Vector3d(0, -98, -100), Vector3d(66, 2, 2)},
                              {.spacing = 0.6, .triangles = 50000}));
      },
      [&] { parts[2] = teeth_part(solid, true); },
      [&] { parts[3] = teeth_part(solid, false); },
      [&] {
        parts[6] = plain_part(
            "upper_gums", Role::upper_gums,
            symmetric_surface(solid.upper_gums, {Vector3d(0, -104, -62), Vector3d(40, -26, -20)},
                              {.spacing = 0.6, .triangles = 16000}));
      },
      [&] {
        parts[7] = plain_part(
            "lower_gums", Role::lower_gums,
            symmetric_surface(solid.lower_gums, {Vector3d(0, -104, -80), Vector3d(42, -26, -40)},
                              {.spacing = 0.6, .triangles = 16000}));
      },
      [&] {
        parts[8] = plain_part(
            "tongue", Role::tongue,
            symmetric_surface(solid.tongue, {Vector3d(0, -92, -78), Vector3d(34, -24, -30)},
                              {.spacing = 0.8, .triangles = 6000}));
      },
      [&] { parts[5] = plain_part("eyes", Role::eyes, eyes_surface()); },
  };
  const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::mutex reporting;
  std::size_t done = 0;
  report(progress, "building the built-in patient", 0);
  parallel_for(jobs.size(), threads, [&](std::size_t i) {
    jobs[i]();
    const std::scoped_lock lock(reporting);
    report(progress, "building the built-in patient",
           static_cast<double>(++done) / static_cast<double>(jobs.size()));
  });
  Case patient;
  patient.name = "built-in patient";
  patient.parts = std::move(parts);
  patient.landmarks = phantom_landmarks(solid);
  patient.condylar_path = phantom_condylar_path();
  return patient;
}

}  // namespace condyle
