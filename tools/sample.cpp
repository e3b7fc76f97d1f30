#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <memory>

#include "engine/core/files.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/case_io.h"
#include "sim/case/edit_bodies.h"
#include "sim/case/landmark_files.h"
#include "tools/commands.h"
#include "tools/common.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

struct SampleFile {
  const char* name;
  Role role;
};
constexpr std::array surfaces = {
    SampleFile{"skull.stl", Role::skull}, SampleFile{"jaw.stl", Role::mandible},
    SampleFile{"upper.stl", Role::upper_teeth}, SampleFile{"lower.stl", Role::lower_teeth},
    SampleFile{"skin.ply", Role::face}};

/// A block of bone in front of the chin, which a posterior push brings to rest on it.
Part chin_transplant(const Case& patient) {
  const Vector3d half(6, 2, 3), gap(0, -1.5 - half.y(), 0);
  const Vector3d middle = patient.landmarks.find("pogonion").value_or(Vector3d::Zero()) + gap;
  Part part;
  part.name = "transplant";
  part.role = Role::transplant;
  for (int corner = 0; corner < 8; ++corner)
    part.mesh.vertices.push_back(middle + Vector3d(corner & 1 ? half.x() : -half.x(),
                                                   corner & 2 ? half.y() : -half.y(),
                                                   corner & 4 ? half.z() : -half.z()));
  part.mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                         {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return part;
}

/// A motion as a recording: poses of the mandible, 50 per second.
std::string recording_of(const Motion& motion) {
  constexpr double rate_hz = 50;
  std::string csv = "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n";
  for (int i = 0; i <= static_cast<int>(motion.duration_s * rate_hz); ++i) {
    const Pose X_CM = motion.target(i / rate_hz);
    csv += fmt::format("{:.3f},{:.5f},{:.5f},{:.5f},{:.8f},{:.8f},{:.8f},{:.8f}\n", i / rate_hz,
                       X_CM.t.x(), X_CM.t.y(), X_CM.t.z(), X_CM.R.w(), X_CM.R.x(), X_CM.R.y(),
                       X_CM.R.z());
  }
  return csv;
}

/// Openers, then closers, as condyle help muscles describes.
constexpr const char* excitations =
    "time_s,open,close\n0,0,0\n0.3,0.15,0\n0.6,0.15,0\n0.8,0,0.01\n1.2,0,0.02\n";

int run_sample(const fs::path& out, const CommonOptions& common) {
  ProgressBar bar(common);
  const Case patient = open_patient({}, common, bar);
  make_folder(out);
  bar.show("writing the surfaces", 0.2);
  for (const SampleFile& file : surfaces) {
    const TriMesh& mesh = patient.find(file.role)->mesh;  // the built-in patient has them all
    if (fs::path(file.name).extension() == ".ply")
      write_ply(mesh, out / file.name);
    else
      write_stl(mesh, out / file.name);
  }
  write_file(out / "marks.csv", landmarks_csv(patient.landmarks));
  bar.show("recording a chewing motion", 0.5);
  write_file(out / "chew.csv",
             recording_of(make_motion("chewing-right", patient, ContactModel(patient))));
  write_file(out / "excitations.csv", excitations);
  bar.show("writing the case", 0.8);
  save_case(with_piece(patient, chin_transplant(patient), patient.jaw.lower_arch), out / "mycase");
  bar.clear();
  if (common.prints_summary())
    fmt::print(stderr,
               "{0}: surfaces (skull.stl, jaw.stl, upper.stl, lower.stl, skin.ply), marks.csv, "
               "chew.csv, excitations.csv and the case mycase, which has a transplant. Next: "
               "condyle check {0}/mycase --out out\n",
               out.string());
  return 0;
}

}  // namespace

void add_sample(Commands& commands) {
  const auto out = std::make_shared<fs::path>();
  CLI::App& command = commands.add(
      "sample", "Write files to try the manual's commands with", "condyle sample --out sample",
      [out](const CommonOptions& common) { return run_sample(*out, common); });
  command.add_option("--out", *out, "Folder for surfaces, landmarks, motions and a case")
      ->type_name("FOLDER")
      ->required();
}

}  // namespace condyle
