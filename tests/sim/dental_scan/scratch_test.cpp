#include <gtest/gtest.h>
#include <chrono>
#include <cstdio>
#include "engine/mesh/topology.h"
#include "sim/dental_scan/close_scan.h"
#include "sim/dental_scan/scanned_arches.h"
#include "tests/sim/dental_scan/made_scans.h"
#include "tests/support/builtin.h"
#include "tests/support/real_cases.h"
namespace condyle::test {
TEST(Scratch, Facts) {
  for (auto& part : builtin().parts) {
    auto t = inspect(part.mesh); auto b = bounding_box(part.mesh);
    std::printf("%s %zu tris closed %d comps %d box %.1f..%.1f %.1f..%.1f %.1f..%.1f\n", part.name.c_str(), part.mesh.triangles.size(), t.closed(), t.components, b.low.x(), b.high.x(), b.low.y(), b.high.y(), b.low.z(), b.high.z());
  }
}
void measure(const Case& whole, const char* what, int trials, bool noisy) {
  for (bool upper : {true, false}) for (int k = 0; k < trials; ++k) {
    Case patient = whole;
    for (auto& p : patient.parts) if (noisy && is_teeth(p.role)) make_ct_like(p, 10 + k);
    const Pose X_SC = random_pose(100 + k);
    auto scan = dental_scan(made_scan(crowns(whole, upper), X_SC, k), "scan.stl");
    auto t0 = std::chrono::steady_clock::now();
    ArchTarget target(crowns(patient, upper)), other(crowns(patient, !upper));
    ArchFitRequest request; request.opposing = &other;
    auto fit = fit_arch(scan, target, request);
    double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
    auto e = pose_error(scan.mesh, fit.X_CS, X_SC.inverse());
    std::printf("%s %s %d: err mean %.3f max %.3f | mean %.3f med %.3f p95 %.3f left out %.2f halves %.2f mirror %.3f exch %.3f pts %d  %.2f s\n", what, upper ? "up" : "lo", k, e.mean_mm, e.largest_mm, fit.mean_mm, fit.median_mm, fit.p95_mm, fit.left_out, fit.halves_mm, fit.mirrored_mm, fit.exchanged_mm.value_or(-1), fit.points, s);
    std::fflush(stdout);
  }
}
TEST(Scratch, Builtin) { measure(builtin(), "builtin clean", 1, false); measure(builtin(), "builtin noisy", 6, true); }
TEST(Scratch, Ubc) { if (auto c = case_ubc()) { measure(*c, "ubc clean", 1, false); measure(*c, "ubc noisy", 6, true);} }
TEST(Scratch, UbcOnBuiltin) {
  auto c = case_ubc(); if (!c) return;
  for (bool upper : {true, false}) {
    for (unsigned seed : {7u,8u,9u}) { const Pose X_SC = random_pose(seed);
    auto scan = dental_scan(made_scan(crowns(*c, upper), X_SC, 3), "scan.stl");
    ArchTarget target(crowns(builtin(), upper)), other(crowns(builtin(), !upper));
    ArchFitRequest request; request.opposing = &other;
    auto fit = fit_arch(scan, target, request);
    std::printf("other person: mean %.3f med %.3f p95 %.3f halves %.2f mirror %.3f exch %.3f\n", fit.mean_mm, fit.median_mm, fit.p95_mm, fit.halves_mm, fit.mirrored_mm, *fit.exchanged_mm);
    const Pose D = fit.X_CS * X_SC; std::printf("  turned by %.1f deg\n", rotation_angle(D) * 57.3);}
  }
}
TEST(Scratch, Close) {
  for (bool upper : {true, false}) {
    auto mesh = made_scan(crowns(builtin(), upper), {}, 1);
    auto c = close_scan(mesh, upper ? Eigen::Vector3d(0,0,1) : Eigen::Vector3d(0,0,-1));
    std::printf("closed %d holes %d skirts %d tris %zu\n", c.closed, c.holes, c.skirts, c.mesh.triangles.size());
  }
}
}
