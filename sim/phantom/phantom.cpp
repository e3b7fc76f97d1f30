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

/// Few triangles on the smooth brain case, many at the joints.
double skull_importance(const Vector3d& p) {
  const bool face = p.y() < -45 && p.z() < 45,
             joint = p.z() < 8 && std::abs(p.x()) > 35 && p.y() < 5;
  return face || joint ? 6 : 1;
}

}  // namespace

Case build_phantom_on(int threads, const Progress& progress) {
  const PhantomSolid solid = make_phantom_solid();
  std::vector<Part> parts(9);
  const auto body = [&](std::size_t slot, const char* name, Role role, const FieldRecipe& shape,
                        const std::array<GridAxis, 3>& grid, int triangles) {
    std::function<double(const Vector3d&)> importance;
    if (role == Role::skull) importance = skull_importance;
    parts[slot] = plain_part(name, role, symmetric_surface(shape, grid, triangles, importance));
  };
  const auto box = [](double x, double y0, double y1, double z0, double z1, double spacing) {
    return even_grid({Vector3d(0, y0, z0), Vector3d(x, y1, z1)}, spacing);
  };
  const std::array<GridAxis, 3> skull_grid = {even_axis(0, 76, .65),
                                              graded_axis(-112, 102, 1.3, -112, 6, .65),
                                              graded_axis(-62, 122, 1.3, -62, 42, .65)};
  const std::vector<std::function<void()>> jobs = {
      [&] { parts[4] = plain_part("face", Role::face, face_surface()); },
      [&] { body(0, "skull", Role::skull, solid.skull, skull_grid, 50000); },
      [&] {
        body(1, "mandible", Role::mandible, solid.mandible, box(66, -98, 2, -100, 2, .6), 50000);
      },
      [&] { parts[2] = teeth_part(solid, true); },
      [&] { parts[3] = teeth_part(solid, false); },
      [&] {
        body(6, "upper_gums", Role::upper_gums, solid.upper_gums, box(40, -104, -26, -62, -20, .6),
             16000);
      },
      [&] {
        body(7, "lower_gums", Role::lower_gums, solid.lower_gums, box(42, -104, -26, -80, -40, .6),
             16000);
      },
      [&] { body(8, "tongue", Role::tongue, solid.tongue, box(34, -92, -24, -78, -30, .8), 6000); },
      [&] { parts[5] = plain_part("eyes", Role::eyes, eyes_surface()); },
  };
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
  patient.name = builtin_case_name;
  patient.parts = std::move(parts);
  patient.landmarks = phantom_landmarks(solid);
  patient.canals = phantom_canals(patient.landmarks);
  patient.condylar_path = phantom_condylar_path();
  return patient;
}

Case build_phantom(const Progress& progress) {
  return build_phantom_on(std::max(1, static_cast<int>(std::thread::hardware_concurrency())),
                          progress);
}

}  // namespace condyle
